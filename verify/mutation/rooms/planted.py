"""A copy of the repository with all drawn mutants of all rooms, built once; one is chosen at run time."""

from __future__ import annotations

import dataclasses
import json
import re
import shlex
import shutil
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from verify.context import Context, Finished
from verify.failure import RungFailed
from verify.mutation.killers import AT_A_TIME
from verify.mutation.mutants import SEED, Key, Mutant, shuffled
from verify.mutation.rooms.kept import digest, files_below, read_if_of, write_of
from verify.mutation.rooms.room import CPP, PYTHON_PATH, TARGETS, Room
from verify.mutation.rooms.schemata import with_all

__all__ = ["Planted", "plant"]

HERE = Path(__file__).parent
PLACES = "places.json"
# A planted tree is used again if these are the same; tests that changed are copied into it and built anew.
PLANTED_FROM = (
    *("CMakeLists.txt", "c_core", "cmake", "cosim", "examples", "fmu", "pyproject.toml", "requirements.lock", "robots"),
    *("verify/mutation/mutants.py", "verify/mutation/rooms/cpp_places.py", "verify/mutation/rooms/giveway_mutants.py"),
    *("verify/mutation/rooms/mutant.hpp", "verify/mutation/rooms/planted.py", "verify/mutation/rooms/python_places.py"),
    *("verify/mutation/rooms/room.py", "verify/mutation/rooms/schemata.py"),
)
NOT_COPIED = (".git", ".venv", "__pycache__", "build", "native", "out")
SPARE = 2  # factor by which more are planted in C++ than wanted, as some do not compile
ERROR = re.compile(r"^(/[^:\n]+):(\d+):\d+: (?:fatal )?error: ", re.MULTILINE)


@dataclass(frozen=True)
class Planted:
    """``drawn``: the mutants to try, each with the number that chooses it."""

    tree: Path
    drawn: Mapping[Mutant, int]
    everything: list[Mutant]
    not_compiled: int

    def of(self, room: Room) -> list[Mutant]:
        return [mutant for mutant in self.drawn if mutant.key.file.startswith(room.folder + "/")]

    @property
    def python(self) -> Path:
        """An interpreter with the installed packages, but giveway from the copy."""
        return self.tree.parent / "python" / "bin" / "python"


def plant(context: Context, *, few: bool) -> Planted:
    """Draw, plant and build; ``few``: only as many as `make verify` tries.

    What is there already, of the same sources, is used again.
    """
    inputs = digest(str(few), *(path for name in PLANTED_FROM for path in files_below(context.root / name)))
    drawn_file = context.work / "drawn.json"
    tree = context.work / "tree"
    known = read_if_of(drawn_file, inputs)
    if known is None:
        shutil.rmtree(context.work)
        context.work.mkdir()
        known = _planted_anew(context, tree, few)
    else:
        shutil.rmtree(tree / "tests")
        shutil.copytree(context.root / "tests", tree / "tests", ignore=shutil.ignore_patterns(*NOT_COPIED))
    _build(context, tree)
    _make_python(context, tree)
    write_of(drawn_file, inputs, known)
    document = json.loads((context.work / PLACES).read_text(encoding="utf-8"))
    everything = [_mutant(entry) for entry in (*document["cpp"], *document["python"])]
    by_key = {mutant.key: mutant for mutant in everything}
    drawn = {by_key[Key(**entry["key"])]: entry["number"] for entry in known["drawn"]}
    return Planted(tree, drawn, everything, known["not_compiled"])


def _planted_anew(context: Context, tree: Path, few: bool) -> dict[str, Any]:
    """Which mutants are drawn, with their numbers, and how many were passed over, because they do not compile."""
    shutil.copytree(context.root, tree, ignore=shutil.ignore_patterns(*NOT_COPIED), symlinks=True)
    document = _places(context, tree, few)
    _write_runtime(tree, document["names"])
    _configure(context, tree)
    cpp = [_mutant(entry) for entry in document["cpp"]]
    drawn = {_mutant(entry): entry["chosen"] for entry in document["python"] if entry["chosen"]}
    bad = 0
    planting = _Cpp(context, tree, first_number=len(drawn) + 1)
    for room in CPP:
        of_room = [mutant for mutant in cpp if mutant.key.file.startswith(room.folder + "/")]
        planting.candidates += shuffled(of_room, SEED, by_file=False)[: SPARE * (room.few if few else room.sample)]
    compiled = planting.that_compile()
    for room in CPP:
        of_room = [mutant for mutant in compiled if mutant.key.file.startswith(room.folder + "/")]
        wanted = room.few if few else room.sample
        if len(of_room) < wanted:
            raise RungFailed(f"{room.folder}: {wanted} mutants are wanted, and {len(of_room)} compile")
        last = planting.candidates.index(of_room[wanted - 1])
        bad += sum(m not in compiled and m.key.file.startswith(room.folder + "/") for m in planting.candidates[:last])
        drawn |= {mutant: planting.numbers[mutant] for mutant in of_room[:wanted]}
    entries = [{"key": dataclasses.asdict(mutant.key), "number": number} for mutant, number in drawn.items()]
    return {"drawn": entries, "not_compiled": bad}


def _places(context: Context, tree: Path, few: bool) -> dict[str, Any]:
    """Finds all mutants with tools that only the environment of verify has, and plants those in Python."""
    out = context.work / PLACES
    python = context.root / "build/verify/tools/bin/python"
    if not python.exists():
        raise RungFailed(f"missing: {python}; `make mutate` and `make verify` make it")
    options: tuple[str | Path, ...] = ("--root", context.root, "--tree", tree, "--out", out)
    module = ("-m", "verify.mutation.rooms.places")
    context.run(
        python,
        *module,
        *options,
        *(["--few"] if few else []),
        cwd=context.root,
        environment={"PYTHONPATH": str(context.root)},
    )
    document = json.loads(out.read_text(encoding="utf-8"))
    assert isinstance(document, dict)
    return document


def _mutant(entry: Mapping[str, Any]) -> Mutant:
    names = ("number", "start", "end", "replacement")
    return Mutant(Key(**entry["key"]), Path(entry["path"]), *(entry[name] for name in names))


def _write_runtime(tree: Path, numbers: Mapping[str, int]) -> None:
    for folder in PYTHON_PATH:
        shutil.copy(HERE / "giveway_mutants.py", tree / folder)
        text = f"NUMBERS = {json.dumps(numbers, indent=4, ensure_ascii=False)}\n"
        (tree / folder / "giveway_mutant_numbers.py").write_text(text, encoding="utf-8")


def _configure(context: Context, tree: Path) -> None:
    tools = context.root / ".venv" / "bin"
    context.run(
        *(tools / "cmake", "-G", "Ninja", "-S", tree, "-B", tree / "build", "-DGIVEWAY_BUILD_TESTS=ON"),
        f"-DPython3_EXECUTABLE={tools / 'python'}",
        f"-DCMAKE_MAKE_PROGRAM={tools / 'ninja'}",
        f"-DGIVEWAY_SUNDIALS_VENDOR={context.root / 'build/sundials-source'}",
        "-DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST",  # ctest does not run them
        "-DGIVEWAY_NATIVE_FMUS=ON",  # with the compiler flags of this tree
        f"-DCMAKE_CXX_FLAGS=-w -include {HERE / 'mutant.hpp'}",
    )
    targets = context.run(tools / "ninja", "-C", tree / "build", "-t", "targets", "all").stdout
    generated = re.findall(r"^(\S+_variables\.hpp): ", targets, re.MULTILINE)
    context.run(tools / "ninja", "-C", tree / "build", *generated)


def _build(context: Context, tree: Path) -> None:
    cmake = context.root / ".venv/bin/cmake"
    jobs = ("-j", str(AT_A_TIME))
    targets = (*TARGETS, "pages")  # pages, because they are installed, too
    # Without a limit of memory: programs with AddressSanitizer are run.
    context.run(cmake, "--build", tree / "build", *jobs, "--target", *targets, timeout_s=3600.0, memory_gib=None)
    context.run(cmake, "--install", tree / "build", "--component", "native", "--prefix", tree / "cosim")


def _make_python(context: Context, tree: Path) -> None:
    """Paths in a .pth file are searched, but .pth files inside them are not read: one of those is giveway's."""
    python = context.root / ".venv/bin/python"
    context.run(python, "-m", "venv", "--without-pip", context.work / "python")
    (installed,) = (context.root / ".venv").glob("lib/python3*/site-packages")
    (folder,) = (context.work / "python").glob("lib/python3*/site-packages")
    (folder / "giveway_mutants.pth").write_text(f"{tree / PYTHON_PATH[0]}\n{installed}\n", encoding="utf-8")
    command = context.work / "python" / "bin" / "giveway"
    command.write_text(f'#!/bin/sh\nexec {command.parent / "python"} -m giveway "$@"\n', encoding="utf-8")
    command.chmod(0o755)


class _Cpp:
    """Mutants in C++, planted together, without those that do not compile."""

    def __init__(self, context: Context, tree: Path, first_number: int) -> None:
        self.context = context
        self.tree = tree
        self.first_number = first_number
        self.candidates: list[Mutant] = []

    @property
    def numbers(self) -> dict[Mutant, int]:
        return {mutant: self.first_number + at for at, mutant in enumerate(self.candidates)}

    def that_compile(self) -> list[Mutant]:
        """Also written to the tree."""
        good = list(self.candidates)
        units = self._units()
        while units:
            self._write(good)
            answers = self._checked(units)
            failed = {unit: answer for unit, answer in answers.items() if answer.returncode != 0}
            bad = self._to_blame(good, failed)
            good = [mutant for mutant in good if mutant not in bad]
            units = {unit: command for unit, command in units.items() if unit in failed}
        return good

    def _units(self) -> dict[str, list[str]]:
        commands = json.loads((self.tree / "build/compile_commands.json").read_text(encoding="utf-8"))
        of_ours = [str(self.tree / folder) for folder in ("fmu", "tests/fmu")]
        return {
            entry["file"]: [*shlex.split(entry["command"]), "-fsyntax-only", "-fdiagnostics-color=never"]
            for entry in commands
            if entry["file"].startswith(tuple(of_ours)) and entry["file"].endswith(".cpp")
        }

    def _checked(self, units: Mapping[str, list[str]]) -> dict[str, Finished]:
        def checked(command: list[str]) -> Finished:
            return self.context.run(*command, cwd=self.tree / "build", expect=None)

        with ThreadPoolExecutor(AT_A_TIME) as pool:
            return dict(zip(units, pool.map(checked, units.values()), strict=True))

    def _write(self, mutants: Iterable[Mutant]) -> None:
        of_file: dict[Path, dict[Mutant, int]] = {mutant.path: {} for mutant in self.candidates}
        numbers = self.numbers
        for mutant in mutants:
            of_file[mutant.path][mutant] = numbers[mutant]
        for path, inside in of_file.items():
            text = with_all(path.read_bytes(), inside)
            (self.tree / path.relative_to(self.context.root)).write_bytes(text)

    def _to_blame(self, planted: list[Mutant], failed: Mapping[str, Finished]) -> set[Mutant]:
        """The mutants in the lines with errors; if a line has several, those that fail alone."""
        bad: set[Mutant] = set()
        for unit, answer in failed.items():
            suspects: dict[tuple[str, int], list[Mutant]] = {}
            for file, line in ERROR.findall(answer.stderr):
                suspects[file, int(line)] = [m for m in planted if self._is_in(m, file, int(line))]
            if not any(suspects.values()):
                raise RungFailed(f"{unit}: does not compile with mutants, for no mutant's sake\n{answer.evidence}")
            for together in suspects.values():
                bad |= {m for m in together if m not in bad and (len(together) == 1 or self._fails_alone(m, unit))}
        return bad

    def _is_in(self, mutant: Mutant, file: str, line: int) -> bool:
        if self.tree / mutant.key.file != Path(file):
            return False
        return mutant.number <= line <= mutant.number + mutant.path.read_bytes().count(b"\n", mutant.start, mutant.end)

    def _fails_alone(self, mutant: Mutant, unit: str) -> bool:
        self._write([mutant])
        return self._checked({unit: self._units()[unit]})[unit].returncode != 0
