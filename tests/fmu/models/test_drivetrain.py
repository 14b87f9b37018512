"""The drivetrain FMU against scipy, closed forms and its own energy account."""

from __future__ import annotations

import math

import numpy as np
import pytest
from component_run import co_simulate, refusal
from drivetrain_reference import Parameters, simulate

STATES = ("motor.angle", "motor.speed", "load.angle", "load.speed")
ACCOUNT = ("energy.stored", "energy.work_in", "energy.dissipated", "energy.residual")
EVENTS = ("events", "last_event_time")
TIGHT = {"solver.relative_tolerance": 1e-9}


def shove(t: float) -> tuple[float, float]:
    """Motor torque beyond the limit and back, then the environment pushes the other way: every gear event happens."""
    motor = 26.0 if t < 0.05 else -9.0 if t < 0.16 else 0.0
    environment = 0.0 if t < 0.2 else -7.0 if t < 0.3 else 1.0
    return motor, environment


def named(torques) -> object:
    return lambda t: dict(zip(("motor.torque", "environment.torque"), torques(t), strict=True))


def largest_deviation(run: dict[str, np.ndarray], trace) -> float:
    """Over all signals, relative to each signal's peak."""
    signals = {**dict(zip(STATES, trace.states.T, strict=True)), "sensor.torque": trace.sensed}
    return max(float(np.max(np.abs(run[name] - wanted)) / np.max(np.abs(wanted))) for name, wanted in signals.items())


@pytest.mark.parametrize("stiction", [2.8, 3.2])
def test_it_follows_the_reference(stiction: float) -> None:
    p = Parameters(gear_stiction=stiction)
    outputs = [*STATES, "sensor.torque", *ACCOUNT, *EVENTS]
    run = co_simulate("drivetrain", {**p.as_variables(), **TIGHT}, named(shove), 0.5, 1e-3, outputs)
    trace = simulate(p, shove, run["time"])
    assert len(trace.events) >= 4
    # 1e-9 per step and half a thousand restarts; measured 1.1e-8 of the peak.
    assert largest_deviation(run, trace) < 1e-7
    assert run["events"][-1] == len(trace.events)
    seen = sorted(set(run["last_event_time"]) - {-1.0})
    # Event instants inherit the state's error divided by the indicator's slope; a step with several shows its last.
    assert all(min(abs(np.array(trace.events) - time)) < 1e-7 for time in seen)
    assert len(seen) >= 4
    # Of some 2 J turned over; 1e-9 a step.
    assert np.max(np.abs(run["energy.residual"])) < 1e-7
    assert run["energy.dissipated"][-1] > 1.0


def test_a_wrong_reference_is_noticed() -> None:
    """The tolerance above is far below the effect of a missing element."""
    p = Parameters()
    run = co_simulate("drivetrain", {**p.as_variables(), **TIGHT}, named(shove), 0.3, 1e-3, [*STATES, "sensor.torque"])
    for change in ({"gear_viscous": 0.0201}, {"coulomb": 1.501}, {"damping": 1.001}, {"gear_coulomb": 2.801}):
        trace = simulate(Parameters(**change), shove, run["time"])
        assert largest_deviation(run, trace) > 1e-6, change


def test_the_gear_holds_without_creeping() -> None:
    """The push of 5.1 on an unpowered robot: a stuck gear does not move at all."""
    outputs = [*STATES, "gear.stuck", "sensor.torque"]
    run = co_simulate("drivetrain", {}, lambda t: {"environment.torque": -2.7 * min(1.0, t / 2.0)}, 6.0, 0.01, outputs)
    assert set(run["gear.stuck"]) == {1.0}
    assert set(run["motor.angle"]) == {0.0}
    assert set(run["motor.speed"]) == {0.0}
    assert run["sensor.torque"][-1] == pytest.approx(2.7, rel=1e-6)  # the default tolerance


def test_it_breaks_away_at_the_stiction() -> None:
    p = {"drivetrain.gear_stiction": 4.0, **TIGHT}
    run = co_simulate("drivetrain", p, lambda t: {"motor.torque": 10.0 * t}, 0.5, 1e-3, ["gear.stuck", "sensor.torque"])
    first = run["time"][np.argmin(run["gear.stuck"])]
    # Torque is held over a step of 1 ms: 4.0 is exceeded by the step that starts at 0.401 s and seen at its end.
    assert first == pytest.approx(0.402, abs=1e-9)


def test_a_load_on_its_spring_is_a_damped_oscillator() -> None:
    """Motor stuck: J q'' + d q' + k q = 0."""
    inertia, stiffness, damping, start = 0.2, 600.0, 3.0, 0.004
    parameters = {
        "load.inertia": inertia, "drivetrain.stiffness": stiffness, "drivetrain.damping": damping,
        "drivetrain.gear_stiction": 100.0, "drivetrain.gear_coulomb": 100.0, "start.load_angle": start, **TIGHT,
    }  # fmt: skip
    run = co_simulate("drivetrain", parameters, lambda t: {}, 0.5, 2e-3, ["load.angle", "sensor.torque"])
    decay = damping / (2.0 * inertia)
    omega = math.sqrt(stiffness / inertia - decay**2)
    t = run["time"]
    wanted = start * np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
    assert np.max(np.abs(run["load.angle"] - wanted)) < 1e-8 * start + 1e-9  # the absolute tolerance is 1e-9 rad


def test_without_friction_the_torque_becomes_momentum() -> None:
    friction = ("gear_stiction", "gear_coulomb", "gear_viscous")
    parameters = {"load.inertia": 0.1, **{f"drivetrain.{name}": 0.0 for name in friction}, **TIGHT}
    torques = {"motor.torque": 3.0, "environment.torque": -1.0}
    run = co_simulate("drivetrain", parameters, lambda t: torques, 0.3, 1e-3, STATES)
    momentum = 0.0523 * run["motor.speed"] + 0.1 * run["load.speed"]
    assert momentum == pytest.approx(2.0 * run["time"], abs=1e-8)


@pytest.mark.parametrize("delay", [0, 3])
def test_the_servo_follows_the_reference(delay: int) -> None:
    """Compared with a servo written from its description; the remaining difference is single against double
    precision."""
    p = Parameters(delay=delay, load_inertia=0.1)

    def reference(t: float) -> tuple[float, float]:
        return (0.5 * t, 0.5) if t < 0.3 else (0.15, 0.0)

    def torques(t: float) -> tuple[float, float]:
        return 0.0, -4.0 if t > 0.2 else 0.0

    def inputs(t: float) -> dict[str, float]:
        angle, speed = reference(t)
        motor, environment = torques(t)
        names = ("motor.torque", "environment.torque", "servo.reference_angle", "servo.reference_speed")
        return dict(zip(names, (motor, environment, angle, speed), strict=True))

    parameters = {**p.as_variables(), "servo.enabled": True, **TIGHT}
    run = co_simulate("drivetrain", parameters, inputs, 0.5, 5e-4, [*STATES, "sensor.torque", "servo.torque"])
    trace = simulate(p, torques, run["time"], reference=reference)
    assert np.max(np.abs(run["load.angle"])) > 0.1  # of 0.15: friction keeps the rest
    # Floats carry 6e-8; 8 N m s/rad on the difference of two of them. A count more or less would be 2 N m.
    assert largest_deviation(run, trace) < 1e-5


def test_the_motors_current_is_sampled_before_the_servo_acts() -> None:
    def inputs(t: float) -> dict[str, float]:
        return {"servo.reference_angle": 0.05 if t < 0.1 else -0.02, "servo.reference_speed": 0.0}

    parameters = {"servo.enabled": True, "load.inertia": 0.1}
    names = ("servo.torque", "sensor.motor_torque", "sensor.torque", "gear.stuck")
    run = co_simulate("drivetrain", parameters, inputs, 0.4, 5e-4, names)
    # A row shows the servo's torque of the half millisecond before it; every other one is a cycle of the bus.
    assert run["sensor.motor_torque"][::2].tolist() == run["servo.torque"][::2].tolist()
    assert run["sensor.motor_torque"][1::2].tolist() == run["sensor.motor_torque"][:-1:2].tolist()
    assert np.ptp(run["sensor.motor_torque"]) > 5.0
    # The gear's friction stands between the two: at rest up to its stiction.
    held = run["gear.stuck"] > 0.5
    assert held[-1]
    assert abs(run["sensor.motor_torque"] - run["sensor.torque"])[-1] <= 2.75


def test_steps_of_whole_ticks_give_the_same_bits() -> None:
    def inputs(t: float) -> dict[str, float]:
        return {"servo.reference_speed": 0.3, "environment.torque": 2.0}

    parameters = {"servo.enabled": True}
    fine, coarse = (co_simulate("drivetrain", parameters, inputs, 0.2, step, STATES) for step in (5e-4, 4e-3))
    for name in STATES:
        assert list(fine[name][::8]) == list(coarse[name])


def test_steps_across_ticks_agree_to_the_tolerance() -> None:
    def inputs(t: float) -> dict[str, float]:
        return {"servo.reference_angle": 0.1}

    parameters = {"servo.enabled": True, **TIGHT}
    whole, odd = (co_simulate("drivetrain", parameters, inputs, 0.21, step, STATES) for step in (1e-3, 7e-4))
    # The integrator stops at other instants: a few times its relative tolerance.
    assert odd["motor.angle"][-1] == pytest.approx(whole["motor.angle"][-1], rel=1e-7)


def test_what_does_not_fit_together_is_refused() -> None:
    text = refusal("drivetrain", {"drivetrain.gear_stiction": 1.0, "drivetrain.gear_coulomb": 2.8})
    assert "drivetrain.gear_stiction = 1 is not allowed: it must be at least drivetrain.gear_coulomb = 2.8" in text
