"""The linear drivetrain against closed forms and against a sampled simulation that does not use python-control."""

from __future__ import annotations

import dataclasses
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from cosim_helpers import Cli, folder_content
from giveway.base import native
from giveway.base.errors import GivewayError, InputFileError
from giveway.drivetrain.analysis import analyse
from giveway.drivetrain.model import (
    ANGLE,
    CURRENT,
    ENVIRONMENT,
    MOTOR,
    SENSED,
    Drivetrain,
    Servo,
    closed_loop,
    current_loop,
    loop_gain,
    plant,
    read,
    response,
    transfer,
)
from giveway.robot.robot_file import read_robot
from motor_current_robot import trikey_by_current
from PIL import Image
from sampled_drivetrain import TICK_S, largest_multiplier, simulate

FREQUENCY_HZ = np.geomspace(0.01, 900.0, 60)


def impedances(p: Drivetrain) -> tuple[np.ndarray, ...]:
    s = 2j * math.pi * FREQUENCY_HZ
    motor = p.motor_inertia * s**2 + p.gear_viscous * s
    load = p.load_inertia * s**2 + p.load_viscous * s
    return motor, load, p.damping * s + p.stiffness


@pytest.mark.parametrize("load", ["base", "wheel", 3.0])
def test_response_is_the_closed_form(load: str | float) -> None:
    """tau_s = c (Zl tau_m - Zm tau_e)/(Zm Zl + c (Zm + Zl)), from the three equations by hand."""
    p = dataclasses.replace(read(load=load)[0], load_viscous=0.3)
    motor, torsion_load, c = impedances(p)
    bottom = motor * torsion_load + c * (motor + torsion_load)
    for source, top in ((MOTOR, torsion_load), (ENVIRONMENT, -motor)):
        wanted = c * top / bottom
        # Rounding: the rigid rotation makes numerator and denominator small together at low frequency.
        assert np.max(np.abs(response(p, None, source, FREQUENCY_HZ) / wanted - 1.0)) < 1e-9
    # A stuck gear is a motor that does not move.
    wanted = -c / (torsion_load + c)
    stuck = response(p, None, ENVIRONMENT, FREQUENCY_HZ, stuck=True)
    assert np.max(np.abs(stuck / wanted - 1.0)) < 1e-12


def test_locked_wheel_is_one_oscillator() -> None:
    p, servo = read(load="locked")
    (pole,) = analyse(p, servo).cases["unpowered"].poles
    omega = math.sqrt(p.stiffness / p.motor_inertia)
    assert 2.0 * math.pi * pole.frequency_hz == pytest.approx(omega, rel=1e-12)
    assert pole.damping == pytest.approx((p.damping + p.gear_viscous) / (2.0 * p.motor_inertia * omega), rel=1e-12)


def test_locked_wheel_is_the_limit_of_a_heavy_one() -> None:
    locked, servo = read(load="locked")
    heavy = dataclasses.replace(locked, load_inertia=100.0)
    fast = FREQUENCY_HZ[FREQUENCY_HZ > 10.0]
    for used in (None, servo):
        ratio = response(heavy, used, MOTOR, fast) / response(locked, used, MOTOR, fast)
        # k/(J w^2) = 800/(100 (2 pi 10)^2) = 0.002, times the gain of the resonance.
        assert np.max(np.abs(ratio - 1.0)) < 0.01


def test_base_inertia_holds_the_energy_of_straight_motion() -> None:
    """Against the Jacobians of (9) to (14), in any direction."""
    mass, radius, roller_radius, wheel_inertia, roller_inertia = 34.7, 0.1016, 0.009525, 0.002798, 1.23e-6
    inertia = read()[0].load_inertia
    azimuth = np.radians([0.0, 120.0, 240.0])
    for direction in (0.0, 0.4, 2.1):
        velocity = np.array([math.cos(direction), math.sin(direction)])
        wheels = np.column_stack((-np.sin(azimuth), np.cos(azimuth))) @ velocity / radius
        rollers = np.column_stack((np.cos(azimuth), np.sin(azimuth))) @ velocity / roller_radius
        energy = mass + wheel_inertia * wheels @ wheels + roller_inertia * rollers @ rollers
        assert inertia * wheels @ wheels == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize("load", ["base", "wheel"])
@pytest.mark.parametrize("delay", [0, 1, 5])
def test_closed_loop_steps_as_the_simulation(load: str, delay: int) -> None:
    import control

    p, servo = read(load=load, delay=delay)
    system = closed_loop(p, servo)
    ticks = 400
    for source in (MOTOR, ENVIRONMENT):
        wanted = simulate(p, servo, (1.0, 0.0) if source == MOTOR else (0.0, 1.0), ticks)
        step = control.step_response(system[SENSED, source], TICK_S * np.arange(ticks))
        # Rounding over 400 ticks; the torque is of the order of 1 N m.
        assert np.max(np.abs(np.squeeze(step.outputs) - wanted)) < 1e-9


@pytest.mark.parametrize("delay", [0, 4])
def test_sampled_response_is_the_settled_simulation(delay: int) -> None:
    """With torques that hold for a tick, sensed at ticks, `closed_loop` is exact; `response` is continuous.

    They differ by the hold of the input, and by its images around the servo's rate.
    """
    p, servo = read(load="base", delay=delay)
    frequency = np.array([0.5, 3.0, 20.0])
    z = np.exp(2j * np.pi * frequency * TICK_S)
    hold = (1.0 - 1.0 / z) / np.log(z)
    discrete = closed_loop(p, servo)(z)
    for source in (MOTOR, ENVIRONMENT):
        # At 20 Hz the first image is 1 % of the sine and passes at a hundredth of the sine's gain.
        assert np.max(np.abs(discrete[SENSED, source] / (hold * response(p, servo, source, frequency)) - 1.0)) < 3e-4


@pytest.mark.parametrize("delay", [0, 3])
def test_the_motors_current_is_that_of_the_simulation(delay: int) -> None:
    import control

    p, servo = read(load="base", delay=delay)
    system, ticks = current_loop(p, servo), 400
    frequency = np.array([0.5, 3.0, 20.0])
    z = np.exp(2j * np.pi * frequency * TICK_S)
    hold = (1.0 - 1.0 / z) / np.log(z)
    for source in (MOTOR, ENVIRONMENT):
        wanted = simulate(p, servo, (1.0, 0.0) if source == MOTOR else (0.0, 1.0), ticks, current=True)
        step = control.step_response(system[0, source], TICK_S * np.arange(ticks))
        assert np.max(np.abs(np.squeeze(step.outputs) - wanted)) < 1e-9  # rounding over 400 ticks
        found = response(p, servo, source, frequency, sink=CURRENT)
        assert np.max(np.abs(system(z)[0, source] / (hold * found) - 1.0)) < 3e-4  # images, as above
    # What cannot turn the encoder, or has no servo, is not seen.
    assert not response(p, servo, ENVIRONMENT, frequency, stuck=True, sink=CURRENT).any()
    assert not response(p, None, ENVIRONMENT, frequency, sink=CURRENT).any()
    # The servo takes all of a lasting torque upon itself.
    assert response(p, servo, ENVIRONMENT, np.array([1e-4]), sink=CURRENT)[0].real == pytest.approx(-1.0, abs=1e-3)


def test_a_slow_servo_is_a_spring_and_a_damper_at_the_motor() -> None:
    """Gains that hardly move anything within a tick, a filter far above: kp + kd s acts on the motor."""
    p = Drivetrain(motor_inertia=5.0, stiffness=300.0, damping=20.0, gear_viscous=0.1, load_inertia=8.0)
    servo = Servo(kp=50.0, kd=30.0, derivative_cutoff=900.0)
    s = 2j * np.pi * (frequency := np.geomspace(0.01, 2.0, 30))
    motor = p.motor_inertia * s**2 + (p.gear_viscous + servo.kd) * s + servo.kp
    load, c = p.load_inertia * s**2, p.damping * s + p.stiffness
    wanted = -c * motor / (motor * load + c * (motor + load))
    # Half a tick of hold, half of differentiation, 0.2 ms of filter: w * 0.7 ms = 0.9 % at 2 Hz of the servo's share.
    assert np.max(np.abs(response(p, servo, ENVIRONMENT, frequency) / wanted - 1.0)) < 0.01


@pytest.mark.parametrize(("load", "delay"), [("base", 0), ("wheel", 0), ("wheel", 6), (0.02, 3)])
def test_margins_are_where_the_loop_becomes_unstable(load: str | float, delay: int) -> None:
    p, servo = read(load=load, delay=delay)
    margins = analyse(p, servo).margins
    # A pair of poles of the free rotation lies at or near 1: growth counts above rounding.
    stable = 1.0 + 1e-7
    assert margins.gain is not None
    assert margins.delay_s is not None
    assert margins.phase_deg is not None
    assert largest_multiplier(p, servo) < stable
    assert largest_multiplier(p, servo, 0.999 * margins.gain) < stable
    assert largest_multiplier(p, servo, 1.001 * margins.gain) > stable
    ticks = margins.delay_s / TICK_S
    assert largest_multiplier(p, servo, delay=delay + math.floor(ticks)) < stable
    assert largest_multiplier(p, servo, delay=delay + math.ceil(ticks)) > stable
    dense = np.geomspace(0.05, 999.0, 50_000)
    loop = loop_gain(p, servo)(np.exp(2j * np.pi * dense * TICK_S))
    assert margins.distance == pytest.approx(float(np.min(np.abs(1.0 + loop))), rel=1e-3)
    rows = np.flatnonzero(np.diff(np.abs(loop) > 1.0))
    assert margins.crossover_hz == pytest.approx(list(dense[rows]), rel=1e-3)
    distances = np.abs((np.degrees(np.angle(loop[rows])) + 360.0) % 360.0 - 180.0)
    assert margins.phase_deg == pytest.approx(float(distances.min()), abs=0.1)


def test_bandwidth_and_resonance_lie_on_the_curve() -> None:
    p, servo = read()
    for name, case in analyse(p, servo).cases.items():
        channel = case.channels["environment"]
        used = servo if name == "servo" else None

        def gain(frequency: float | None, used: Servo | None = used, name: str = name) -> float:
            assert frequency is not None
            return float(np.abs(response(p, used, ENVIRONMENT, np.array([frequency]), stuck=name == "gear stuck"))[0])

        assert channel.static_gain == pytest.approx(-1.0, abs=1e-3)  # 1e-6 Hz stands for zero
        assert gain(channel.bandwidth_hz) == pytest.approx(math.sqrt(0.5), rel=1e-3)
        if channel.resonance_hz is not None:
            assert gain(channel.resonance_hz) == pytest.approx(channel.resonance_gain, rel=1e-6)
            for aside in (0.98, 1.02):
                assert gain(aside * channel.resonance_hz) < gain(channel.resonance_hz)


@pytest.mark.parametrize("load", ["base", "wheel", "locked"])
def test_the_curves_reach_half_the_servos_rate_and_resolve_every_peak(load: str) -> None:
    analysis = analyse(*read(load=load))
    grid = analysis.frequency_hz
    assert grid[0] == pytest.approx(1e-3)
    half_rate_hz = 0.5 / TICK_S
    assert 0.98 * half_rate_hz < grid[-1] < half_rate_hz
    assert (np.diff(grid) > 0.0).all()
    assert np.max(grid[1:] / grid[:-1]) < 1.01  # a smooth curve over six decades
    peaks = [pole for case in analysis.cases.values() for pole in case.poles if 0.0 < abs(pole.damping or 0.0) < 0.5]
    assert peaks
    for pole in peaks:
        width_hz = abs(pole.damping or 0.0) * pole.frequency_hz  # half of that between the points 3 dB below the peak
        near = grid[np.abs(grid - pole.frequency_hz) < min(5.0 * width_hz, 0.99 * half_rate_hz - pole.frequency_hz)]
        assert np.diff(near).max() < 0.06 * width_hz
        assert np.abs(near - pole.frequency_hz).max() > 4.8 * width_hz


@pytest.mark.parametrize(
    ("change", "lasts_s"),
    [
        # d/2J per second, of a motor of inertia J on a spring that ends in a wall, slowed down by the friction d.
        ({"damping": 0.0, "gear_viscous": 0.4, "motor_inertia": 0.05}, 3.0 / (0.4 / 0.1)),
        # All over in milliseconds, with the servo, too: the shortest response.
        ({"damping": 0.0, "gear_viscous": 1.5, "motor_inertia": 0.001}, 0.05),
    ],
)
def test_step_responses_last_three_time_constants_of_the_slowest_motion(
    change: dict[str, float], lasts_s: float
) -> None:
    p, servo = read(load="locked")
    time_s = analyse(dataclasses.replace(p, **change), servo).time_s
    assert time_s[0] == 0.0
    assert np.diff(time_s) == pytest.approx(TICK_S)
    assert time_s[-1] == pytest.approx(lasts_s, abs=TICK_S)


def test_a_delay_beyond_the_margin_is_called_unstable() -> None:
    margin_s = analyse(*read(load="wheel")).margins.delay_s
    assert margin_s is not None
    p, servo = read(load="wheel", delay=math.ceil(margin_s / TICK_S) + 1)
    analysis = analyse(p, servo)
    assert not analysis.cases["servo"].stable
    assert analysis.cases["servo"].channels == {}
    assert analysis.margins.gain is None
    assert analysis.margins.delay_s is None
    assert analysis.cases["unpowered"].stable


def test_motor_torque_turns_the_motor_of_a_free_drivetrain() -> None:
    p, _ = read()
    slow = np.array([1e-3])
    s = 2j * np.pi * slow
    rigid = 1.0 / (s * ((p.motor_inertia + p.load_inertia) * s + p.gear_viscous))
    assert abs(response(p, None, MOTOR, slow, sink=ANGLE) / rigid - 1.0)[0] < 1e-6


def test_all_points_at_once_are_those_of_python_control() -> None:
    p, servo = read()
    w = np.geomspace(0.1, 6000.0, 50)
    for system, points in (
        (plant(p), 1j * w),
        (closed_loop(p, servo), np.exp(1j * w * TICK_S)),
        (servo.system(), 2j + w),
    ):
        found = transfer(system, points)
        assert found.shape == ((50,) if system.issiso() else (2, 2, 50))
        assert np.abs(found / system(points) - 1.0).max() < 1e-9  # both solve in double, by other routines


def test_what_cannot_move_or_is_not_a_number_is_refused() -> None:
    good = {"motor_inertia": 0.05, "stiffness": 600.0, "damping": 1.0, "gear_viscous": 0.02, "load_inertia": 0.2}
    for field, value in (
        ("stiffness", -1.0),
        ("stiffness", math.nan),
        ("load_inertia", 0.0),
        ("load_inertia", -math.inf),
    ):
        with pytest.raises(GivewayError, match=field.split("_")[0]):
            Drivetrain(**{**good, field: value})
    with pytest.raises(GivewayError, match=r"servo\.delay"):
        Servo(kp=1.0, kd=1.0, derivative_cutoff=60.0, delay=-1)
    with pytest.raises(GivewayError, match="nothing does"):
        plant(read(load="locked")[0], stuck=True)
    with pytest.raises(GivewayError, match="below 1000 Hz"):
        response(*read(), MOTOR, np.array([1000.0]))
    with pytest.raises(GivewayError, match=r"frequency_hz: 0\.0.*above 0 Hz"):
        response(read()[0], None, MOTOR, np.array([1.0, 0.0]))
    with pytest.raises(GivewayError, match="base, wheel, locked"):
        read(load="bse")


def test_the_robot_file_counts(tmp_path: Path) -> None:
    text = native.robot().read_text()
    robot = tmp_path / "stiff.toml"
    stiffness = read_robot(native.robot()).value("drivetrain.stiffness")
    robot.write_text(text.replace(f"value = {stiffness}", f"value = {4.0 * stiffness}"))
    soft, stiff = (analyse(*read(path)).cases["gear stuck"].poles[0].frequency_hz for path in (None, robot))
    assert stiff == pytest.approx(2.0 * soft, rel=1e-9)
    robot.write_text(text.replace(f"value = {stiffness}", f"value = {-stiffness}"))
    with pytest.raises(InputFileError, match=rf"stiff\.toml.*drivetrain\.stiffness.*-{stiffness:g}"):
        read(robot)


def test_command_writes_table_picture_and_numbers(cli: Cli, tmp_path: Path) -> None:
    done = cli("drivetrain", "--plot", "--servo-delay", "2")
    assert done.returncode == 0, done.stderr
    (stuck,) = analyse(*read(delay=2)).cases["gear stuck"].poles
    pole = f"{stuck.frequency_hz:.2f} Hz, {stuck.damping:.3f}"
    for word in ("base in straight motion", "servo delay: 2 ticks", "phase margin, deg", pole):
        assert word in done.stdout
    written = ["out", "out/drivetrain", "out/drivetrain/drivetrain.json", "out/drivetrain/drivetrain.png"]
    assert folder_content(tmp_path) == written
    with Image.open(tmp_path / written[3]) as picture:
        assert picture.width > 1000
    document = json.loads((tmp_path / written[2]).read_text())
    assert document["schema_version"] == 1
    assert document["parameters"]["servo.delay"] == 2
    assert document["servo_loop"]["margins"]["delay_s"] == pytest.approx(analyse(*read(delay=2)).margins.delay_s)
    curve = document["cases"]["servo"]["channels"]["environment"]
    assert len(curve["magnitude"]) == len(curve["phase_deg"]) == len(document["frequency_hz"])
    assert len(curve["step"]) == len(document["time_s"])
    assert cli("drivetrain", "--plot").returncode == 0  # over its own result


def test_command_writes_single_files(cli: Cli, process: Cli, tmp_path: Path) -> None:
    for run, name in ((cli, "curves.svg"), (process, "numbers.json")):
        done = run("drivetrain", "--load", "locked", "--out", name)
        assert done.returncode == 0, done.stderr
        assert "gear stuck" not in done.stdout
    assert folder_content(tmp_path) == ["curves.svg", "numbers.json"]
    assert "Motor torque to sensed torque" in (tmp_path / "curves.svg").read_text()
    assert json.loads((tmp_path / "numbers.json").read_text())["parameters"]["load.inertia"] == "locked"


def test_command_of_a_robot_by_motor_current(cli: Cli, tmp_path: Path) -> None:
    done = cli("drivetrain", "--robot", str(trikey_by_current(tmp_path)), "--out", "out")
    assert done.returncode == 0, done.stderr
    assert "torque sensed by motor current" in done.stdout
    (static,) = (line for line in done.stdout.splitlines() if line.startswith(" sensed per environment"))
    assert static.split()[-3:] == ["-", "-", "-1.000"]
    document = json.loads((tmp_path / "out" / "drivetrain.json").read_text())
    assert document["sensing"] == "motor current"
    assert [len(case["channels"]) for case in document["cases"].values()] == [0, 0, 2]


def test_only_the_analysis_loads_python_control() -> None:
    """It costs a second at start-up."""
    modules = "giveway.cli, giveway.drivetrain.model, giveway.drivetrain.analysis"
    code = f"import sys, {modules}; sys.exit('control' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
