"""A run that starts years after zero equals the run that starts at zero: drives, bus and controller tick alike."""

from __future__ import annotations

from pathlib import Path

import pytest
from component_run import Inputs
from fmu_driver import OK, Fmu, fmu_path
from test_model_exchange import servoed

RUNS: dict[str, tuple[dict[str, float], Inputs]] = {
    "controller": ({}, lambda t: {"sensor.torque[1]": 5.0 if t > 0.1 else 0.0, "sensor.counter": round(t * 1000)}),
    "testbed": ({"bumper.kind": 2}, lambda t: {"command.enable": True, "command.wheel_speed[1]": 0.3}),
    "drivetrain": ({"servo.enabled": True}, servoed),
    "bumper": ({"bumper.kind": 2}, lambda t: {"plate.position": -0.5 * max(0.0, t - 0.01), "plate.velocity": -0.5}),
}
STEPS, STEP_S = 200, 1e-3
TIMES = ("last_event_time", "truth.first_contact_time", "solver.")  # of the run's clock, and counts of work


def run(model: str, version: int, start_s: float, folder: Path) -> list[dict[str, float]]:
    parameters, inputs = RUNS[model]
    fmu = Fmu(fmu_path(model, version), version, folder)
    assert fmu.instantiate()
    for name, value in {**parameters, **inputs(0.0)}.items():
        assert fmu.set(name, value) == OK, fmu.last_message
    assert fmu.setup(start_s) == OK, fmu.last_message
    assert fmu.exit_initialisation() == OK, fmu.last_message
    outputs = [v.name for v in fmu.description.modelVariables if v.causality == "output"]
    outputs = [name for name in outputs if not name.startswith(TIMES)]
    rows = []
    for k in range(STEPS):
        for name, value in inputs(k * STEP_S).items():
            assert fmu.set(name, value) == OK, fmu.last_message
        assert fmu.step(start_s + k * STEP_S, STEP_S) == OK, fmu.last_message
        rows.append({name: fmu.get(name) for name in outputs})
    fmu.free()
    return rows


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("model", RUNS)
def test_the_start_time_changes_nothing(model: str, version: int, tmp_path: Path) -> None:
    expected = run(model, version, 0.0, tmp_path / "zero")
    assert sum(expected[0][name] != expected[-1][name] for name in expected[0]) > 2  # the run was a run
    for start_s in (1e7, 1e9):
        found = run(model, version, start_s, tmp_path / f"{start_s:g}")
        if model != "bumper":
            assert found == expected, "steps end at ticks: the same bits"
            continue
        # It knows no ticks: a step is as long as the difference of two times, which is 1e-3 s to 1e-7 s.
        for row, wanted in zip(found, expected, strict=True):
            for name, value in wanted.items():
                peak = max(abs(other[name]) for other in expected)
                assert row[name] == pytest.approx(value, abs=2e-4 * max(peak, 1e-3)), name
