"""The bumper laws on their bench against formulas that are written down here once more, and against their own energy.

Each formula is another than the package's: an interpolating polynomial, p V^n, compliances in series, virtual work,
SciPy's table. Beside the bumper FMU the same examples are in test_agreement.py.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from giveway.robot.variables import table as variables_of
from giveway_modelica.agreement import STOP_S
from giveway_modelica.bench import ROBOT
from giveway_modelica.compiler import Compiler
from giveway_modelica.fmu_runs import TOLERANCE, Array
from giveway_modelica.robot_record import numbers
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import BarycentricInterpolator, RegularGridInterpolator
from scipy.optimize import brentq

# Of the largest value: both are the same formula but for rounding, which terms of an end stop of 2e5 N/m magnify.
ROUNDING = 1e-12
# Of the largest value: corners of the laws and ends of contacts within steps of both solvers; a hundredth of the tube.
SOLVED = 1e-7
# Of the work taken in: what a relative tolerance of 1e-11 per step leaves after some hundred steps.
BALANCED = 1e-9

Law = Callable[[float, float], float]
"""Force in N of a compression in m and its rate in m/s."""
ROBOTS = {name: entry.values[0] for name, entry in numbers(ROBOT) if not entry.is_list}


def foam(h: float, f_25: float, f_50: float, f_75: float, hysteresis: float, rate_gain: float) -> Law:
    slow = BarycentricInterpolator([0.0, 0.25, 0.5, 0.75], [0.0, f_25, f_50, f_75])

    def law(c: float, u: float) -> float:
        # Loading: the whole force; unloading: less by the hysteresis; between both within some 0.02 m/s.
        loading = 0.5 * (1.0 + np.tanh(u / 0.02))
        return float(slow(max(c, 0.0) / h)) * max(0.0, loading + (1.0 - loading) * (1.0 - hysteresis) + rate_gain * u)

    return law


def gas(f_0: float, l_gas: float, n: float, f_ambient: float) -> Law:
    return lambda c, u: (f_0 + f_ambient) * (l_gas / (l_gas - c)) ** n - f_ambient


def damper(k: float, f_pre: float, d_1: float, d_2: float, rebound: float) -> Law:
    return lambda c, u: f_pre + k * c + (d_1 * u + d_2 * u * u if u > 0.0 else rebound * (d_1 * u - d_2 * u * u))


def series(k: float, f_pre: float, travel_1: float, k_2: float, f_pre_2: float) -> Law:
    """What each of the two gives way at some forces, added; between those everything is straight."""
    last = f_pre + k * travel_1
    forces = np.array([f_pre - k, f_pre, max(f_pre, f_pre_2), last, last + k_2])
    first = np.minimum((forces - f_pre) / k, travel_1)
    second = np.maximum(forces - max(f_pre, f_pre_2), 0.0) / k_2
    return lambda c, u: float(np.interp(c, first + second, forces))


def lever(k: float, f_pre: float, ratio: float) -> Law:
    """Virtual work: the spring moves by ``ratio`` and carries its force."""
    return lambda c, u: ratio * (f_pre + k * (ratio * c))


def table(travels: Any, speeds: Any, forces: Any) -> Law:
    between = RegularGridInterpolator((travels, speeds), forces, bounds_error=False, fill_value=None)
    return lambda c, u: max(0.0, float(between((min(max(c, travels[0]), travels[-1]), u))))


MEASURED: Mapping[str, Any] = {
    "travels": (0.0, 0.02, 0.05, 0.09, 0.13),
    "speeds": (-0.5, 0.0, 0.5),
    "forces": ((0, 4, 7), (5, 15, 22), (12, 30, 44), (30, 60, 85), (90, 150, 200)),
}
# Example -> its formula, the numbers there, speed in m/s and inertia between plate and carriage in kg.
LAWS: Mapping[str, tuple[Callable[..., Law], Mapping[str, Any], float, float]] = {
    "BumperFoam": (
        foam,
        {"h": 0.15, "f_25": 25.0, "f_50": 45.0, "f_75": 110.0, "hysteresis": 0.3, "rate_gain": 0.3},
        0.8,
        0.0,
    ),
    "BumperGas": (gas, {"f_0": 20.0, "l_gas": 0.2, "n": 1.3, "f_ambient": 100.0}, 0.8, 0.0),
    "BumperDamper": (damper, {"k": 200.0, "f_pre": 4.0, "d_1": 60.0, "d_2": 40.0, "rebound": 3.0}, 0.8, 0.0),
    "BumperSeries": (
        series,
        {"k": 600.0, "f_pre": 2.0, "travel_1": 0.03, "k_2": 2500.0, "f_pre_2": 15.0},
        0.6,
        0.0,
    ),
    "BumperLever": (lever, {"k": 400.0, "f_pre": 2.0, "ratio": 1.5}, 0.6, 0.3),
    "BumperTable": (table, MEASURED, 0.9, 0.0),
}


@functools.cache
def simulated(compiler: Compiler, example: str) -> Any:
    return compiler.simulate(f"GiveWay.Examples.{example}", tolerance=TOLERANCE)


def traces(result: Any, *names: str) -> list[Array]:
    return [np.asarray(result[f"slider.bumper.{name}"]) for name in names]


def of_law(example: str, **changes: Any) -> Law:
    make, known, _, _ = LAWS[example]
    return make(**{**known, **changes})


def along(law: Law, c: Array, u: Array) -> Array:
    return np.array([law(*row) for row in zip(c, u, strict=True)])


@pytest.mark.parametrize("example", LAWS)
def test_force_and_energy_are_those_of_the_formula(compiler: Compiler, example: str) -> None:
    result = simulated(compiler, example)
    c, u, f_rest, f_rate, e_law = traces(result, "c", "u", "f_rest", "f_rate", "e_law")
    law = of_law(example)
    assert c.max() > 0.04  # it strokes,
    assert u.min() < -0.03  # and comes back
    ours, theirs = f_rest + f_rate, along(law, c, u)
    assert np.abs(ours - theirs).max() < ROUNDING * np.abs(theirs).max()
    assert np.abs(f_rest - along(law, c, 0.0 * u)).max() < ROUNDING * np.abs(theirs).max()
    rows = np.linspace(0, len(c) - 1, 40).astype(int)
    corners = np.unique(np.concatenate((MEASURED["travels"], [13.0 / 600.0])))
    stored = [
        quad(law, 0.0, c[k], (0.0,), points=[x for x in corners if 0.0 < x < c[k]] or None, epsabs=1e-13)[0]
        for k in rows
    ]
    assert e_law[rows] == pytest.approx(stored, abs=1e-9 * e_law.max())  # quad's own accuracy at corners
    assert (f_rate * u).min() >= -ROUNDING  # what comes with the rate only loses


CHANGED = {
    "BumperFoam": ({"f_25": 25.0001}, {"hysteresis": 0.300001}, {"rate_gain": 0.300001}),
    "BumperGas": ({"n": 1.300001}, {"l_gas": 0.2000001}, {"f_ambient": 100.0001}),
    "BumperDamper": ({"d_1": 60.0001}, {"d_2": 40.0001}, {"rebound": 3.00001}),
    "BumperSeries": ({"travel_1": 0.0300001}, {"k_2": 2500.01}, {"f_pre_2": 15.0001}),
    "BumperLever": ({"ratio": 1.500001}, {"k": 400.001}),
    "BumperTable": ({"speeds": (-0.500001, 0.0, 0.5)}, {"travels": (0.0, 0.02, 0.0500001, 0.09, 0.13)}),
}


@pytest.mark.parametrize("example", LAWS)
def test_another_number_is_another_force(compiler: Compiler, example: str) -> None:
    result = simulated(compiler, example)
    c, u, f_rest, f_rate = traces(result, "c", "u", "f_rest", "f_rate")
    for changes in CHANGED[example]:
        theirs = along(of_law(example, **changes), c, u)
        assert np.abs(f_rest + f_rate - theirs).max() > 100.0 * ROUNDING * np.abs(theirs).max(), changes


@pytest.mark.parametrize("example", LAWS)
def test_what_is_taken_in_is_stored_or_lost(compiler: Compiler, example: str) -> None:
    result = simulated(compiler, example)
    taken, lost, residual = (np.asarray(result[f"energy.{name}"]) for name in ("taken", "lost", "residual"))
    (p_loss,) = traces(result, "p_loss")
    assert p_loss.min() > -1e-9  # W: none of the losses gives anything back
    assert lost[-1] > 0.0
    assert np.abs(residual).max() < BALANCED * taken.max()


def collision(example: str) -> Mapping[str, Array]:
    """The bench with the formula of its law: carriage and plate on a rail, and the floor's cover."""
    law, (_, _, speed, between) = of_law(example), LAWS[example]
    plate = ROBOTS["bumper_plate_mass"]
    carriage = ROBOTS["slider_mass"] - plate
    masses = np.array([[carriage + between, -between], [-between, plate + between]])
    damping, guide, travel = (ROBOTS[f"bumper_{name}"] for name in ("damping", "guide_friction", "travel"))

    def force(c: float, u: float) -> float:
        stops = 2e5 * max(0.0, (c - travel) * (1.0 + u)) if c > travel else -2e5 * max(0.0, -c * (1.0 - u))
        return law(c, u) + damping * u + guide * float(np.tanh(u / 0.005)) + (stops if not 0.0 <= c <= travel else 0.0)

    def floor(s: float, v: float) -> float:
        depth = s - 0.005
        inside = ROBOTS["contact_stiffness"] * depth * (1.0 + ROBOTS["contact_damping"] * v)
        return max(0.0, inside) if depth > 0.0 else 0.0

    def rates(_t: float, y: Any) -> list[float]:
        inner = force(y[0] - y[2], y[1] - y[3])
        carriage_mps2, plate_mps2 = np.linalg.solve(masses, [-inner, inner - floor(y[2], y[3])])
        return [y[1], carriage_mps2, y[3], plate_mps2]

    rest = brentq(lambda c: force(c, 0.0), -1e-2, 1e-9, xtol=1e-16) if law(0.0, 0.0) > 0.0 else 0.0
    times = np.arange(round(STOP_S[example] * 1e3) + 1) * 1e-3
    found = solve_ivp(
        rates, (0.0, times[-1]), [0.0, speed, -rest, speed], "DOP853", times, rtol=1e-10, atol=1e-12, max_step=1e-3
    )
    s, v, plate_m, _ = found.y
    return {"time": times, "slider.s": s, "slider.v": v, "slider.bumper.c": s - plate_m}


@pytest.mark.parametrize("example", LAWS)
def test_the_collision_is_that_of_the_formula(compiler: Compiler, example: str) -> None:
    result = simulated(compiler, example)
    beside = collision(example)
    time_s, first = np.unique(np.asarray(result.time), return_index=True)
    for name, theirs in beside.items():
        if name != "time":
            ours = np.interp(beside["time"], time_s, np.asarray(result[name])[first])
            assert np.abs(ours - theirs).max() < SOLVED * np.abs(theirs).max(), name


# A model's numbers as they are -> the same variables of the bumper FMU. rumoca does not tell the value of an array.
STARTS = {
    "Foam": {
        "h": "foam_thickness",
        "f_25": "foam_force_25",
        "f_50": "foam_force_50",
        "f_75": "foam_force_75",
        "hysteresis": "foam_hysteresis",
        "u_h": "foam_hysteresis_speed",
        "rate_gain": "foam_rate_gain",
    },
    "Gas": {"f_0": "gas_force", "l_gas": "gas_length", "n": "gas_exponent", "f_ambient": "gas_ambient_force"},
    "Damper": {"d_1": "damper_rate", "d_2": "damper_square", "rebound": "damper_rebound"},
    "Series": {"travel_1": "first_travel", "k_2": "second_rate", "f_pre_2": "second_preload"},
    "Lever": {"ratio": "lever_ratio"},
    "Table": {"k_stop": "stop_stiffness", "e_stop": "stop_damping", "u_guide": "guide_friction_speed"},
}


@pytest.mark.parametrize("law", STARTS)
def test_a_law_starts_with_the_numbers_of_the_fmu(compiler: Compiler, law: str) -> None:
    parameters = compiler.load(f"GiveWay.Components.{law}Bumper").parameters
    variables = variables_of("bumper")
    for ours, theirs in STARTS[law].items():
        assert parameters[ours].value == variables[f"bumper.{theirs}"].start, ours


@pytest.mark.parametrize(
    ("example", "changes", "law"),
    [
        ("BumperGas", "n=1", of_law("BumperGas", n=1.0)),  # isothermal: its energy is a logarithm
        (
            "BumperTable",
            "travels={0, 0.13}, speeds={0}, forces={{5}, {150}}",
            table((0.0, 0.13), (-1.0, 0.0), ((5, 5), (150, 150))),  # one speed: a plain curve
        ),
    ],
)
def test_the_simplest_of_a_kind(compiler: Compiler, example: str, changes: str, law: Law) -> None:
    result = compiler.simulate(f"GiveWay.Examples.{example}", changes, TOLERANCE)
    c, u, f_rest, f_rate = traces(result, "c", "u", "f_rest", "f_rate")
    theirs = along(law, c, u)
    assert np.abs(f_rest + f_rate - theirs).max() < ROUNDING * np.abs(theirs).max()
    assert np.abs(np.asarray(result["energy.residual"])).max() < BALANCED * np.asarray(result["energy.taken"]).max()


@pytest.mark.parametrize(
    ("example", "changes", "complaint"),
    [
        ("BumperFoam", "h=0.1", "95 % of the foam"),
        ("BumperFoam", "f_25=60, f_50=50", "does not rise"),
        ("BumperGas", "l_gas=0.125", "95 % of the gas"),
        ("BumperSeries", "f_pre_2=21", "only after the first is solid"),
        ("BumperTable", "travel=0.131", "the whole travel"),
        ("BumperTable", "speeds={-0.5, 0.1, 0.5}", "none of the speeds is 0"),
    ],
)
def test_numbers_that_do_not_fit_each_other_are_refused(
    compiler: Compiler, example: str, changes: str, complaint: str
) -> None:
    with pytest.raises(Exception, match=complaint):
        compiler.simulate(f"GiveWay.Examples.{example}", changes)
