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
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from verify.context import Context
from verify.mutation.killers import AT_A_TIME
from verify.mutation.mutants import Mutant
from verify.mutation.rooms.kept import KeptFates, digest, files_below, read_if_of, write_of
from verify.mutation.rooms.planted import Planted
from verify.mutation.rooms.processes import WarmProcesses
from verify.mutation.rooms.room import PLAIN_PROGRAMS, PROGRAMS, SLOW_TESTS, TESTS

__all__ = ["Fate", "RoomTests", "Test"]

# Limits of time and processor time for a mutant, from the times of the original.
SLOWER, AT_LEAST_S = 2.0, 10.0
SLOWER_ON_A_BUSY_MACHINE = 4.0
RECORD_S = 600.0
ALL_PROGRAMS = (*PROGRAMS, *PLAIN_PROGRAMS)

Recorded = dict[str, Any]  # a test: name, seconds, failed, reached


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
    out. What an earlier call found in ``context.work`` about the same tests is used again.
    """

    def __init__(self, context: Context, planted: Planted, *, trust_killed: bool = False) -> None:
        self.context = context
        self.planted = planted
        self.folder = context.work / "trials"
        self.folder.mkdir(exist_ok=True)
        tests = files_below(planted.tree / "tests")
        self.kept = KeptFates(context.work / "fates.jsonl", digest(*tests), trust_killed=trust_killed)
        self.helpers = digest(*(path for path in tests if path.suffix == ".py" and not path.match("test_*.py")))
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

    def take_away(self) -> None:
        """Removes all tests, and what they found about the mutants."""
        self.quick = self.slow = []
        self.kept.fates.clear()

    def by_quick(self, mutants: Sequence[Mutant]) -> Iterator[tuple[Mutant, Fate]]:
        """The fates of ``mutants`` with the quick tests, in their order, as they are known."""
        return self._met(mutants, "quick")

    def by_slow(self, mutants: Sequence[Mutant]) -> Iterator[tuple[Mutant, Fate]]:
        """The fates of ``mutants`` with the slow tests, in their order, as they are known."""
        return self._met(mutants, "slow")

    def _met(self, mutants: Sequence[Mutant], stage: Literal["quick", "slow"]) -> Iterator[tuple[Mutant, Fate]]:
        """A trial that is interrupted ends after the tests that are running."""
        known = {mutant: Fate(fate) for mutant in mutants if (fate := self.kept.get(mutant.key, stage))}
        tests: list[Test] = getattr(self, stage) if len(known) < len(mutants) else []

        def tried(mutant: Mutant) -> Fate:
            if mutant in known:
                return known[mutant]
            fate = self._fate(mutant, tests)
            self.kept.add(mutant.key, stage, fate.value)
            return fate

        with ThreadPoolExecutor(AT_A_TIME) as pool:
            yield from zip(mutants, pool.map(tried, mutants), strict=True)

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
            start_new_session=True,  # Ctrl-C must not look like a mutant that was killed
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds))),
        )
        try:
            return process.wait(SLOWER_ON_A_BUSY_MACHINE * seconds) == 0
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            return False

    def _of_programs(self) -> list[Test]:
        with ThreadPoolExecutor(AT_A_TIME) as pool:
            found = list(pool.map(self._of_program, ALL_PROGRAMS))
        return [test for tests in found for test in tests]

    def _of_program(self, program: str) -> list[Test]:
        of = digest(self.planted.tree / "build" / program)
        return self._recorded(program, of, lambda: [self._of_case(program, name) for name in self._cases(program)])

    def _recorded(self, group: str, of: str, record: Callable[[], list[Recorded]]) -> list[Test]:
        """The tests of a group that pass, recorded now or earlier."""
        path = self.folder / f"{_stem(group)}.recorded"
        known = read_if_of(path, of)
        if known is None:
            known = record()
            write_of(path, of, known)
        self.failing += [f"{group} {entry['name']}" for entry in known if entry["failed"]]
        passing = [entry for entry in known if not entry["failed"]]
        return [Test(group, entry["name"], entry["seconds"], frozenset(entry["reached"])) for entry in passing]

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

    def _of_case(self, program: str, name: str) -> Recorded:
        marks = self._fresh_marks(_stem(f"{program}-{name}"))
        start = time.perf_counter()
        passed = self._program(program, [name], {"GIVEWAY_MUTANTS_REACHED": str(marks)}, RECORD_S)
        seconds = time.perf_counter() - start
        reached = [at for at, mark in enumerate(marks.read_bytes()) if mark]
        return {"name": name, "seconds": seconds, "failed": not passed, "reached": reached}

    def _of_files(self, files: Iterable[str]) -> list[Test]:
        with ThreadPoolExecutor(AT_A_TIME) as pool:
            return [test for tests in pool.map(self._of_file, files) for test in tests]

    def _of_file(self, file: str) -> list[Test]:
        of = digest(self.helpers, self.planted.tree / file)
        return self._recorded(file, of, lambda: self._record_file(file))

    def _record_file(self, file: str) -> list[Recorded]:
        """Of pytest."""
        report = self.folder / f"{_stem(file)}.reach"
        report.unlink(missing_ok=True)
        environment = {
            "GIVEWAY_MUTANTS_REACHED": str(self._fresh_marks(_stem(file))),
            "GIVEWAY_REACH_REPORT": str(report),
        }
        code = self._pytest(["-p", "verify.mutation.rooms.reach", file], environment, RECORD_S, _stem(file))
        found: list[Recorded] = []
        for line in report.read_text(encoding="utf-8").splitlines() if report.exists() else []:
            entry = json.loads(line)
            found.append({**entry, "name": entry["test"].removeprefix(f"{file}::")})
        if code not in (0, 1):
            found.append({"name": f"(ended with {code})", "seconds": 0.0, "failed": True, "reached": []})
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


def _stem(group: str) -> str:
    return group.removesuffix(".py").replace("/", ".")


def _seconds(tests: Iterable[Test]) -> float:
    return sum(test.seconds for test in tests)


def _limit_s(tests: Iterable[Test]) -> float:
    """Of processor time."""
    return AT_LEAST_S + SLOWER * _seconds(tests)
