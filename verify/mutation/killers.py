"""Which mutants c_core's tests see: the unit tests in C, with every invariant asserted, then the golden bits, then the
unit tests again with traps for undefined behaviour, such as an index beyond its array."""

from __future__ import annotations

import enum
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from verify import golden
from verify.context import Context, Finished
from verify.failure import RungFailed
from verify.mutation.mutants import Mutant
from verify.targets import GCC, STANDARD, core_sources

__all__ = ["AT_A_TIME", "UNIT", "Fate", "Killers"]

AT_A_TIME = 2
OPTIMISED: tuple[str, ...] = ("-O2",)  # at which an equivalent mutant gives the same object
TRAPPING: tuple[str, ...] = ("-O1", "-fsanitize=undefined", "-fsanitize-undefined-trap-on-error")
# Some sixty times what a program takes; a mutant may print without end, too.
CPU_S = 4
MEMORY_GIB = 1.0
OUTPUT_KIB = 1024
LIMITED = f'ulimit -t {CPU_S} -f {OUTPUT_KIB} && exec "$0" > "$1"'
UNIT = "tests/c_core/unit"


class Fate(enum.Enum):
    NOT_COMPILED = "does not compile"
    SAME_OBJECT = "same object code"
    UNIT = "killed by the unit tests"
    BITS = "killed by the golden bits"
    TRAPS = "killed by the unit tests with traps"
    SURVIVED = "survived"

    @property
    def counts(self) -> bool:
        return self not in (Fate.NOT_COMPILED, Fate.SAME_OBJECT)


@dataclass(frozen=True)
class _Program:
    """A killer: its own objects, and what it prints when all is well (None: anything, it says so by its exit code)."""

    fate: Fate
    objects: tuple[Path, ...]
    expected: str | None
    flags: tuple[str, ...] = OPTIMISED  # with which c_core is compiled for it


class Killers:
    """``sources``: of the unit tests, if other than the committed ones. Everything is built below ``context.work``."""

    def __init__(self, context: Context, unit_sources: Sequence[Path] | None = None) -> None:
        self.context = context
        self.sources = core_sources(context.core)
        unit = unit_sources or sorted((context.root / UNIT).glob("*.c"))
        example = context.root / golden.EXAMPLE
        bits = [*sorted((context.root / golden.SOURCES).glob("*.c")), example / "digest.c"]
        bits.append(example / "recorded_collision.c")
        unit_objects = self._objects(unit, "unit", f"-I{context.root / UNIT}")
        bits_objects = self._objects(bits, "golden", f"-I{example}")
        self.programs = (
            _Program(Fate.UNIT, unit_objects, None),
            _Program(Fate.BITS, bits_objects, golden.read_table(context.root, 0)),
            _Program(Fate.TRAPS, unit_objects, None, TRAPPING),
        )
        self.original = {
            flags: {source.name: self._compiled(source, f"core{flags[0]}", *flags) for source in self.sources}
            for flags in (OPTIMISED, TRAPPING)
        }
        healthy = context.work / "healthy"
        healthy.mkdir()
        for program in self.programs:
            if self._sees(program, list(self.original[program.flags].values()), healthy):
                raise RungFailed(f"c_core without any mutant is {program.fate.value}")

    def fates(self, mutants: Sequence[Mutant]) -> list[Fate]:
        with ThreadPoolExecutor(AT_A_TIME) as pool:
            return list(pool.map(self.fate, mutants))

    def fate(self, mutant: Mutant) -> Fate:
        """In a folder of its own, removed afterwards; the sources are only read."""
        with tempfile.TemporaryDirectory(dir=self.context.work) as folder:
            return self._fate(mutant, Path(folder))

    def _fate(self, mutant: Mutant, folder: Path) -> Fate:
        mutated = folder / mutant.path.parent.name / mutant.path.name
        mutated.parent.mkdir()
        mutated.write_text(mutant.applied(mutant.path.read_text(encoding="utf-8")), encoding="utf-8")
        changed: list[tuple[Path, tuple[str, ...]]]
        if mutant.path.suffix == ".c":
            changed = [(mutated, ())]
        else:
            changed = [(source, (f"-I{folder}",)) for source in self.sources]
        objects = self._mutated(changed, folder, OPTIMISED)
        if objects is None:
            return Fate.NOT_COMPILED
        original = self.original[OPTIMISED]
        if all(objects[name].read_bytes() == original[name].read_bytes() for name in original):
            return Fate.SAME_OBJECT
        for program in self.programs:
            if program.flags != OPTIMISED:
                objects = self._mutated(changed, folder, program.flags)
            if objects is None or self._sees(program, list(objects.values()), folder):
                return program.fate
        return Fate.SURVIVED

    def _mutated(
        self, changed: Sequence[tuple[Path, tuple[str, ...]]], folder: Path, flags: tuple[str, ...]
    ) -> dict[str, Path] | None:
        """The objects of c_core, those of the changed sources compiled anew; None if one does not compile."""
        objects = dict(self.original[flags])
        for source, include in changed:
            target = folder / f"{source.stem}{flags[0]}.o"
            if self._compile(source, target, *flags, *include).returncode != 0:
                return None
            objects[source.name] = target
        return objects

    def _sees(self, program: _Program, core: list[Path], folder: Path) -> bool:
        """It ends otherwise than it should: failed tests, wrong output, a crash, or out of time or memory."""
        built = folder / program.fate.name.lower()
        self.context.run(self.context.which(GCC), *core, *program.objects, "-o", built)
        printed = built.with_suffix(".txt")
        answer = self.context.run("bash", "-c", LIMITED, built, printed, memory_gib=MEMORY_GIB, expect=None)
        return answer.returncode != 0 or program.expected not in (None, printed.read_text(errors="replace"))

    def _objects(self, sources: Sequence[Path], name: str, *flags: str) -> tuple[Path, ...]:
        return tuple(self._compiled(source, name, *OPTIMISED, *flags) for source in sources)

    def _compiled(self, source: Path, name: str, *flags: str) -> Path:
        target = self.context.work / name / f"{source.stem}.o"
        target.parent.mkdir(parents=True, exist_ok=True)
        answer = self._compile(source, target, *flags)
        if answer.returncode != 0:
            raise RungFailed(answer.evidence)
        return target

    def _compile(self, source: Path, target: Path, *flags: str) -> Finished:
        """Never by way of a compiler cache: it would be filled with what nobody asks for again."""
        words = ("-w", f"-I{self.context.core / 'include'}", "-c", source, "-o", target)
        return self.context.run(self.context.which(GCC), *STANDARD, *flags, *words, expect=None)
