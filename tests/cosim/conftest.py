"""Shared runs: a co-simulation of seconds is made once per session, and only read by the tests."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import giveway
import pytest
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
    """Run the real command line in its own process, in an empty folder."""

    def call(*arguments: str, environment: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "giveway", *arguments],
            cwd=tmp_path,
            env={**os.environ, **(environment or {})},
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
