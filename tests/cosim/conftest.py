"""Shared runs: a co-simulation of seconds is made once per session, and only read by the tests."""

from __future__ import annotations

import dataclasses
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import giveway
import pytest
from giveway.result import Result

Cli = Callable[..., subprocess.CompletedProcess[str]]


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


def short(bumper: str = "magnetic", **changes: object) -> giveway.Scenario:
    """The motionless experiment up to shortly after the detection."""
    scenario = giveway.experiment("motionless").scenario(bumper)
    return dataclasses.replace(scenario, **{"duration_s": 0.5, **changes})  # type: ignore[arg-type]


@pytest.fixture(scope="session")
def short_run() -> Result:
    return giveway.run(short())


@pytest.fixture(scope="session")
def full_runs() -> dict[str, Result]:
    """The whole experiment with every bumper."""
    experiment = giveway.experiment("motionless")
    return {bumper: giveway.run(experiment.scenario(bumper)) for bumper in experiment.bumpers}


def folder_content(folder: Path) -> Sequence[str]:
    """All names below ``folder``, hidden ones too."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))
