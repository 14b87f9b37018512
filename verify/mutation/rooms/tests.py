"""The tests of a build with mutants: which mutants each comes by, and what a mutant meets, quickest first."""

from __future__ import annotations

import enum
import functools
import json
import os
import resource
import subprocess
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from verify.context import Context
from verify.failure import RungFailed
from verify.mutation.mutants import Mutant
from verify.mutation.rooms.planted import Planted
from verify.mutation.rooms.room import PROGRAMS, SLOW_TESTS, TESTS

__all__ = ["Fate", "RoomTests", "Test"]

# Of tests that end: time and processor time that a mutant may take, from those that the original took.
SLOWER, AT_LEAST_S = 2.0, 10.0
SLOWER_ON_A_BUSY_MACHINE = 4.0
RECORD_WALL_S = 900.0


class Fate(enum.Enum):
    KILLED = "killed"
    UNREACHED = "no test comes by it"
    SURVIVED = "survived"


@dataclass(frozen=True)
class Test:
    """``group``: a program of GoogleTest, or a file of pytest's; ``name`` within it."""

    group: str
    name: str
    seconds: float
    reached: frozenset[int]


class RoomTests:
    """Records on creation what every test reaches; one that fails on the original is told of and left out."""

    def __init__(self, context: Context, planted: Planted) -> None:
        self.context = context
        self.planted = planted
        self.folder = context.work / "trials"
        self.folder.mkdir()
        self.marks = self.folder / "reached"
        self.size = max(planted.drawn.values()) + 1
        self.warm = self._started()
        self.failing: list[str] = []
        files = [path for folder in TESTS for path in (planted.tree / folder).rglob("test_*.py")]
        names = sorted(path.relative_to(planted.tree).as_posix() for path in files)
        self.quick_files = [name for name in names if name.rsplit("/", 1)[1] not in SLOW_TESTS]
        self.slow_files = [name for name in names if name not in self.quick_files]
        self.quick = self._of_programs()
        for file in self.quick_files:
            self.quick += self._of_file(file)

    @functools.cached_property
    def slow(self) -> list[Test]:
        """Recorded when first asked for: a trial in which all other survivors are listed does without."""
        return [test for file in self.slow_files for test in self._of_file(file)]

    def fate(self, mutant: Mutant, *, is_listed: bool) -> Fate:
        """A listed mutant meets the quick tests only: what is known to survive all is not asked of all again."""
        quick = self._fate(mutant, self.quick)
        if quick is Fate.KILLED or is_listed:
            return quick
        slow = self._fate(mutant, self.slow)
        return quick if slow is Fate.UNREACHED else slow

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
            if together[0].group in PROGRAMS and not self._program_passes(together, number):
                return Fate.KILLED
        files = [together for together in quickest_first if together[0].group not in PROGRAMS]
        return Fate.SURVIVED if self._files_pass(files, number) else Fate.KILLED

    def close(self) -> None:
        assert self.warm.stdin is not None
        self.warm.stdin.close()
        self.warm.wait()

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
        return bool(self._pytest(["-x", *names], environment, _limit_s(tests), f"{number}.txt") == 0)

    def _program(self, program: str, names: Iterable[str], environment: Mapping[str, str], seconds: float) -> bool:
        command = [str(self.planted.tree / "build" / program), f"--gtest_filter={':'.join(names)}", "--gtest_fail_fast"]
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
        found = []
        environment = {"GIVEWAY_MUTANTS_REACHED": str(self.marks)}
        for program in PROGRAMS:
            for name in _cases(self.context, self.planted.tree / "build" / program):
                self.marks.write_bytes(bytes(self.size))
                start = time.perf_counter()
                if self._program(program, [name], environment, RECORD_WALL_S):
                    seconds = time.perf_counter() - start
                    reached = frozenset(at for at, mark in enumerate(self.marks.read_bytes()) if mark)
                    found.append(Test(program, name, seconds, reached))
                else:
                    self.failing.append(f"{program} {name}")
        return found

    def _of_file(self, file: str) -> list[Test]:
        """Of pytest."""
        stem = file.removesuffix(".py").replace("/", ".")
        report = self.folder / f"{stem}.reach"
        self.marks.write_bytes(bytes(self.size))
        environment = {"GIVEWAY_MUTANTS_REACHED": str(self.marks), "GIVEWAY_REACH_REPORT": str(report)}
        arguments = ["-p", "verify.mutation.rooms.reach", file]
        code = self._pytest(arguments, environment, RECORD_WALL_S, f"{stem}.txt")
        lines = report.read_text(encoding="utf-8").splitlines() if report.exists() else []
        if not lines:
            self.failing.append(f"{file} (ended with {code})")
        found = []
        for entry in map(json.loads, lines):
            if entry["failed"]:
                self.failing.append(entry["test"])
            else:
                name = entry["test"].removeprefix(f"{file}::")
                found.append(Test(file, name, entry["seconds"], frozenset(entry["reached"])))
        return found

    def _pytest(self, arguments: Sequence[str], environment: Mapping[str, str], seconds: float, output: str) -> Any:
        """pytest's exit code, or "time"."""
        request = {
            "arguments": ["-q", f"--basetemp={self.folder / 'tmp'}", *arguments],
            "environment": dict(environment),
            "cpu_s": int(seconds),
            "wall_s": SLOWER_ON_A_BUSY_MACHINE * seconds,
            "output": str(self.folder / output),
        }
        assert self.warm.stdin is not None
        assert self.warm.stdout is not None
        print(json.dumps(request), file=self.warm.stdin, flush=True)
        answer = self.warm.stdout.readline()
        if not answer:
            raise RungFailed("the process that runs the tests in Python has ended")
        return json.loads(answer)["code"]

    def _started(self) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [str(self.planted.python), "-m", "verify.mutation.rooms.warm"],
            cwd=self.planted.tree,
            env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )


def _seconds(tests: Iterable[Test]) -> float:
    return sum(test.seconds for test in tests)


def _limit_s(tests: Iterable[Test]) -> float:
    """Of processor time."""
    return AT_LEAST_S + SLOWER * _seconds(tests)


def _cases(context: Context, program: Path) -> list[str]:
    """The names of a program's tests."""
    found = []
    suite = ""
    for line in context.run(program, "--gtest_list_tests", memory_gib=None).stdout.splitlines():
        name = line.split("#")[0].rstrip()
        if name.startswith(" "):
            found.append(suite + name.strip())
        elif name.endswith("."):
            suite = name
    return found
