"""A small study that several test files share: cheap runs of real collisions."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet
from giveway.study import Study
from giveway.study.answers import Answers
from giveway.study.store import PARTS, list_parts, read_manifest

LATCH, SPRING = "testbed.bumper.latch_force", "testbed.bumper.spring_rate"
LATCH_STUDY = """\
[scenario]
duration = 0.2
bumper = "magnetic"
[[collision]]
speed = 0.5
mass = 9.08
edge = 0
time = 0.12
[[vary]]
quantity = "testbed.bumper.latch_force"
low = 0.0
high = 60.0
"""
"""Lines of a study file: a collision of 0.1 s with latches of any force."""
JUDGED_LATCH_STUDY = LATCH_STUDY.replace("duration = 0.2", "duration = 0.65")
"""The same until the contact is over."""


class SmallStudy(Study):
    """Writes no report, unless it is asked to: most tests look at the answers only."""

    def run(self, folder: Path | str, *, files: bool = False, **options: Any) -> Answers:
        return super().run(folder, files=files, **options)

    def optimise(self, folder: Path | str, *, files: bool = False, **options: Any) -> Answers:
        return super().optimise(folder, files=files, **options)


def small_study(**changes: Any) -> Study:
    """Four latch forces with a collision of 0.1 s each, and no objectives; ``changes`` replace tables."""
    study = SmallStudy("small", duration=0.2, bumper="magnetic")
    study.collision("front", speed=0.5, mass=9.08, edge=0, time=0.12)
    study.vary(LATCH, values=[0.0, 20.0, 40.0, 60.0])
    study.document.update(changes)
    return study


def judged_study(**changes: Any) -> Study:
    """The same until the contact is over, so that peak force and travel are known."""
    study = small_study(**changes)
    study.document["scenario"]["duration"] = 0.65
    return study


def part_files(folder: Path) -> list[Path]:
    """Every part of the study in ``folder``, whatever it was when they were written."""
    return [path for parts in sorted((folder / PARTS).glob("*")) for _, _, path in list_parts(parts)]


def stored_runs(folder: Path) -> dict[str, np.ndarray]:
    """All stored runs of the study in ``folder``, in their order, by column."""
    parts = list_parts(folder / PARTS / read_manifest(folder)["fingerprint"][:16])
    tables = [pyarrow.parquet.read_table(path) for _, _, path in parts]
    names = tables[0].column_names
    return {name: np.concatenate([np.array(table[name].to_pylist()) for table in tables]) for name in names}


def interrupt(cwd: Path, command: list[str], parts: int, folder: str | None = None) -> tuple[str, str]:
    """Run ``giveway COMMAND`` in ``cwd``, press Ctrl-C when so many parts are stored; output and errors.

    The parts are looked for in ``folder``; without it the command ends in its name.
    """
    with subprocess.Popen(
        [sys.executable, "-m", "giveway", *command], cwd=cwd, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        for _ in range(1200):
            if len(part_files(cwd / (folder or command[-1]))) >= parts:
                break
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        out, said = process.communicate(timeout=60)
    assert process.returncode == 130, out + said
    assert "Traceback" not in said, said
    return out, said
