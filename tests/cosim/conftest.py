"""Shared runs: a co-simulation of seconds is made once per session, and only read by the tests."""

from __future__ import annotations

import contextlib
import io
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import giveway
import pytest
from giveway.cli import _main
from giveway.simulation.result import Result

sys.path.insert(0, str(Path(__file__).parent))  # for the helpers beside the tests

from cosim_helpers import Cli, short


@pytest.fixture(autouse=True)
def ctrl_c() -> Iterator[None]:
    """Ctrl-C is heard, as at a terminal, by the tests and what they start: also where pytest was started with it
    ignored (nohup, in the background of a script)."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def cli(tmp_path: Path) -> Cli:
    """Run the command line as if in an empty folder, but in this process: Python's start and imports cost 0.3 s to 2 s.

    At least one test of each command takes `process`.
    """

    def call(*arguments: str) -> subprocess.CompletedProcess[str]:
        said = [io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True) for _ in range(2)]
        with contextlib.chdir(tmp_path), redirect_stdout(said[0]), redirect_stderr(said[1]):
            code = _main(list(arguments))
        out, error = (stream.buffer.getvalue().decode() for stream in said)  # type: ignore[attr-defined]
        return subprocess.CompletedProcess(arguments, code, out, error)

    return call


@pytest.fixture
def process(tmp_path: Path) -> Cli:
    """Run the real command line in its own process, in an empty folder."""

    def call(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "giveway", *arguments],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )

    return call


@pytest.fixture(scope="session")
def short_run() -> Result:
    return giveway.run(short())


@pytest.fixture(scope="session")
def full_runs() -> dict[str, Result]:
    """The whole experiment with every bumper."""
    experiment = giveway.experiment("motionless")
    return {bumper: giveway.run(experiment.scenario(bumper)) for bumper in experiment.bumpers}
