"""A function in a process of its own: what it returns comes back, and what it breaks does not."""

from __future__ import annotations

import faulthandler
import os
import subprocess
import sys
import time
from collections.abc import Callable

import pytest
from giveway.fmu_tools.isolation import IsolatedError, isolated


def _spins(_: object) -> None:
    while True:
        pass


def _aborts(_: object) -> None:
    faulthandler.disable()  # pytest's would print all stacks as if the tests had crashed
    os.abort()


def _fails(_: object) -> None:
    raise ValueError("no good")


def test_the_result_comes_back() -> None:
    assert isolated(sorted, [3, 1, 2], 5, 100) == [1, 2, 3]


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (_aborts, "ends with SIGABRT"),
        (lambda _: os._exit(0), "ends without a word"),
        (_fails, r"fails \(ValueError: no good\)"),
        (lambda _: len(bytes(300_000_000)), "fails .MemoryError"),
        (_spins, "takes over 1 s"),
    ],
)
def test_how_it_ended_is_said(function: Callable[[object], object], words: str) -> None:
    start = time.monotonic()
    with pytest.raises(IsolatedError, match=words):
        isolated(function, None, 1, 100)
    assert time.monotonic() - start < 30.0  # far from hanging, on a busy machine too


def test_a_limit_that_is_there_already_is_kept() -> None:
    """A process may not raise it: asked for more, the function works within what there is."""
    code = (
        "import resource; resource.setrlimit(resource.RLIMIT_AS, (10**9, 10**9))\n"
        "from giveway.fmu_tools.isolation import isolated\n"
        "print(isolated(lambda _: resource.getrlimit(resource.RLIMIT_AS), None, 5, 5000))"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "(1000000000, 1000000000)"
