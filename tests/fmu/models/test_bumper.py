"""The bumper FMU against closed forms, and as a part of a system that scipy solves as a whole."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from component_run import Inputs, co_simulate
from fmu_driver import OK, Fmu, fmu_path
from scipy.integrate import solve_ivp

SPRING, MAGNETIC = 1, 2
CONTINUOUS, IDEAL = 0, 1
KINDS = {"spring": (SPRING, CONTINUOUS), "continuous": (MAGNETIC, CONTINUOUS), "ideal": (MAGNETIC, IDEAL)}
RATE, PRELOAD, DAMPING, FRICTION, FRICTION_SPEED = 800.0, 3.0, 6.0, 0.7, 0.01
TRAVEL, STOP, STOP_DAMPING, LATCH, GAP = 0.05, 2e4, 0.8, 30.0, 0.002
NUMBERS = {
    "spring_rate": RATE, "preload": PRELOAD, "damping": DAMPING, "guide_friction": FRICTION,
    "guide_friction_speed": FRICTION_SPEED, "travel": TRAVEL, "stop_stiffness": STOP, "stop_damping": STOP_DAMPING,
    "latch_force": LATCH, "latch_gap": GAP,
}  # fmt: skip
FORCES = ("carrier.force", "plate.force", "compression", "compression_rate", "latched", "end_stop", "bottom_stop")
ACCOUNT = ("energy.stored", "energy.work_in", "energy.dissipated", "energy.residual")
EVENTS = ("events", "last_event_time")


def parameters(kind: str) -> dict[str, float]:
    which, latch = KINDS[kind]
    numbers = {f"bumper.{name}": value for name, value in NUMBERS.items()}
    tight = {"solver.relative_tolerance": 1e-9, "solver.absolute_scale": 1e-5}  # 1e-12 J
    return {**numbers, "bumper.kind": which, "bumper.latch_model": latch, **tight}


def law(kind: str, c: float, rate: float) -> float:
    """The force that extends the bumper, from the README of the plant; at c = 0 as seen while compressing."""
    force = PRELOAD + RATE * c + DAMPING * rate + FRICTION * math.tanh(rate / FRICTION_SPEED)
    if kind == "continuous":
        force += LATCH / (1.0 + max(c, 0.0) / GAP) ** 2
    if kind == "ideal" and c < 0.0:
        force += LATCH
    if c < 0.0:
        force -= max(0.0, -STOP * c * (1.0 - STOP_DAMPING * rate))
    if c > TRAVEL:
        force += max(0.0, STOP * (c - TRAVEL) * (1.0 + STOP_DAMPING * rate))
    return force


def triangle(speed: float, top: float, bottom: float = 0.0) -> Callable[[float], tuple[float, float]]:
    """Compression and its rate: from ``bottom`` to ``top`` and back, again and again."""
    half = (top - bottom) / speed

    def motion(t: float) -> tuple[float, float]:
        _, phase = divmod(t / half + 1e-9, 2.0)  # the corner belongs to the stroke that it begins
        phase -= 1e-9
        return (
            (bottom + speed * half * phase, speed) if phase < 1.0 - 1e-9 else (top - speed * half * (phase - 1), -speed)
        )

    return motion


def moved(motion: Callable[[float], tuple[float, float]]) -> Inputs:
    """Both faces take their share of the compression, on top of a common motion."""

    def inputs(t: float) -> dict[str, float]:
        c, rate = motion(t)
        common, speed = 0.3 * t, 0.3
        return {
            "carrier.position": common + 0.25 * c, "carrier.velocity": speed + 0.25 * rate,
            "plate.position": common - 0.75 * c, "plate.velocity": speed - 0.75 * rate,
        }  # fmt: skip

    return inputs


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("rate", [0.0, 0.2, -0.003])
@pytest.mark.parametrize("c", [-0.0008, 0.0007, 0.01, 0.0495, 0.0512])
def test_the_force_is_that_of_the_law(kind: str, c: float, rate: float) -> None:
    run = co_simulate("bumper", parameters(kind), moved(lambda t: (c + rate * t, rate)), 1e-3, 1e-4, FORCES)
    for k, time in enumerate(run["time"]):
        wanted = law(kind, c + rate * time, rate)
        # Rounding of positions near 1e-3 m, times the stop's stiffness.
        assert run["plate.force"][k] == pytest.approx(wanted, abs=1e-10)
        assert run["carrier.force"][k] == -run["plate.force"][k]
    assert set(run["end_stop"]) == {float(c < 0)}
    assert set(run["bottom_stop"]) == {float(c > TRAVEL)}
    assert run["latched"][0] == float({"spring": False, "continuous": c < GAP, "ideal": c < 0}[kind])


def test_the_ideal_latch_snaps_at_full_extension() -> None:
    motion = triangle(0.1, 0.00995, -0.00105)  # 110 steps up, 110 down; through zero at 10.5 and 209.5 ms
    run = co_simulate("bumper", parameters("ideal"), moved(motion), 0.22, 1e-3, [*FORCES, *EVENTS])
    force, latched = run["plate.force"], run["latched"]
    assert list(np.flatnonzero(np.diff(latched))) == [10, 209]
    drag = DAMPING * 0.1 + FRICTION * math.tanh(10.0)
    assert force[10] == pytest.approx(
        PRELOAD + LATCH - RATE * 5e-5 + drag - STOP * 5e-5 * (1 - STOP_DAMPING * 0.1), abs=1e-9
    )
    assert force[11] == pytest.approx(PRELOAD + RATE * 5e-5 + drag, abs=1e-9)
    assert sorted(set(run["last_event_time"])) == pytest.approx([-1.0, 0.0105, 0.2095], abs=1e-11)
    assert run["events"][-1] == 2


@pytest.mark.parametrize("kind", KINDS)
def test_energy_over_whole_strokes(kind: str) -> None:
    """Back and forth: the absorbed energy is heat, in closed form; latch and spring return the energy they stored."""
    speed, top, bottom = 0.25, 0.04, -0.0005
    half = (top - bottom) / speed
    outputs = [*FORCES, *ACCOUNT]
    run = co_simulate("bumper", parameters(kind), moved(triangle(speed, top, bottom)), 4 * half, half / 100, outputs)
    drag = DAMPING * speed + FRICTION * math.tanh(speed / FRICTION_SPEED)
    rubbing = drag * speed * 4 * half
    # The end stop's damping over its compression in each of four passes: it pushes k x (1 -+ e v).
    stop = 4 * 0.5 * STOP * bottom**2 * STOP_DAMPING * speed
    assert run["energy.dissipated"][-1] == pytest.approx(rubbing + stop, rel=1e-8)
    assert run["energy.work_in"][-1] == pytest.approx(rubbing + stop, rel=1e-8)
    assert abs(run["energy.stored"][-1]) < 1e-9
    # Of 0.8 J; 1e-9 and 400 restarts.
    assert np.max(np.abs(run["energy.residual"])) < 1e-8
    assert np.max(run["energy.stored"]) > 0.6


def test_stops_are_met_within_a_step() -> None:
    """A step of 0.1 s crosses full extension and bottom; the instants follow from the speed."""
    outputs = [*FORCES, *ACCOUNT, *EVENTS]
    run = co_simulate("bumper", parameters("spring"), moved(lambda t: (-0.01 + 0.7 * t, 0.7)), 0.1, 0.1, outputs)
    assert run["events"][-1] == 2
    # Located to rounding of the step: 1e-13 s and a bit.
    assert run["last_event_time"][-1] == pytest.approx((0.01 + TRAVEL) / 0.7, abs=1e-11)
    assert run["plate.force"][-1] == pytest.approx(law("spring", 0.06, 0.7), abs=1e-9)
    assert abs(run["energy.residual"][-1]) < 1e-8  # of 4 J: both corners were located


def test_a_position_that_jumps_shows_in_the_residual() -> None:
    """What a coupling that moves the faces wrongly adds in energy."""
    run = co_simulate(
        "bumper", parameters("spring"), moved(lambda t: (0.01 + 0.002 * (t > 0.05), 0.0)), 0.1, 0.01, ACCOUNT
    )
    jump = PRELOAD * 0.002 + 0.5 * RATE * (0.012**2 - 0.01**2)
    assert run["energy.residual"][-1] == pytest.approx(-jump, rel=1e-9)


def coupled_drop(kind: str, mass: float, speed: float, stop_s: float, step_s: float, folder: Path) -> np.ndarray:
    """Plate position of a mass that is thrown onto the bumper, carrier fixed; the force is held over a step."""
    fmu = Fmu(fmu_path("bumper", 3), 3, folder)
    assert fmu.instantiate()
    for name, value in parameters(kind).items():
        assert fmu.set(name, value) == OK, fmu.last_message
    x, v = rest(kind), -speed
    assert fmu.set("plate.position", x) == OK
    assert fmu.set("plate.velocity", v) == OK
    assert fmu.setup() == OK
    assert fmu.exit_initialisation() == OK
    rows = [x]
    for k in range(round(stop_s / step_s)):
        acceleration = fmu.get("plate.force") / mass - 9.81
        x += v * step_s + 0.5 * acceleration * step_s**2
        v += acceleration * step_s
        rows.append(x)
        assert fmu.set("plate.position", x) == OK
        assert fmu.set("plate.velocity", v) == OK
        assert fmu.step(k * step_s, step_s) == OK, fmu.last_message
    fmu.free()
    return np.array(rows)


def rest(kind: str) -> float:
    """Where the plate rests on its end stop (position, so above full extension)."""
    return (PRELOAD + (LATCH if kind != "spring" else 0.0)) / (RATE + STOP)


def whole_drop(kind: str, mass: float, speed: float, times: np.ndarray) -> np.ndarray:
    """The same as one system, restarted where the law has corners."""

    def rate(_: float, y: np.ndarray) -> list[float]:
        return [y[1], law(kind, -y[0], -y[1]) / mass - 9.81]

    corners = [lambda t, y: y[0], lambda t, y: y[0] + TRAVEL]
    for corner in corners:
        corner.terminal = True  # type: ignore[attr-defined]
    state, time = np.array([rest(kind), -speed]), 0.0
    rows = [state[0]]
    for end in times[1:]:
        while time < end - 1e-12:
            step = solve_ivp(rate, (time, end), state, method="DOP853", rtol=1e-10, atol=1e-12, events=corners)
            time, state = float(step.t[-1]), step.y[:, -1].copy()
            if step.status == 1:  # over the corner, by far less than the tolerance
                state[0] += 1e-13 * np.sign(state[1])
        rows.append(state[0])
    return np.array(rows)


@pytest.mark.parametrize("kind", KINDS)
def test_a_mass_dropped_on_it(kind: str, tmp_path: Path) -> None:
    """Coupled once per step: the error is of first order in the step, and small."""
    mass, speed, stop = 2.0, 0.8, 0.12
    errors = []
    for step in (2e-4, 1e-4, 5e-5):
        run = coupled_drop(kind, mass, speed, stop, step, tmp_path / str(step))
        coarse = run[:: round(1e-3 / step)]
        exact = whole_drop(kind, mass, speed, np.arange(len(coarse)) * 1e-3)
        errors.append(float(np.max(np.abs(coarse - exact)) / np.max(np.abs(exact))))
    assert errors[-1] < 2e-3
    # Halving the step halves the error; a corner that is met early or late within a step leaves some scatter.
    assert all(1.4 < before / after < 2.8 for before, after in pairwise(errors)), errors
