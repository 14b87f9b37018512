"""A pytest plugin: which mutants each test reaches, from the file that the mutants mark (GIVEWAY_MUTANTS_REACHED).

Mutants reached by a fixture count for every test that uses it, those reached by a file's import for all its tests.
"""

from __future__ import annotations

import json
import mmap
import os
import time
from collections.abc import Iterator
from typing import Any

import pytest

__all__ = ["Reach"]


class Reach:
    """Writes a line of JSON for each test to the file ``GIVEWAY_REACH_REPORT``."""

    def __init__(self) -> None:
        with open(os.environ["GIVEWAY_MUTANTS_REACHED"], "r+b") as file:
            self.marks = mmap.mmap(file.fileno(), 0)
        self.report = open(os.environ["GIVEWAY_REACH_REPORT"], "a", encoding="utf-8")  # noqa: SIM115
        self.on_import: set[int] = set()
        self.of_fixture: dict[Any, set[int]] = {}
        self.failed = False

    def _taken(self) -> set[int]:
        """Reads and clears the marks."""
        found = {at for at, mark in enumerate(self.marks[:]) if mark}
        self.marks[:] = bytes(len(self.marks))
        return found

    def pytest_collection_finish(self) -> None:
        self.on_import = self._taken()

    @pytest.hookimpl(hookwrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Iterator[None]:
        before = self._taken()
        yield
        found = self._taken()
        self.of_fixture.setdefault(fixturedef, set()).update(found)
        for at in before:
            self.marks[at] = 1

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: Any) -> Iterator[None]:
        self._taken()
        self.failed = False
        start = time.perf_counter()
        yield
        seconds = time.perf_counter() - start
        reached = self.on_import | self._taken()
        for definitions in item._fixtureinfo.name2fixturedefs.values():
            for definition in definitions:
                reached |= self.of_fixture.get(definition, set())
        line = {"test": item.nodeid, "seconds": seconds, "failed": self.failed, "reached": sorted(reached)}
        print(json.dumps(line), file=self.report, flush=True)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.failed = self.failed or report.failed


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(Reach())
