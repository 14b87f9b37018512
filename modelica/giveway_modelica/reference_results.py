"""Results of every example for whoever runs the package in another tool: one CSV and one list of signals each."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from giveway_modelica.compiler import PACKAGE, Compiler, classes
from giveway_modelica.tube import at

FOLDER = PACKAGE.parent / "ReferenceResults"
COMMAND = "PYTHONPATH=modelica .venv/bin/python -m giveway_modelica results"
ROWS = 101  # evenly over the experiment: to compare with, not to look at
DIGITS = 9

_POSE = ("base.body.x", "base.body.y", "base.body.theta")
_TORQUES = ("tau_s[1]", "tau_s[2]", "tau_s[3]")
_DUMMY = ("slider.s", "slider.bumper.c", "contact.f_normal")
_BENCH = ("slider.s", "slider.bumper.c", "slider.bumper.f")


def _of(prefix: str, *names: str) -> tuple[str, ...]:
    return tuple(f"{prefix}.{name}" for name in names)


_MOTIONLESS = (*_of("testbed.robot", *_POSE[:2], *_TORQUES), *_of("testbed.dummy", *_DUMMY), "detection_time")
SIGNALS = {
    "DrivetrainStep": ("drivetrain.tau_s", "drivetrain.phi_m", "load.phi", "load.w"),
    "RollerWaves": _of("robot", *_POSE, *_TORQUES),
    "RollerWavesPair": _of("robot", *_POSE, *_TORQUES),
    "StaticPush": ("share", *_of("robot", *_POSE, *_TORQUES)),
    "MotionlessNoBumper": _MOTIONLESS,
    "MotionlessSpring": _MOTIONLESS,
    "MotionlessMagnetic": _MOTIONLESS,
    "MovingCollision": (*_of("robot", *_POSE[:2], *_TORQUES), *_of("dummy", *_DUMMY), "detection_time"),
    "CirclePushed": (*_of("robot", *_POSE[:2], *_TORQUES), "position.distance"),
    "CircleRound": (*_of("robot", *_POSE[:2], "controller.mode"), "position.distance"),
    "BumperDrop": (*_BENCH, "floor.nose.f"),
    "LatchRelease": (
        *_of("robot", *_POSE[:2]),
        *_of("dummy", *_DUMMY),
        *_of("dummy.slider.bumper", "t_release", "t_latch"),
    ),
    "BumperSweep": ("slider.s", "slider.bumper.c", "peak.peak"),
    **{f"Bumper{law}": (*_BENCH, "energy.lost") for law in ("Foam", "Gas", "Damper", "Series", "Lever", "Table")},
}


def table(result: Any, example: str) -> str:
    """The CSV of ``result`` of ``example``: time in s and the signals in their SI units."""
    settings = next(found.experiment for found in classes() if found.name == f"GiveWay.Examples.{example}")
    assert settings is not None
    wanted = np.linspace(0.0, settings[0], ROWS)
    time_s = np.asarray(result.time)
    columns = [wanted, *(at(time_s, np.asarray(result[name]), wanted) for name in SIGNALS[example])]
    rows = "".join(",".join(_shown(value) for value in row) + "\n" for row in zip(*columns, strict=True))
    return ",".join(f'"{name}"' for name in ("time", *SIGNALS[example])) + "\n" + rows


def _shown(value: float) -> str:
    # What is zero but for rounding would differ from machine to machine.
    return "0" if math.isclose(value, 0.0, abs_tol=1e-12) else f"{value:.{DIGITS}g}"


def texts(compiler: Compiler) -> Iterator[tuple[Path, str]]:
    """Path and content of every file."""
    for example, signals in SIGNALS.items():
        result = compiler.simulate(f"GiveWay.Examples.{example}")
        yield FOLDER / example / f"{example}.csv", table(result, example)
        yield FOLDER / example / "comparisonSignals.txt", "\n".join(("time", *signals)) + "\n"
