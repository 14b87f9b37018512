"""The tests of a build with mutants: which mutants each test reaches, and the tests to run on a mutant, fastest
first."""

from __future__ import annotations

import enum
import functools
import json
import os
import resource
import shutil
import subprocess
import time
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from verify.context import Context
from verify.mutation.killers import AT_A_TIME
from verify.mutation.mutants import Key, Mutant
from verify.mutation.rooms.planted import Planted
from verify.mutation.rooms.processes import WarmProcesses
from verify.mutation.rooms.room import PLAIN_PROGRAMS, PROGRAMS, SLOW_TESTS, TESTS

__all__ = ["Fate", "RoomTests", "Test"]

# Limits of time and processor time for a mutant, from the times of the original.
SLOWER, AT_LEAST_S = 2.0, 10.0
SLOWER_ON_A_BUSY_MACHINE = 4.0
RECORD_S = 600.0
ALL_PROGRAMS = (*PROGRAMS, *PLAIN_PROGRAMS)


class Fate(enum.Enum):
    KILLED = "killed"
    UNREACHED = "no test reaches it"
    SURVIVED = "survived"


@dataclass(frozen=True)
class Test:
    """``group``: a GoogleTest program or a pytest file; ``name`` within it."""

    group: str
    name: str
    seconds: float
    reached: frozenset[int]


class RoomTests:
    """Records on creation which mutants every test reaches; a test that fails on the original is reported and left
    out."""

    def __init__(self, context: Context, planted: Planted) -> None:
        self.context = context
        self.planted = planted
        self.folder = context.work / "trials"
        self.folder.mkdir()
        self.warm = WarmProcesses(planted.python, planted.tree, AT_A_TIME)
        self.failing: list[str] = []
        files = [path for folder in TESTS for path in (planted.tree / folder).rglob("test_*.py")]
        names = sorted(path.relative_to(planted.tree).as_posix() for path in files)
        self.slow_files = [name for name in names if name.rsplit("/", 1)[1] in SLOW_TESTS]
        self.quick = self._of_programs() + self._of_files(name for name in names if name not in self.slow_files)

    @functools.cached_property
    def slow(self) -> list[Test]:
        """Recorded on first use: a trial in which all other survivors are listed does not need it."""
        return self._of_files(self.slow_files)

    def fates(self, mutants: Sequence[Mutant], listed: Container[Key]) -> dict[Mutant, Fate]:
        """A listed mutant is run on the quick tests only, since it is known to survive all tests."""
        found = self._met(mutants, self.quick)
        left = [mutant for mutant in mutants if found[mutant] is not Fate.KILLED and mutant.key not in listed]
        of_slow = self._met(left, self.slow) if left else {}
        return found | {mutant: fate for mutant, fate in of_slow.items() if fate is not Fate.UNREACHED}

    def _met(self, mutants: Sequence[Mutant], tests: Sequence[Test]) -> dict[Mutant, Fate]:
        with ThreadPoolExecutor(AT_A_TIME) as pool:
            return dict(zip(mutants, pool.map(lambda mutant: self._fate(mutant, tests), mutants), strict=True))

    def _fate(self, mutant: Mutant, tests: Sequence[Test]) -> Fate:
        number = self.planted.drawn[mutant]
        groups: dict[str, list[Test]] = {}
        for test in tests:
            if number in test.reached:
                groups.setdefault(test.group, []).append(test)
        if not groups:
            return Fate.UNREACHED
        quickest_first = sorted(groups.values(), key=_seconds)
        for together in quickest_first:
            if together[0].group in ALL_PROGRAMS and not self._program_passes(together, number):
                return Fate.KILLED
        files = [together for together in quickest_first if together[0].group not in ALL_PROGRAMS]
        return Fate.SURVIVED if self._files_pass(files, number) else Fate.KILLED

    def close(self) -> None:
        self.warm.close()

    def _program_passes(self, tests: Sequence[Test], number: int) -> bool:
        environment = {"GIVEWAY_MUTANT": str(number)}
        return self._program(tests[0].group, [test.name for test in tests], environment, _limit_s(tests))

    def _files_pass(self, files: Sequence[Sequence[Test]], number: int) -> bool:
        """In one process, which ends with the first test that fails."""
        tests = [test for together in files for test in together]
        if not tests:
            return True
        names = [f"{test.group}::{test.name}" for test in tests]
        environment = {"GIVEWAY_MUTANT": str(number)}
        return bool(self._pytest(["-x", *names], environment, _limit_s(tests), str(number)) == 0)

    def _program(self, program: str, names: Iterable[str], environment: Mapping[str, str], seconds: float) -> bool:
        command = [str(self.planted.tree / "build" / program)]
        if program in PROGRAMS:
            command += [f"--gtest_filter={':'.join(names)}", "--gtest_fail_fast"]
        process = subprocess.Popen(
            command,
            cwd=self.folder,
            env={**os.environ, **environment},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds))),
        )
        try:
            return process.wait(SLOWER_ON_A_BUSY_MACHINE * seconds) == 0
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            return False

    def _of_programs(self) -> list[Test]:
        cases = [(program, name) for program in ALL_PROGRAMS for name in self._cases(program)]
        with ThreadPoolExecutor(AT_A_TIME) as pool:
            return [test for test in pool.map(self._of_case, cases) if test]

    def _cases(self, program: str) -> Iterator[str]:
        if program in PLAIN_PROGRAMS:
            yield ""
            return
        suite = ""
        path = self.planted.tree / "build" / program
        for line in self.context.run(path, "--gtest_list_tests", memory_gib=None).stdout.splitlines():
            name = line.split("#")[0].rstrip()
            if name.startswith(" "):
                yield suite + name.strip()
            elif name.endswith("."):
                suite = name

    def _of_case(self, case: tuple[str, str]) -> Test | None:
        program, name = case
        marks = self._fresh_marks("-".join(case).replace("/", "."))
        start = time.perf_counter()
        if not self._program(program, [name], {"GIVEWAY_MUTANTS_REACHED": str(marks)}, RECORD_S):
            self.failing.append(f"{program} {name}")
            return None
        seconds = time.perf_counter() - start
        reached = frozenset(at for at, mark in enumerate(marks.read_bytes()) if mark)
        return Test(program, name, seconds, reached)

    def _of_files(self, files: Iterable[str]) -> list[Test]:
        with ThreadPoolExecutor(AT_A_TIME) as pool:
            return [test for tests in pool.map(self._of_file, files) for test in tests]

    def _of_file(self, file: str) -> list[Test]:
        """Of pytest."""
        stem = file.removesuffix(".py").replace("/", ".")
        report = self.folder / f"{stem}.reach"
        environment = {
            "GIVEWAY_MUTANTS_REACHED": str(self._fresh_marks(stem)),
            "GIVEWAY_REACH_REPORT": str(report),
        }
        code = self._pytest(["-p", "verify.mutation.rooms.reach", file], environment, RECORD_S, stem)
        if code not in (0, 1):
            self.failing.append(f"{file} (ended with {code})")
        found = []
        for line in report.read_text(encoding="utf-8").splitlines() if report.exists() else []:
            entry = json.loads(line)
            if entry["failed"]:
                self.failing.append(entry["test"])
            else:
                name = entry["test"].removeprefix(f"{file}::")
                found.append(Test(file, name, entry["seconds"], frozenset(entry["reached"])))
        return found

    def _fresh_marks(self, name: str) -> Path:
        marks = self.folder / f"{name}.marks"
        marks.write_bytes(bytes(max(self.planted.drawn.values()) + 1))
        return marks

    def _pytest(self, arguments: Sequence[str], environment: Mapping[str, str], seconds: float, name: str) -> Any:
        """pytest's exit code, or "time"; its output is in the folder, under this name."""
        request = {
            "arguments": ["-q", f"--basetemp={self.folder / name}", *arguments],
            "environment": dict(environment),
            "cpu_s": int(seconds),
            "wall_s": SLOWER_ON_A_BUSY_MACHINE * seconds,
            "output": str(self.folder / f"{name}.txt"),
        }
        try:
            return self.warm.ask(request)
        finally:
            shutil.rmtree(self.folder / name, ignore_errors=True)


def _seconds(tests: Iterable[Test]) -> float:
    return sum(test.seconds for test in tests)


def _limit_s(tests: Iterable[Test]) -> float:
    """Of processor time."""
    return AT_LEAST_S + SLOWER * _seconds(tests)
