"""The base that tips: against Lagrange's equations, closed forms, and the planar plant."""

from __future__ import annotations

import ctypes
import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
import random_cases
from kkt_reference import GRAVITY, KIND_NONE, Inputs, Modes, Parameters
from plant_probe import Plant
from scipy.integrate import solve_ivp
from tipping_plant import TippingPlant, TippingRun
from tipping_reference import (
    EVENTS,
    GRIP,
    HEAVE,
    HEAVE_RATE,
    PITCH,
    PITCH_RATE,
    ROLL,
    ROLL_RATE,
    SPIN,
    STATES,
    TippingReference,
    turn,
)

FLOOR, TILT = 12, 15
ROBOT = Parameters(base_tipping=1, bumper_kind=KIND_NONE, rope_attached=0, contact_height=0.45)
# Nothing rolls, slides or slips: only tipping is left.
HELD = replace(
    ROBOT,
    slider_present=0,
    drivetrain_gear_coulomb=500.0,
    drivetrain_gear_stiction=500.0,
    roller_coulomb_torque=20.0,
    wheel_grip_friction=10.0,
)


def random_case(rng: np.random.Generator) -> tuple[Parameters, np.ndarray, Inputs, np.ndarray]:
    """Within some degrees and millimetres of the floor, the nose on the outline, every mode on or off."""
    p = replace(
        ROBOT,
        base_com_height=rng.uniform(0.1, 0.6),
        base_tilt_inertia=rng.uniform(1.0, 3.0),
        contact_height=rng.uniform(0.0, 0.6),
        push_height=rng.uniform(0.0, 0.6),
        contact_friction=rng.uniform(0.0, 0.5),
        wheel_inertia=rng.uniform(0.001, 0.02),
        slider_direction=rng.uniform(-3.0, 3.0),
        roller_model=int(rng.integers(2)),
        slider_present=int(rng.random() < 0.9),
    )
    p.outline_wheels = int(p.contact_height < 0.2)  # where there are any
    random_cases.uneven(rng, p)
    x = np.zeros(STATES)
    modes = np.array([*rng.integers(-1, 2, 3), *rng.integers(0, 2, 4), 0, 0, 0, 0], dtype=float)
    x[2] = rng.uniform(-3.0, 3.0)
    x[3:6] = rng.normal(0.0, 0.4, 3)
    x[12:15] = rng.normal(0.0, 3.0, 3)
    x[6:9] = x[12:15] + rng.normal(0.0, 0.01, 3)
    x[9:12] = rng.normal(0.0, 2.0, 3) * (modes[0:3] != 0.0)
    x[15:18] = rng.normal(0.0, 5e-4, 3)
    x[18:20] = rng.uniform(-0.1, 0.1), rng.normal(0.0, 0.5)
    x[HEAVE] = rng.uniform(-2e-3, 5e-3)
    x[ROLL : PITCH + 1] = rng.normal(0.0, 0.08, 2)
    x[HEAVE_RATE : SPIN + 3] = rng.normal(0.0, 1.0, 6) * [0.1, 0.5, 0.5, 3.0, 3.0, 3.0]
    x[GRIP : GRIP + 3] = rng.normal(0.0, 4e-5, 3)
    # The nose a few millimetres into the side or the corner of the outline, at the height where that is.
    r = TippingReference(p)
    part = r.planar.parts[rng.integers(len(r.planar.parts))]
    k = int(rng.integers(len(part)))
    a, b = np.array(part[k]), np.array(part[(k + 1) % len(part)])
    normal = np.array([b[1] - a[1], a[0] - b[0]]) / np.linalg.norm(b - a)
    local = a + rng.random() * (b - a) + (p.contact_nose_radius - rng.uniform(-2e-3, 10e-3)) * normal
    ct, st = math.cos(x[2]), math.sin(x[2])
    nose = np.array(r.planar.nose(x)[0:2])
    axis = p.contact_height * np.array([math.sin(x[PITCH]) * math.cos(x[ROLL]), -math.sin(x[ROLL])])
    x[0:2] = nose - np.array([[ct, -st], [st, ct]]) @ (local + axis)
    u = Inputs(
        tuple(rng.uniform(-30.0, 30.0, 3).tolist()),
        tuple(rng.normal(0.0, 30.0, 2).tolist()),
        tuple(rng.uniform(-0.3, 0.3, 2).tolist()),
    )
    return p, x, u, modes


def test_right_hand_side_and_indicators_against_lagrange(library: ctypes.CDLL) -> None:
    """Tolerance: the mass matrix's condition (a wheel's inertia beside the base's, 1e4) on rounding; measured 1e-12."""
    rng, seen = np.random.default_rng(1), Counter[str]()
    for _ in range(400):
        p, x, u, modes = random_case(rng)
        gear, contact, on_floor = modes[0:3].astype(int).tolist(), int(modes[3]), modes[4:7].astype(int).tolist()
        reference = TippingReference(p)
        expected, plant = reference.rhs(x, u, gear, contact, on_floor), TippingPlant(library, p)
        found = plant.tipping_rhs(x, u, modes)
        for group in ([0, 1, HEAVE], [2, ROLL, PITCH], [3, 4, HEAVE_RATE], [5, ROLL_RATE, PITCH_RATE], [*range(34, 37)],
                      [*range(9, 12)], [*range(12, 18), *range(37, 40)], [18, 19], [24, 25], [26, 27]):  # fmt: skip
            scale = max(1e-3, float(np.abs(expected["rate"][group]).max()))
            assert np.abs(found[group] - expected["rate"][group]).max() < 1e-9 * scale, group
        g, out = plant.tipping_indicators(x, u, modes), plant.tipping_outputs(x, u, modes)
        assert g[FLOOR : FLOOR + 3] == pytest.approx(expected["depths"], abs=1e-12)
        assert [out[f"load {i}"] for i in range(3)] == pytest.approx(expected["loads"], rel=1e-9, abs=1e-9)
        felt = expected["felt"]
        assert [out["felt x"], out["felt y"]] == pytest.approx(felt, abs=1e-9 * (1.0 + np.abs(felt).max()))
        assert out["yaw rate"] == pytest.approx(expected["yaw rate"], abs=1e-12)
        assert g[TILT] == pytest.approx(
            math.cos(x[PITCH]) * math.cos(x[ROLL]) - math.cos(math.radians(15.0)), abs=1e-12
        )
        seen["contact"] += bool(np.abs(expected["rate"][26:28]).max() > 1.0)
        seen["loads"] += bool(np.any(expected["loads"] > 1.0))
        seen["in the air"] += 0 in on_floor
    assert min(seen.values()) > 50, seen


def test_kinetic_energy_against_lagrange(library: ctypes.CDLL) -> None:
    """Differences between two motions of the same configuration: what is stored in springs cancels."""
    rng = np.random.default_rng(2)
    for _ in range(100):
        p, x, u, modes = random_case(rng)
        p = replace(p, slider_present=0)
        modes[3] = 0.0
        y = x.copy()
        y[3:6] += rng.normal(0.0, 0.5, 3)
        y[HEAVE_RATE : SPIN + 3] += rng.normal(0.0, 1.0, 6)
        plant, reference = TippingPlant(library, p), TippingReference(p)
        found = plant.tipping_outputs(y, u, modes)["stored"] - plant.tipping_outputs(x, u, modes)["stored"]
        assert found == pytest.approx(reference.energy(y) - reference.energy(x), abs=1e-9)


def residual(plant: TippingPlant, run: TippingRun, u: Inputs) -> np.ndarray:
    stored = np.array([plant.tipping_outputs(s, u, m)["stored"] for s, m in zip(run.states, run.modes, strict=True)])
    return run.states[:, 24] - run.states[:, 25] - (stored - stored[0])


def test_energy_closes_through_a_collision_that_lifts_wheels(library: ctypes.CDLL) -> None:
    p = replace(
        ROBOT, slider_mass=9.08, slider_target_y=0.05, slider_run_up=0.006, contact_height=0.55, contact_friction=0.1
    )
    plant = TippingPlant(library, p)
    x, modes = plant.start([0.0] * 6 + [1.0])
    times = np.linspace(0.0, 0.6, 301)
    run = plant.run(x, modes, times, [(0.0, Inputs())])
    lifted = {i - FLOOR for _, i in run.events if i in range(FLOOR, FLOOR + 3)}
    assert lifted, run.events
    # Solver at 1e-9, some thousand steps of some joules.
    assert np.abs(residual(plant, run, Inputs())).max() < 1e-7 * run.states[-1, 25]
    assert run.states[-1, 25] > 0.5


def test_it_stands_at_rest(library: ctypes.CDLL) -> None:
    plant = TippingPlant(library, replace(ROBOT, slider_present=0))
    x, modes = plant.start()
    out = plant.tipping_outputs(x, Inputs(), modes)
    assert [out[f"load {i}"] for i in range(3)] == pytest.approx([ROBOT.base_mass * GRAVITY / 3.0] * 3, rel=1e-12)
    assert out["margin"] == pytest.approx(1.0, abs=1e-12)
    assert np.abs(plant.tipping_rhs(x, Inputs(), modes)).max() < 1e-10


def test_it_stands_on_a_floor_that_falls_with_its_mass_off_the_centre(library: ctypes.CDLL) -> None:
    """Each wheel carries what the moments about the floor ask: its weight acts where its line through the centre of
    mass, which leaning takes further out, meets the floor. The drives hold it."""
    p = replace(ROBOT, slider_present=0, base_com_x=0.03, base_com_y=-0.02, floor_slope=0.02, floor_azimuth=2.0)
    plant = TippingPlant(library, p)
    heading = 0.7
    x, modes = plant.start([0.0, 0.0, heading, 0.0, 0.0, 0.0, 0.0])
    out = plant.tipping_outputs(x, Inputs(), modes)
    weight = p.base_mass * GRAVITY * math.cos(p.floor_slope)
    downhill = math.tan(p.floor_slope) * np.array([math.cos(2.0 - heading), math.sin(2.0 - heading)])
    centre = turn(np.array([0.0, 0.0, 0.0, 0.0, x[PITCH], x[ROLL]])) @ [0.03, -0.02, p.base_com_height]
    acts = centre[0:2] + centre[2] * downhill
    expected = [
        weight / 3.0 * (1.0 + 2.0 / p.wheel_distance * (acts[0] * math.cos(a) + acts[1] * math.sin(a)))
        for a in (0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0)
    ]
    assert np.ptp(expected) > 0.3 * weight / 3.0
    # The start takes the lean's sine for its angle, 1e-3 rad.
    assert [out[f"load {i}"] for i in range(3)] == pytest.approx(expected, rel=1e-4)
    # Wheels that lean stand 0.1 um lower than the start thinks, which is 0.02 N each, and their lowest points are not
    # exactly below their hubs.
    rate = plant.tipping_rhs(x, Inputs(), modes)
    assert np.abs(rate[3:5]).max() < 1e-2
    assert np.abs(rate[[HEAVE_RATE, ROLL_RATE, PITCH_RATE]]).max() < 1e-2
    assert p.base_mass * GRAVITY * math.sin(p.floor_slope) / p.base_mass > 0.19  # what it would be without the drives


def test_energy_closes_on_a_floor_that_falls(library: ctypes.CDLL) -> None:
    """A hit that lifts wheels, the mass off the centre, friction that differs: gravity's work along the floor is in."""
    p = replace(
        ROBOT, slider_target_y=0.05, slider_run_up=0.006, contact_height=0.55, base_com_x=0.03, base_com_y=-0.02,
        floor_slope=0.05, floor_azimuth=2.0, roller_friction_scale=[0.8, 1.2, 1.1], drivetrain_gear_stiction=0.5,
        drivetrain_gear_coulomb=0.4, drivetrain_friction_scale=[1.3, 0.7, 0.9],
    )  # fmt: skip
    plant = TippingPlant(library, p)
    x, modes = plant.start([0.0] * 6 + [1.0])
    run = plant.run(x, modes, np.linspace(0.0, 0.6, 301), [(0.0, Inputs())])
    assert {i - FLOOR for _, i in run.events if i in range(FLOOR, FLOOR + 3)}
    assert np.abs(residual(plant, run, Inputs())).max() < 1e-7 * run.states[-1, 25]
    # It has run down by more than the account may miss.
    fall = GRAVITY * math.sin(0.05) * (math.cos(2.0) * run.states[-1, 0] + math.sin(2.0) * run.states[-1, 1])
    assert abs(p.base_mass * fall) > 1e-2


@pytest.mark.parametrize("motion", [(0.3, -0.1, 0.0), (0.0, 0.0, 0.8)])
def test_it_starts_in_steady_motion(library: ctypes.CDLL, motion: tuple[float, float, float]) -> None:
    """No acceleration of anything: rollers drag, drives pull, each wheel grips with what its drive gives."""
    plant = TippingPlant(library, replace(ROBOT, slider_present=0))
    x, modes = plant.start([0.0, 0.0, 0.4, *motion, 0.0])
    rate = plant.tipping_rhs(x, Inputs(), modes)
    # Forces of 20 N per wheel on a wheel's 0.003 kg m2 leave rounding of 1e-11.
    assert np.abs(rate[[*range(3, 6), *range(15, 18), *range(HEAVE, STATES)]]).max() < 1e-9


def tilted(plant: TippingPlant, push: float, seconds: float = 3.0) -> TippingRun:
    """Pushed backwards slowly at the push's height: in 200 steps over the first two thirds, then constant."""
    x, modes = plant.start()
    inputs = [(2.0 * seconds / 3.0 * k / 200.0, Inputs(push_force=(-push * (k + 1) / 200.0, 0.0))) for k in range(200)]
    return plant.run(x, modes, np.linspace(0.0, seconds, 301), inputs, rtol=1e-7)


@pytest.mark.parametrize("height", [0.2, 0.6])
def test_the_front_wheel_lifts_where_force_times_height_is_weight_times_half_the_distance(
    library: ctypes.CDLL, height: float
) -> None:
    """Wheel 0 is lifted over the line between the others, R/2 behind the centre of mass: F h = M g R/2.

    By statics of the level robot. It leans by 0.5 deg until then, which takes h_c sin(lean) off R/2: 3 %.
    """
    p = replace(HELD, push_height=height)
    plant = TippingPlant(library, p)
    limit = p.base_mass * GRAVITY * 0.5 * p.wheel_distance / height
    below = tilted(plant, 0.9 * limit)
    assert below.events == []
    end = below.states[-1]
    out = plant.tipping_outputs(end, Inputs(), below.modes[-1])
    # The same statics of the leaning robot, exactly: moments about the line through the two rear wheels' lowest points.
    shift = -p.base_com_height * math.sin(end[PITCH])
    lean_height = height * math.cos(end[PITCH])
    expected = (p.base_mass * GRAVITY * (0.5 * p.wheel_distance - shift) - 0.9 * limit * lean_height) / (
        1.5 * p.wheel_distance
    )
    # Sinking in of the wheels (a few mm) against heights and distances, and what still rings of 100 N steps.
    assert out["load 0"] == pytest.approx(expected, abs=0.01 * p.base_mass * GRAVITY / 3.0)
    above = tilted(plant, 1.1 * limit)
    assert above.events[0][1] == FLOOR
    assert (above.events[-1][1], above.modes[-1, 7]) == (TILT, 1.0)


def test_thrown_up_it_falls_freely(library: ctypes.CDLL) -> None:
    """In the air: height follows g t^2/2, no force on the wheels, touch-down at the instant of the parabola."""
    plant = TippingPlant(library, replace(ROBOT, slider_present=0))
    x, modes = plant.start()
    modes[4:7] = 0.0
    x[HEAVE], x[3], x[5] = 0.02, 0.3, 1.0
    lands = math.sqrt(2.0 * 0.02 / GRAVITY)
    run = plant.run(x, modes, np.linspace(0.0, lands + 1e-4, 50), [(0.0, Inputs())])
    flying = run.times < lands
    height = 0.02 - 0.5 * GRAVITY * run.times[flying] ** 2
    assert run.states[flying, HEAVE] == pytest.approx(height, abs=1e-10)
    assert run.states[flying, 3] == pytest.approx(0.3, abs=1e-12)
    touched = sorted(i for _, i in run.events if i >= FLOOR)
    assert touched == [FLOOR, FLOOR + 1, FLOOR + 2]
    assert all(t == pytest.approx(lands, abs=1e-9) for t, i in run.events if i >= FLOOR)


@pytest.mark.parametrize("com_height", [0.15, 0.5])
@pytest.mark.parametrize(("angle", "rate"), [(0.03, 0.0), (-0.03, 0.0), (0.0, 0.4), (0.0, -0.4), (-0.05, 0.3)])
@pytest.mark.parametrize(("tilt", "tilt_rate"), [(PITCH, PITCH_RATE), (ROLL, ROLL_RATE)])
def test_the_margin_is_that_of_an_inverted_pendulum(
    library: ctypes.CDLL, tilt: int, tilt_rate: int, angle: float, rate: float, com_height: float
) -> None:
    """Over the line between two wheels, R/2 away, the base falls as exp(w t), w^2 = M g h/I with I about that line
    (parallel axes); what counts is the place of the centre of mass plus its speed over w. In closed form."""
    p = replace(ROBOT, slider_present=0, base_com_height=com_height, base_tilt_inertia=1.7)
    plant = TippingPlant(library, p)
    x, modes = plant.start()
    x[tilt], x[tilt_rate] = angle, rate
    inertia = p.base_tilt_inertia + p.base_mass * (com_height**2 + (0.5 * p.wheel_distance) ** 2)
    growth = math.sqrt(p.base_mass * GRAVITY * com_height / inertia)
    reach = com_height * (math.sin(angle) + rate * math.cos(angle) / growth)
    # To x by the pitch, to -y by the roll; wheels stand at 0, 120 and 240 deg, the lines opposite to them.
    towards = 0.0 if tilt == PITCH else -0.5 * math.pi
    over = max(-reach * math.cos(towards - 2.0 * math.pi * i / 3.0) for i in range(3))
    expected = 1.0 - over / (0.5 * p.wheel_distance)
    assert plant.tipping_outputs(x, Inputs(), modes)["margin"] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("com_x", "com_y"), [(0.03, 0.0), (-0.02, 0.05)])
@pytest.mark.parametrize("slope", [0.0, 0.1])
def test_the_margin_knows_where_the_mass_is_and_how_the_floor_falls(
    library: ctypes.CDLL, com_x: float, com_y: float, slope: float
) -> None:
    """Each line between two wheels has its own pendulum: its distance from the centre of mass makes the inertia."""
    p = replace(
        ROBOT, slider_present=0, base_com_x=com_x, base_com_y=com_y, floor_slope=slope, floor_azimuth=1.0,
        base_tilt_inertia=1.7,
    )  # fmt: skip
    plant = TippingPlant(library, p)
    x, modes = plant.start()
    x[ROLL] = x[PITCH] = 0.0
    rate = x[PITCH_RATE] = 0.3
    h, margins = p.base_com_height, []
    for i in range(3):
        towards = (2 * i + 1) * math.pi / 3.0  # across the line from wheel i to the next
        out = com_x * math.cos(towards) + com_y * math.sin(towards)
        inertia = p.base_tilt_inertia + p.base_mass * (h**2 + (0.5 * p.wheel_distance - out) ** 2)
        growth = math.sqrt(p.base_mass * GRAVITY * math.cos(slope) * h / inertia)
        reach = out + h * math.tan(slope) * math.cos(1.0 - towards) + rate * h * math.cos(towards) / growth
        margins.append(1.0 - reach / (0.5 * p.wheel_distance))
    assert plant.tipping_outputs(x, Inputs(), modes)["margin"] == pytest.approx(min(margins), rel=1e-12)


def rearing(plant: TippingPlant, margin: float) -> tuple[np.ndarray, np.ndarray]:
    """On the two rear wheels, nose up by 6 deg and rising at the rate that makes this margin."""
    p = plant.p
    x, modes = plant.start()
    x[PITCH] = -math.radians(6.0)
    reference = TippingReference(p)

    def motion(rate: float) -> np.ndarray:
        y = x.copy()
        y[PITCH_RATE] = rate
        q, _ = reference.coordinates(y)
        rear = np.array([-0.5 * p.wheel_distance, 0.0, 0.0])
        # The point at the floor between the rear wheels stands still; they bear the weight.
        y[HEAVE] = -0.5 * p.wheel_distance * math.sin(q[4]) - 0.5 * p.base_mass * GRAVITY / p.wheel_floor_stiffness
        ct, st = math.cos(q[4]), math.sin(q[4])
        y[3], y[HEAVE_RATE] = -rate * (ct * rear[2] - st * rear[0]), rate * (ct * rear[0] + st * rear[2])
        y[SPIN : SPIN + 3] = [
            -rate * math.sin(2.0 * math.pi * i / 3.0) for i in range(3)
        ]  # the drives hold them to the body
        return y

    modes[4] = 0.0
    low, high = 0.0, -3.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if plant.tipping_outputs(motion(middle), Inputs(), modes)["margin"] > margin:
            low = middle
        else:
            high = middle
    return motion(low), modes


@pytest.mark.parametrize(("margin", "goes_over"), [(0.0, False), (-0.15, True)])
def test_the_margin_decides_whether_it_goes_over(library: ctypes.CDLL, margin: float, goes_over: bool) -> None:
    """The margin is that of a linear pendulum, good to a few hundredths up to 15 deg; and coming to bear on the springs
    of its wheels, which the start does not quite hit, takes up to 8 hundredths. So 0 comes back, -0.15 does not."""
    plant = TippingPlant(library, HELD)
    x, modes = rearing(plant, margin)
    run = plant.run(x, modes, np.linspace(0.0, 2.0, 201), [(0.0, Inputs())], rtol=1e-7)
    # Wheel 0 comes down again, or the model ends first.
    assert next(i for _, i in run.events if i in (FLOOR, TILT)) == (TILT if goes_over else FLOOR)


def test_a_wheel_that_lifts_forgets_its_bristles_and_one_that_lands_keeps_the_rest(library: ctypes.CDLL) -> None:
    plant = TippingPlant(library, ROBOT)
    x, modes = plant.start()
    x[15:18], x[GRIP : GRIP + 3] = 1e-4, 1e-5
    fired = np.zeros(EVENTS)
    fired[FLOOR + 1] = -1.0
    after, lifted = plant.tipping_transition(x, Inputs(), modes, fired)
    assert lifted[4:7].tolist() == [1.0, 0.0, 1.0]
    assert after[[16, GRIP + 1]].tolist() == [0.0, 0.0]
    untouched = [i for i in range(STATES) if i not in (16, GRIP + 1)]
    assert after[untouched].tolist() == x[untouched].tolist()
    # In the air nothing but its drive turns it.
    rate = plant.tipping_rhs(after, Inputs(), lifted)
    assert rate[[16, GRIP + 1]].tolist() == [0.0, 0.0]
    out = plant.tipping_outputs(after, Inputs(), lifted)
    assert out["load 1"] == 0.0
    _, landed = plant.tipping_transition(after, Inputs(), lifted, -fired)
    assert landed[4:7].tolist() == [1.0, 1.0, 1.0]


@pytest.mark.deep
def test_a_trajectory_with_lifting_wheels_against_lagrange_in_scipy(library: ctypes.CDLL) -> None:
    """Pushed hard off the centre for 60 ms, gears held. Both integrate to 1e-9, anew from each lift and touch-down."""
    p = replace(HELD, wheel_grip_stiffness=2.0e5, wheel_floor_stiffness=5.0e4, push_height=0.6)
    plant, reference = TippingPlant(library, p), TippingReference(p)
    x, modes = plant.start()
    inputs = [(0.0, Inputs(push_force=(-350.0, 60.0), push_point=(0.3, 0.05))), (0.06, Inputs())]
    end = 0.12
    run = plant.run(x, modes, np.array([0.0, end]), inputs, rtol=1e-10)

    def depths(y: np.ndarray) -> np.ndarray:
        q, _ = reference.coordinates(y)
        return np.array([-(q[2] + (turn(q) @ reference.lowest(q, i))[2]) for i in range(3)])

    state, time, floor, events = x, 0.0, [1, 1, 1], []
    for stop, u in ((0.06, inputs[0][1]), (end, inputs[1][1])):
        while time < stop:
            watch = []
            for i in range(3):

                def crossing(t: float, y: np.ndarray, i: int = i) -> float:
                    return float(depths(y)[i])

                crossing.terminal, crossing.direction = True, -1.0 if floor[i] else 1.0  # type: ignore[attr-defined]
                watch.append(crossing)
            step = solve_ivp(
                lambda t, y, u=u: reference.rhs(y, u, [0, 0, 0], 0, floor)["rate"], (time, stop), state, "DOP853",
                rtol=1e-9, atol=1e-12, events=watch,
            )  # fmt: skip
            time, state = float(step.t[-1]), step.y[:, -1].copy()
            for i, at in enumerate(step.t_events):
                if len(at):
                    floor[i] = 1 - floor[i]
                    events.append((float(at[0]), FLOOR + i))
                    if not floor[i]:
                        state[15 + i] = state[GRIP + i] = 0.0
    assert [i for _, i in run.events] == [i for _, i in events]
    assert len(events) >= 2
    assert [t for t, _ in run.events] == pytest.approx([t for t, _ in events], abs=1e-7)
    scale = np.maximum(np.abs(state), 1e-3)
    # Some thousand steps at 1e-9; the grip's deflection, microns, is compared with a millimetre.
    assert np.abs(run.states[-1] - state)[:24].max() < 1e-6 * scale[:24].max()
    assert (np.abs(run.states[-1] - state) / scale)[HEAVE:].max() < 1e-5


@pytest.mark.parametrize("com", [(0.0, 0.0), (0.02, -0.03)])
def test_on_stiff_wheels_with_everything_at_floor_level_it_is_the_planar_robot(
    library: ctypes.CDLL, com: tuple[float, float]
) -> None:
    """Centre of mass and contact 1 mm above the floor: nothing tips. Wheels and floor a thousand times as stiff as the
    drivetrain, rollers without inertia (which the tipping plant leaves out). What is left is the grip's compliance,
    k_w/k_grip = 3e-4, on signals that ring; it falls with it.
    """

    def errors(stiffness: float) -> np.ndarray:
        p = replace(
            ROBOT, base_com_height=1e-3, contact_height=1e-3, roller_inertia=1e-12, slider_run_up=0.006,
            slider_target_y=0.05, wheel_grip_friction=100.0,
            wheel_floor_stiffness=stiffness, wheel_grip_stiffness=stiffness, wheel_grip_damping=2e-4 * stiffness,
            base_com_x=com[0], base_com_y=com[1],
        )  # fmt: skip
        if any(com):  # the planar rollers' damping knows no load
            p = replace(p, roller_presliding_damping=0.0)
        times = np.linspace(0.0, 0.25, 126)
        angles = 2.0 * np.pi / 3.0 * np.arange(3)
        load = 1.0 + 2.0 / p.wheel_distance * (com[0] * np.cos(angles) + com[1] * np.sin(angles))
        stiff = load * p.roller_presliding_stiffness
        flat_p = replace(p, base_tipping=0, wheel_load=load.tolist(), roller_presliding_stiffness=stiff.tolist())
        tipping, planar = TippingPlant(library, p), Plant(library, flat_p)
        x, modes = tipping.start([0.0] * 6 + [0.5])
        full = tipping.run(x, modes, times, [(0.0, Inputs())]).states
        start = np.zeros(28)
        start[19] = 0.5
        flat = planar.simulate(start, Modes(), times, [(0.0, Inputs())]).states
        watched = [0, 2, 3, 5, 7, 8, 12, 13, 14, 19, 26]
        peak = np.abs(flat[:, watched]).max(axis=0)
        assert np.all(peak > 0.0)
        return np.abs(full[:, watched] - flat[:, watched]).max(axis=0) / peak

    coarse, fine = errors(2.0e7), errors(2.0e8)
    assert fine.max() < (3e-3 if any(com) else 2e-3)  # the grip is as soft as the least load
    assert fine.max() < 0.3 * coarse.max()
