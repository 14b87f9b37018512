"""Rollers one by one: energy through many hand-overs, the limit of an endless roller, and one wheel by itself.

The equations and the hand-over's jumps are held against the multiplier form in test_pointwise.py and
test_trajectories.py, whose random cases and runs have rollers one by one, too.
"""

from __future__ import annotations

import ctypes
import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from kkt_reference import KIND_NONE, ROLLER, ROLLER_BRISTLE, Inputs, Modes, Parameters, scattered
from plant_probe import Plant, Run
from plant_scenarios import moving, one_by_one
from scipy.integrate import solve_ivp
from tipping_plant import TippingPlant

# Nothing but the rollers slows the base, and they hardly do.
FREE = Parameters(
    drivetrain_gear_coulomb=0.0,
    drivetrain_gear_stiction=0.0,
    drivetrain_gear_viscous=0.0,
    roller_coulomb_torque=5.0e-4,
    roller_presliding_stiffness=[100.0] * 3,
)


def coast(library: ctypes.CDLL, p: Parameters, times: np.ndarray, rtol: float, atol: float) -> tuple[Run, np.ndarray]:
    """A base let go at 0.3 m/s and 4 rad/s, and the residual of its energy account."""
    reference, x, modes = moving(p, 0.3, -0.2, 4.0)
    plant = Plant(library, reference.p)
    run = plant.simulate(x, modes, times, [(0.0, Inputs())], rtol, atol)
    stored = np.array(
        [plant.outputs(state, Inputs(), m)["stored_energy"] for state, m in zip(run.states, run.modes, strict=True)]
    )
    return run, run.states[:, 24] - run.states[:, 25] - (stored - stored[0])


@pytest.mark.parametrize(
    ("rtol", "atol", "bound"), [(1e-6, 1e-9, 2e-5), (1e-9, 1e-11, 1e-7)], ids=["production", "tight"]
)
def test_energy_is_accounted_for_through_hundreds_of_hand_overs(
    library: ctypes.CDLL, rtol: float, atol: float, bound: float
) -> None:
    """Bounds: each of 1508 hand-overs starts the integration anew, at an instant that is known to the tolerance.

    Measured: 6e-6 and 2e-8 of the energy turned over, through one integration without events 8e-7 and 1e-9. An impact
    or a bristle that is left out shows with a tenth of the energy.
    """
    run, residual = coast(library, one_by_one(FREE), np.linspace(0.0, 20.0, 201), rtol, atol)
    assert len(run.events) > 1000
    assert {i for _, i in run.events} == {ROLLER, ROLLER + 1, ROLLER + 2}
    assert run.states[-1, 25] > 1.0
    assert np.abs(residual).max() < bound * run.states[-1, 25]


@pytest.mark.parametrize(("rtol", "bound"), [(1e-6, 1e-6), (1e-9, 3e-9)], ids=["production", "tight"])
def test_energy_of_a_base_that_tips_is_accounted_for(library: ctypes.CDLL, rtol: float, bound: float) -> None:
    """Wheels run over the dips, the weight passes from row to row, and some lift. Measured: 2e-8 and 7e-11 of the
    energy turned over: the wheel's angle past the vertical, of small leans, shows no error."""
    p = replace(one_by_one(Parameters(drivetrain_gear_coulomb=0.1, drivetrain_gear_stiction=0.1)), base_tipping=1)
    p = replace(p, slider_present=0, bumper_kind=KIND_NONE, rope_attached=0, roller_radius_dip=3.0e-4)
    plant = TippingPlant(library, p)
    x, modes = plant.start([0.0, 0.0, 0.0, 0.3, -0.2, 4.0, 0.0])
    run = plant.run(x, modes, np.linspace(0.0, 1.0, 201), [(0.0, Inputs())], rtol)
    outputs = [plant.tipping_outputs(state, Inputs(), m) for state, m in zip(run.states, run.modes, strict=True)]
    stored = np.array([out["stored"] for out in outputs])
    residual = run.states[:, 24] - run.states[:, 25] - (stored - stored[0])
    passed = Counter(i for _, i in run.events)
    assert min(passed[ROLLER + i] for i in range(3)) > 10
    loads = [out[f"load {i}"] for out in outputs for i in range(3)]
    assert max(loads) - min(loads) > 100.0  # N: the dips shake it
    assert np.abs(residual).max() < bound * run.states[-1, 25]


def test_a_tipping_base_starts_at_rest_on_its_rollers(library: ctypes.CDLL) -> None:
    """Leaning onto the wheels that stand between two rollers, all loads are equal; only the rows' levers disturb them,
    by 6 mm of 240."""
    p = replace(one_by_one(Parameters()), base_tipping=1, slider_present=0, bumper_kind=KIND_NONE, rope_attached=0)
    plant = TippingPlant(library, replace(p, roller_row_distance=0.0))
    x, modes = plant.start()
    assert modes[8:11].tolist() == [0, 0, 0]
    nominal = p.base_mass * 9.81 / 3.0
    loads = [plant.tipping_outputs(x, Inputs(), modes)[f"load {i}"] for i in range(3)]
    # The centre of mass leans along: 0.4 m times 3e-4 rad, of 0.24 m.
    assert loads == pytest.approx([nominal] * 3, rel=2e-3)


@pytest.mark.parametrize("tipping", [False, True])
def test_many_stiff_massless_rollers_are_an_endless_one(library: ctypes.CDLL, tipping: bool) -> None:
    """No dip, no row distance: what remains of the hand-overs is the distance over which the bristles are loaded
    again, which is inverse to their stiffness."""
    smooth = {"roller_rows": 1, "roller_per_row": 200, "roller_row_distance": 0.0, "roller_radius_dip": 0.0}
    errors = []
    for stiffness in (1.0e5, 1.0e6):
        p = Parameters(drivetrain_gear_coulomb=0.1, drivetrain_gear_stiction=0.1, roller_inertia=0.0)
        p = replace(p, roller_presliding_stiffness=[stiffness] * 3, roller_presliding_damping=0.0)
        p = replace(p, slider_present=0, bumper_kind=KIND_NONE, rope_attached=0, base_tipping=int(tipping))
        ends = []
        for q in (p, replace(one_by_one(p), roller_friction_scatter=0.0, **smooth)):
            if tipping:
                whole = TippingPlant(library, q)
                start, row = whole.start([0.0, 0.0, 0.0, 0.3, -0.2, 2.0, 0.0])
                ends.append(whole.run(start, row, np.array([0.0, 0.4]), [(0.0, Inputs())], 1e-7).states[-1, 0:6])
            else:
                plant = Plant(library, q)
                x, modes = plant.initial_state([0.0, 0.0, 0.0, 0.3, -0.2, 2.0, *[0.0] * 4], Inputs())
                modes.contact = 0
                ends.append(
                    plant.simulate(x, modes, np.array([0.0, 0.4]), [(0.0, Inputs())], 1e-7, 1e-10).states[-1, 0:6]
                )
        errors.append(float(np.abs(ends[1][3:5] - ends[0][3:5]).max()))
    assert errors[0] < 0.04  # m/s
    assert errors[1] < 0.2 * errors[0]  # grip and steps' errors remain


def test_the_friction_of_one_wheel_over_its_angle(library: ctypes.CDLL) -> None:
    """A base so heavy that nothing slows it: wheel 1 rolls at 2 rad/s and is drawn along its axle at 0.05 m/s. Its
    friction, by SciPy from the law alone and by the plant; and it comes back with every roller.

    Tolerance: the plant's base loses 1e-9 of its speed; its steps reach
    beyond the ends of the bristle's elastic range. Measured: 4e-4 N of 20.
    """
    p = replace(one_by_one(Parameters()), base_mass=1.0e9, base_yaw_inertia=1.0e9, slider_present=0)
    p = replace(p, roller_radius_dip=0.0, drivetrain_gear_coulomb=0.0, drivetrain_gear_stiction=0.0)
    wheel, axial, rolling = 1, 0.05, 0.2
    n = np.array([math.cos(2.0 * math.pi / 3.0), math.sin(2.0 * math.pi / 3.0)])
    velocity = axial * n + rolling * np.array([-n[1], n[0]])
    plant = Plant(library, p)
    _, x, modes = moving(p, *velocity.tolist(), 0.0)
    times = np.linspace(0.0, 2.0, 4001)
    run = plant.simulate(x, modes, times, [(0.0, Inputs())], 1e-9, 1e-12)
    found = np.array(
        [plant.outputs(s, Inputs(), m)[f"roller_force[{wheel}]"] for s, m in zip(run.states, run.modes, strict=True)]
    )

    pitch = 2.0 * math.pi / 18.0
    ends = np.linspace(0.0, pitch / 2.0, 20001)
    level = np.trapezoid(p.roller_radius / (p.roller_radius - p.wheel_radius * (1.0 - np.cos(ends))), ends) / ends[-1]
    sigma = p.roller_presliding_stiffness[wheel]

    def deflection_rate(angle: float, z: float, roller: int) -> float:
        past = angle - roller * pitch
        radius = p.roller_radius - p.wheel_radius * (1.0 - math.cos(past))
        coulomb = p.roller_coulomb_torque / radius / level * (1.0 + 0.2 * scattered(roller % 18, wheel, 1))
        stick = math.exp(-((axial / p.roller_stribeck_speed) ** 2))
        limit = coulomb * (stick + (1.0 - stick) * math.tanh(p.roller_tanh_slope * axial / radius))
        share = sigma * abs(z) / limit
        y = min(1.0, max(0.0, (share - p.roller_elastic_fraction) / (1.0 - p.roller_elastic_fraction)))
        return axial * (1.0 - y * y * (3.0 - 2.0 * y) * share)

    speed = rolling / p.wheel_radius
    angles = p.roller_phase[wheel] + speed * times
    expected = np.empty(len(times))
    roller, z, start = round(angles[0] / pitch), 0.0, float(angles[0])
    while start < angles[-1]:
        end = min((roller + 0.5) * pitch, float(angles[-1]))
        on = (angles >= start) & (angles <= end)
        solution = solve_ivp(
            lambda angle, z, k=roller: [deflection_rate(angle, z[0], k) / speed],
            (start, end), [z], rtol=1e-10, atol=1e-14, t_eval=angles[on], max_step=pitch / 100.0,
        )  # fmt: skip
        for index, deflection in zip(np.flatnonzero(on), solution.y[0], strict=True):
            rate = deflection_rate(float(angles[index]), float(deflection), roller)
            expected[index] = sigma * deflection + p.roller_presliding_damping * rate
        roller, z, start = roller + 1, 0.0, end
    at_hand_over = np.abs((angles / pitch) % 1.0 - 0.5) < 1e-3
    assert np.abs(found - expected)[~at_hand_over].max() < 2e-3
    # Each roller builds its friction up anew, at the rate of the rollers: 18 a turn.
    hand_overs = [t for t, i in run.events if i == ROLLER + wheel]
    assert np.diff(hand_overs) == pytest.approx(pitch / speed, rel=1e-4)
    assert found.min() < 2.0 < 15.0 < found.max()  # N


def test_the_ripple_has_the_frequency_of_the_rollers(library: ctypes.CDLL) -> None:
    """18 rollers a turn; ten of them, to a line of the spectrum. Without scatter, which would bring slower lines."""
    p = replace(one_by_one(Parameters()), base_mass=1.0e9, base_yaw_inertia=1.0e9, slider_present=0)
    p = replace(p, roller_friction_scatter=0.0, drivetrain_gear_coulomb=0.0, drivetrain_gear_stiction=0.0)
    _, x, modes = moving(replace(p, roller_radius_dip=0.0), 0.05, 0.2, 0.0)
    plant = Plant(library, replace(p, roller_radius_dip=0.0))
    rollers_hz = 18.0 * 0.2 / p.wheel_radius / (2.0 * math.pi)  # of wheel 0, which rolls along y
    times = np.arange(8000) * (10.0 / rollers_hz / 4000)
    run = plant.simulate(x, modes, times, [(0.0, Inputs())], 1e-8, 1e-11)
    force = [plant.outputs(s, Inputs(), m)["roller_force[0]"] for s, m in zip(run.states, run.modes, strict=True)]
    spectrum = np.abs(np.fft.rfft(force[4000:]))[:200]  # once the steady start is over
    between = [k for k in range(1, 200) if k % 10]
    assert spectrum[10] > 20.0 * spectrum[between].max()  # short dips: many harmonics, and nothing else


def test_rollers_differ_by_their_seed_wheel_and_number() -> None:
    drawn = np.array([[scattered(k, i, seed) for k in range(18)] for i in range(3) for seed in range(40)])
    assert len(np.unique(drawn)) == drawn.size
    assert np.abs(drawn).max() < 1.0
    # Of 2160 even numbers: three standard errors of mean, spread and neighbours' correlation.
    assert abs(drawn.mean()) < 3.0 * math.sqrt(1.0 / 3.0 / drawn.size)
    assert drawn.std() == pytest.approx(math.sqrt(1.0 / 3.0), rel=0.03)
    assert abs(np.corrcoef(drawn[:, 1:].ravel(), drawn[:, :-1].ravel())[0, 1]) < 3.0 / math.sqrt(drawn.size)


def test_a_continuous_wheel_has_no_hand_overs(library: ctypes.CDLL) -> None:
    p = replace(one_by_one(FREE), roller_arrangement=0)
    run, _ = coast(library, p, np.linspace(0.0, 1.0, 11), 1e-6, 1e-9)
    assert run.events == []
    assert run.modes[-1] == replace(Modes(), gear=run.modes[-1].gear)
    assert p.roller_model == ROLLER_BRISTLE
