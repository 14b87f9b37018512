"""Steps an FMU through piecewise constant inputs and records its outputs."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from fmu_driver import OK, Fmu, fmu_path

Inputs = Callable[[float], Mapping[str, float]]


def co_simulate(
    model: str,
    parameters: Mapping[str, float],
    inputs: Inputs,
    stop_s: float,
    step_s: float,
    outputs: Sequence[str],
    version: int = 3,
) -> dict[str, np.ndarray]:
    """Outputs at every communication point, ``time`` included; ``inputs(t)`` hold over the step that starts at t."""
    with tempfile.TemporaryDirectory() as folder:
        fmu = Fmu(fmu_path(model, version), version, Path(folder))
        assert fmu.instantiate(), fmu.last_message
        for name, value in {**parameters, **inputs(0.0)}.items():
            assert fmu.set(name, value) == OK, fmu.last_message
        assert fmu.setup() == OK, fmu.last_message
        assert fmu.exit_initialisation() == OK, fmu.last_message
        steps = round(stop_s / step_s)
        rows = [[fmu.get(name) for name in outputs]]
        for k in range(steps):
            time = k * step_s
            for name, value in inputs(time).items():
                assert fmu.set(name, value) == OK, fmu.last_message
            assert fmu.step(time, step_s) == OK, fmu.last_message
            rows.append([fmu.get(name) for name in outputs])
        fmu.free()
    columns = np.array(rows, dtype=float).T
    return {"time": np.arange(steps + 1) * step_s, **dict(zip(outputs, columns, strict=True))}


def refusal(model: str, parameters: Mapping[str, float]) -> str:
    """The FMU's message when it refuses to initialise with these parameters."""
    with tempfile.TemporaryDirectory() as folder:
        fmu = Fmu(fmu_path(model, 3), 3, Path(folder))
        assert fmu.instantiate()
        for name, value in parameters.items():
            assert fmu.set(name, value) == OK, fmu.last_message
        assert fmu.setup() == OK
        assert fmu.exit_initialisation() != OK
        fmu.free()
        return fmu.last_message
