"""Helpers that several test files share."""

from __future__ import annotations

import dataclasses
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import giveway

Cli = Callable[..., subprocess.CompletedProcess[str]]


def short(bumper: str = "magnetic", **changes: object) -> giveway.Scenario:
    """The motionless experiment up to shortly after the detection; ``testbed`` is added to its own."""
    scenario = giveway.experiment("motionless").scenario(bumper)
    testbed = {**scenario.testbed, **changes.pop("testbed", {})}  # type: ignore[dict-item]
    return dataclasses.replace(scenario, **{"duration_s": 0.5, "testbed": testbed, **changes})  # type: ignore[arg-type]


def folder_content(folder: Path) -> Sequence[str]:
    """All names below ``folder``, hidden ones too."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))
