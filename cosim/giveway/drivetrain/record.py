"""A drivetrain as one JSON file: the linear analysis and the FMU's measured response."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.files import write_text

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.drivetrain.analysis import Analysis, Case
    from giveway.drivetrain.frequency_response import Sweep

__all__ = ["write_json"]

SCHEMA_VERSION = 1


def write_json(path: Path, title: str, analysis: Analysis, sweeps: Sequence[Sweep]) -> None:
    """Every number and curve, atomically. Curves hold the magnitude (N m/N m) and the phase (deg)."""
    document = {
        "schema_version": SCHEMA_VERSION,
        "title": title,
        "sensing": "motor current" if analysis.motor_current else "torque sensor",
        "parameters": {
            name: value if math.isfinite(value) else "locked"
            for name, value in {**analysis.drivetrain.variables(), **analysis.servo.variables()}.items()
        },
        "frequency_hz": _digits(analysis.frequency_hz),
        "time_s": _digits(analysis.time_s),
        "servo_loop": {"margins": dataclasses.asdict(analysis.margins), **_curve(analysis.loop)},
        "cases": {name: _case_document(case) for name, case in analysis.cases.items()},
        "measured": [
            {"case": sweep.case, "source": sweep.source, "frequency_hz": _digits(sweep.frequency_hz)}
            | _curve(sweep.response)
            for sweep in sweeps
        ],
    }
    write_text(path, json.dumps(document, allow_nan=False, separators=(",", ":")) + "\n")


def _case_document(case: Case) -> dict[str, Any]:
    channels = {}
    for source, channel in case.channels.items():
        numbers = dataclasses.asdict(channel)
        numbers.update(_curve(numbers.pop("response")), step=_digits(channel.step))
        channels[source] = numbers
    poles = [
        {**dataclasses.asdict(pole), "frequency_hz": pole.frequency_hz, "damping": pole.damping} for pole in case.poles
    ]
    return {"poles": poles, "stable": case.stable, "channels": channels}


def _curve(response: NDArray[np.complex128]) -> dict[str, list[float]]:
    return {"magnitude": _digits(np.abs(response)), "phase_deg": _digits(np.degrees(np.unwrap(np.angle(response))))}


def _digits(values: NDArray[np.float64]) -> list[float]:
    """Enough digits for a curve."""
    return [float(f"{value:.7g}") for value in values]
