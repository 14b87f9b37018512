"""The drivetrain FMU, nonlinear and sampled, lies on the linear model: sines through it in co-simulation."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from cosim_helpers import Cli
from giveway.base.errors import GivewayError, SimulationError
from giveway.drivetrain import frequency_response
from giveway.drivetrain.analysis import SOURCES, analyse
from giveway.drivetrain.frequency_response import Sweep, measure
from giveway.drivetrain.model import CURRENT, SERVO_PERIOD_S, Drivetrain, Servo, read, response

FREQUENCY_HZ = np.array([0.7, 4.0, 9.0, 19.0, 33.0, 80.0, 250.0, 600.0])
FRICTION_NM = 2.8  # Trikey's
# With 64 samples per period the input has an image of 1/63 of its amplitude at 63 times its frequency; part passes
# and aliases back: 0.08 % and 0.05 deg measured. With the servo the encoder adds noise: one of its million counts is
# kd g (2 pi/1e6)/T = 17 mN m for a tick, and of sines of up to 10 N m as little as a thousandth is sensed: 0.11 % and
# 0.06 deg measured.
GAIN, PHASE_DEG = 1.5e-3, 0.1
SERVO_GAIN, SERVO_PHASE_DEG = 5e-3, 0.3


def deviation(measured: Sweep, drivetrain: Drivetrain, servo: Servo) -> tuple[float, float]:
    """Largest deviations from the model: of the gain, relative, and of the phase, deg."""
    used = servo if measured.case == "servo" else None
    stuck = measured.case == "gear stuck"
    ratio = measured.response / response(drivetrain, used, SOURCES[measured.source], measured.frequency_hz, stuck=stuck)
    return float(np.max(np.abs(np.abs(ratio) - 1.0))), float(np.degrees(np.max(np.abs(np.angle(ratio)))))


@pytest.mark.parametrize("load", ["base", "wheel"])
@pytest.mark.parametrize(
    ("case", "source", "bias_speed"),
    [
        ("gear stuck", "environment", 0.0),
        ("unpowered", "environment", 5.0),
        ("unpowered", "motor", 5.0),
        ("unpowered", "motor", 0.0),
        ("servo", "environment", 5.0),
        ("servo", "environment", 0.0),
        ("servo", "motor", 5.0),
    ],
)
def test_the_fmu_lies_on_the_model(load: str, case: str, source: str, bias_speed: float) -> None:
    """With the gear's real friction, stuck or sliding one way; with no bias, without Coulomb friction."""
    drivetrain, servo = read(load=load)
    measured = measure(drivetrain, servo, case, source, FREQUENCY_HZ, gear_friction=FRICTION_NM, bias_speed=bias_speed)
    assert measured.frequency_hz == pytest.approx(FREQUENCY_HZ, rel=0.05)
    gain, phase_deg = deviation(measured, drivetrain, servo)
    assert gain < (SERVO_GAIN if case == "servo" else GAIN)
    assert phase_deg < (SERVO_PHASE_DEG if case == "servo" else PHASE_DEG)


@pytest.mark.parametrize("source", SOURCES)
def test_the_fmus_current_lies_on_the_model(source: str) -> None:
    drivetrain, servo = read(load="base")
    frequency = np.array([3.0, 9.0, 19.0, 30.0])  # an encoder's count is 4 % of what is sensed at 80 Hz
    measured = measure(drivetrain, servo, "servo", source, frequency, gear_friction=FRICTION_NM, motor_current=True)
    model = response(drivetrain, servo, SOURCES[source], measured.frequency_hz, sink=CURRENT)
    ratio = measured.response / model
    assert np.max(np.abs(np.abs(ratio) - 1.0)) < SERVO_GAIN
    assert np.degrees(np.max(np.abs(np.angle(ratio)))) < SERVO_PHASE_DEG
    tick_late = ratio * np.exp(2j * np.pi * measured.frequency_hz * SERVO_PERIOD_S)
    assert np.degrees(np.max(np.abs(np.angle(tick_late)))) > 5.0 * SERVO_PHASE_DEG
    with pytest.raises(GivewayError, match="the motor's current shows nothing else"):
        measure(drivetrain, servo, "unpowered", source, frequency, gear_friction=FRICTION_NM, motor_current=True)


@pytest.mark.parametrize("fmi_version", [2, 3])
def test_a_delayed_servo_lies_on_the_model_with_that_delay_only(fmi_version: int) -> None:
    drivetrain, servo = read(load="wheel", delay=5)
    frequency = np.array([5.0, 25.0, 60.0])
    measured = measure(
        drivetrain, servo, "servo", "motor", frequency, gear_friction=FRICTION_NM, fmi_version=fmi_version
    )
    gain, phase_deg = deviation(measured, drivetrain, servo)
    assert gain < SERVO_GAIN
    assert phase_deg < SERVO_PHASE_DEG
    for delay in (4, 6):
        gain, phase_deg = deviation(measured, drivetrain, dataclasses.replace(servo, delay=delay))
        assert gain > 5.0 * SERVO_GAIN
        assert phase_deg > 5.0 * SERVO_PHASE_DEG


def test_other_numbers_are_noticed() -> None:
    drivetrain, servo = read()
    measured = measure(drivetrain, servo, "servo", "environment", FREQUENCY_HZ, gear_friction=FRICTION_NM)
    for field in ("motor_inertia", "stiffness", "damping", "load_inertia"):
        other = dataclasses.replace(drivetrain, **{field: 1.02 * getattr(drivetrain, field)})
        assert deviation(measured, other, servo)[0] > 2.0 * SERVO_GAIN, field
    for field in ("kp", "kd", "derivative_cutoff"):
        other_servo = dataclasses.replace(servo, **{field: 1.05 * getattr(servo, field)})
        assert deviation(measured, drivetrain, other_servo)[0] > 1.5 * SERVO_GAIN, field


def test_a_gear_that_changes_its_mode_is_not_averaged_over(monkeypatch: pytest.MonkeyPatch) -> None:
    drivetrain, servo = read()
    monkeypatch.setattr(frequency_response, "SHARE", 3.0)  # of what the gear can bear
    for case in ("gear stuck", "unpowered"):
        with pytest.raises(SimulationError, match="the gear changed"):
            measure(drivetrain, servo, case, "environment", np.array([3.0]), gear_friction=0.3, bias_speed=0.1)


def test_what_cannot_be_measured_is_refused() -> None:
    drivetrain, servo = read()
    frequency = np.array([3.0])
    locked, endless = read(load="locked")[0], dataclasses.replace(drivetrain, damping=0.01)
    late = dataclasses.replace(servo, delay=60)
    for arguments, friction, word in (
        ((locked, servo, "servo", "motor", frequency), 1.0, "load"),
        ((drivetrain, late, "servo", "motor", frequency), 1.0, "stable"),
        ((endless, servo, "gear stuck", "environment", frequency), 1.0, "settles"),
        ((drivetrain, servo, "gear stuck", "environment", frequency), 0.0, "gear_friction"),
        ((drivetrain, servo, "stuck", "environment", frequency), 1.0, "gear stuck"),
        ((drivetrain, servo, "servo", "sensor", frequency), 1.0, "environment, motor"),
        ((drivetrain, servo, "servo", "motor", np.array([950.0])), 1.0, "frequency_hz"),
        ((drivetrain, servo, "servo", "motor", frequency), np.nan, "gear_friction"),
    ):
        with pytest.raises(GivewayError, match=word):
            measure(*arguments, gear_friction=friction)


def test_an_amplitude_may_be_a_quarter_of_the_motor_s_limit() -> None:
    drivetrain, servo = read()
    most = frequency_response.TORQUE_LIMIT_NM / 4.0
    for amplitude, refused in ((most, "frequency_hz"), (1.001 * most, "amplitude")):
        with pytest.raises(GivewayError, match=refused):  # of both, the amplitude is looked at first
            measure(
                drivetrain, servo, "servo", "motor", np.array([950.0]), gear_friction=FRICTION_NM, amplitude=amplitude
            )


@pytest.mark.deep
def test_command_compares(cli: Cli) -> None:
    done = cli("drivetrain", "--sweep")
    assert done.returncode == 0, done.stderr
    rows = [line for line in done.stdout.splitlines() if line.rstrip().endswith("deg")]
    assert len(rows) == 5 == sum(len(case.channels) for case in analyse(*read()).cases.values())
    assert all(float(row.split("%")[0].split()[-1]) < 100.0 * SERVO_GAIN for row in rows)
