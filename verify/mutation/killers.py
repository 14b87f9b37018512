"""Which mutants c_core's tests see: first the unit tests in C with every invariant asserted, then the golden bits, then
the unit tests with traps for undefined behaviour such as an index beyond its array."""

from __future__ import annotations

import enum
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

from verify import golden
from verify.context import Context, Finished
from verify.failure import RungFailed
from verify.mutation.mutants import Mutant
from verify.targets import GCC, PORTABLE, STANDARD, core_sources

__all__ = ["AT_A_TIME", "UNIT", "Fate", "Killers"]

AT_A_TIME = 2
OPTIMISED: tuple[str, ...] = ("-O2", PORTABLE)  # at this level an equivalent mutant gives the same object code
TRAPPING: tuple[str, ...] = (
    *("-O1", PORTABLE, "-fsanitize=undefined", "-fsanitize-undefined-trap-on-error"),
    "-ftrivial-auto-var-init=pattern",  # a variable that a mutant no longer writes has the same value in every build
)
# Some sixty times the normal processor time; the output is limited as a mutant may print endlessly.
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
    """A killer: its objects, and its output if no fault is seen (None: any output, the exit code decides)."""

    fate: Fate
    sources: tuple[Path, ...]  # beside c_core's
    include: str
    expected: str | None
    flags: tuple[str, ...] = OPTIMISED  # with which c_core is compiled for it


class Killers:
    """``sources``: of the unit tests, if not the committed ones. Everything is built below ``context.work``."""

    def __init__(self, context: Context, unit_sources: Sequence[Path] | None = None) -> None:
        self.context = context
        self.sources = core_sources(context.core)
        unit = unit_sources or sorted((context.root / UNIT).glob("*.c"))
        example = context.root / golden.EXAMPLE
        bits = [*sorted((context.root / golden.SOURCES).glob("*.c")), example / "digest.c"]
        bits.append(example / "recorded_collision.c")
        unit_program = _Program(Fate.UNIT, tuple(unit), f"-I{context.root / UNIT}", None)
        self.programs = (
            unit_program,
            _Program(Fate.BITS, tuple(bits), f"-I{example}", golden.read_table(context.root, 0)),
            replace(unit_program, fate=Fate.TRAPS, flags=TRAPPING),
        )
        self.around = {program.fate: self._around(program) for program in self.programs}
        self.includers = self._includers()
        self.original = {
            flags: {source.name: self._compiled(source, f"core{flags[0]}", *flags) for source in self.sources}
            for flags in (OPTIMISED, TRAPPING)
        }
        healthy = context.work / "healthy"
        healthy.mkdir()
        for program in self.programs:
            core = self.original[program.flags]
            if self._sees(program, [*core.values(), *self.around[program.fate].values()], healthy):
                raise RungFailed(f"c_core without any mutant is {program.fate.value}")

    def fates(self, mutants: Sequence[Mutant]) -> list[Fate]:
        with ThreadPoolExecutor(AT_A_TIME) as pool:
            return list(pool.map(self.fate, mutants))

    def fate(self, mutant: Mutant) -> Fate:
        """Runs in a temporary folder; the sources are only read."""
        with tempfile.TemporaryDirectory(dir=self.context.work) as folder:
            return self._fate(mutant, Path(folder))

    def _fate(self, mutant: Mutant, folder: Path) -> Fate:
        mutated = folder / mutant.path.parent.name / mutant.path.name
        mutated.parent.mkdir()
        mutated.write_text(mutant.applied(mutant.path.read_text(encoding="utf-8")), encoding="utf-8")
        if mutant.path.suffix == ".c":
            changed = {mutant.path.name: mutated}
            include: tuple[str, ...] = ()
        else:
            changed = {source.name: source for source in self.includers[mutant.path.name]}
            include = (f"-I{folder}",)
        core = self._mutated(self.original[OPTIMISED], changed, folder, *OPTIMISED, *include)
        if core is None:
            return Fate.NOT_COMPILED
        if all(core[name].read_bytes() == original.read_bytes() for name, original in self.original[OPTIMISED].items()):
            return Fate.SAME_OBJECT
        for program in self.programs:
            if program.flags != OPTIMISED:
                core = self._mutated(self.original[program.flags], changed, folder, *program.flags, *include)
            # A header's inline functions are in the tests' objects, too.
            tests = self._mutated(self.around[program.fate], changed, folder, *OPTIMISED, program.include, *include)
            if core is None or tests is None or self._sees(program, [*core.values(), *tests.values()], folder):
                return program.fate
        return Fate.SURVIVED

    def _mutated(
        self, original: dict[str, Path], changed: dict[str, Path], folder: Path, *flags: str
    ) -> dict[str, Path] | None:
        """The objects, with those of changed sources recompiled; None if one does not compile."""
        objects = dict(original)
        for name in original.keys() & changed.keys():
            target = folder / f"{name}{flags[0]}.o"
            if self._compile(changed[name], target, *flags).returncode != 0:
                return None
            objects[name] = target
        return objects

    def _around(self, program: _Program) -> dict[str, Path]:
        name = program.fate.name.lower()
        return {source.name: self._compiled(source, name, *OPTIMISED, program.include) for source in program.sources}

    def _includers(self) -> dict[str, list[Path]]:
        """By name of a header of c_core: the sources of c_core and the programs that include it."""
        sources = dict.fromkeys(self.sources, "")
        sources |= {source: program.include for program in self.programs for source in program.sources}
        found: dict[str, list[Path]] = {path.name: [] for path in self.context.core.glob("include/giveway/*.h")}
        for source, include in sources.items():
            words = ("-MM", f"-I{self.context.core / 'include'}", *((include,) if include else ()), source)
            for header in self.context.run(self.context.which(GCC), *words).stdout.replace("\\", " ").split():
                if Path(header).name in found:
                    found[Path(header).name].append(source)
        return found

    def _sees(self, program: _Program, objects: Sequence[Path], folder: Path) -> bool:
        """Whether the program fails: failed tests, wrong output, a crash, or out of time or memory."""
        built = folder / program.fate.name.lower()
        self.context.run(self.context.which(GCC), *objects, "-o", built)
        printed = built.with_suffix(".txt")
        answer = self.context.run("bash", "-c", LIMITED, built, printed, memory_gib=MEMORY_GIB, expect=None)
        return answer.returncode != 0 or program.expected not in (None, printed.read_text(errors="replace"))

    def _compiled(self, source: Path, name: str, *flags: str) -> Path:
        target = self.context.work / name / f"{source.stem}.o"
        target.parent.mkdir(parents=True, exist_ok=True)
        answer = self._compile(source, target, *flags)
        if answer.returncode != 0:
            raise RungFailed(answer.evidence)
        return target

    def _compile(self, source: Path, target: Path, *flags: str) -> Finished:
        """Without a compiler cache: it would be filled with objects that are never needed again."""
        words = ("-w", f"-I{self.context.core / 'include'}", "-c", source, "-o", target)
        return self.context.run(self.context.which(GCC), *STANDARD, *flags, *words, expect=None)
