"""The laws of bumpers beside spring and magnet, in the bumper FMU: force and energy against their definitions, closed
loops, the limits that have a closed form, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from bumper_law_reference import KINDS, LAWS, law_force, stored_energy, table_parameters
from component_run import co_simulate, refusal
from fmu_driver import OK, Fmu, fmu_path
from scipy.integrate import simpson, solve_ivp
from test_bumper import ACCOUNT, FORCES, moved, triangle

TRAVEL, STOP, STOP_DAMPING = 0.05, 2e4, 0.8
# Alone: what is common to all bumpers is tested beside spring and magnet.
COMMON = {
    "damping": 0.0, "guide_friction": 0.0, "travel": TRAVEL, "stop_stiffness": STOP, "stop_damping": STOP_DAMPING,
}  # fmt: skip
TIGHT = {"solver.relative_tolerance": 1e-9, "solver.absolute_scale": 1e-5}  # 1e-12 J
PLACES = (1e-5, 0.004, 0.01, 0.0151, 0.0249, 0.0365, 0.0499)
SPEEDS = (-1.7, -0.3, -0.02, 0.0, 0.004, 0.1, 0.5, 2.5)


def parameters(name: str, **changes: Any) -> dict[str, float]:
    """As the FMU's variables."""
    numbers: dict[str, float] = {"bumper.kind": KINDS[name], **TIGHT}
    for key, value in {**COMMON, **LAWS[name], **changes}.items():
        if isinstance(value, list):
            numbers |= {f"bumper.{key}[{i}]": one for i, one in enumerate(value)}
        else:
            numbers[f"bumper.{key}"] = value
    return numbers


@pytest.mark.parametrize("name", LAWS)
def test_force_is_that_of_the_definition(name: str) -> None:
    for c in PLACES:
        for rate in SPEEDS:
            run = co_simulate(
                "bumper", parameters(name), moved(lambda t, c=c, v=rate: (c + v * t, v)), 1e-5, 1e-5, FORCES
            )
            # The series' definition is solved to 1e-13 m; gas is raised to a power. 1e-9 of some 100 N.
            assert run["plate.force"][0] == pytest.approx(law_force(name, LAWS[name], c, rate), rel=1e-9, abs=1e-9)
            assert run["carrier.force"][0] == -run["plate.force"][0]


@pytest.mark.parametrize("name", LAWS)
def test_stored_energy_is_the_work_at_rest(name: str) -> None:
    """Of a bumper that starts compressed and is moved to other places, as the FMU accounts for it."""
    start = 0.012
    for c in PLACES:
        speed = math.copysign(0.05, c - start)
        run = co_simulate(
            "bumper",
            parameters(name),
            moved(lambda t, v=speed: (start + v * t, v)),
            abs(c - start) / 0.05,
            abs(c - start) / 0.05,
            ACCOUNT,
        )
        wanted = stored_energy(name, LAWS[name], c) - stored_energy(name, LAWS[name], start)
        assert run["energy.stored"][-1] == pytest.approx(wanted, rel=1e-8, abs=1e-10)  # the quadrature's


def loop(name: str, speed: float, steps: int = 200, **changes: Any) -> dict[str, np.ndarray]:
    """Two strokes from full extension to 48 mm and back at one speed."""
    top = 0.048
    return co_simulate(
        "bumper",
        parameters(name, **changes),
        moved(triangle(speed, top)),
        4 * top / speed,
        top / speed / steps,
        [*FORCES, *ACCOUNT],
    )


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("speed", [0.003, 0.2, 1.5])
def test_a_closed_loop_takes_what_it_dissipates(name: str, speed: float) -> None:
    """Work in = area of the loop = heat; nothing is left in the bumper, and none ever came out of it."""
    run = loop(name, speed)
    lost = law_area(name, speed)
    assert run["energy.work_in"][-1] == pytest.approx(2.0 * lost, rel=1e-7, abs=5e-8)
    assert run["energy.dissipated"][-1] == pytest.approx(2.0 * lost, rel=1e-7, abs=5e-8)
    assert np.all(np.diff(run["energy.dissipated"]) >= -1e-12)
    # Some joules, at a tolerance of 1e-9 and with 800 restarts; a knee of the force within a step costs some 1e-8 J.
    assert np.max(np.abs(run["energy.residual"])) < 5e-7
    if name in ("foam", "damper", "table"):
        assert lost > 0.01
    else:
        assert abs(lost) < 1e-9


def law_area(name: str, speed: float, top: float = 0.048) -> float:
    """Of one loop at a constant speed, from the definition of the force."""
    places = np.linspace(0.0, top, 9601)  # a cubic is exact, and the table's corners are points
    if name == "series":
        return 0.0  # solving for every force is slow, and the speed does not enter
    there = [law_force(name, LAWS[name], c, speed) for c in places]
    back = [law_force(name, LAWS[name], c, -speed) for c in places]
    return float(simpson(np.array(there) - back, x=places))


def test_slow_foam_loses_its_hysteresis() -> None:
    """Its data sheet's number: the share of the work of loading that does not come back."""
    # Slow to the rate gain (0.6 s/m), fast to the hysteresis' speed.
    run = loop("foam", 0.01, foam_hysteresis_speed=1e-4, foam_rate_gain=0.0)
    quarter = len(run["time"]) // 4
    assert run["energy.dissipated"][2 * quarter] / run["energy.work_in"][quarter] == pytest.approx(0.4, rel=1e-6)


@pytest.mark.parametrize("share", [0.25, 0.5, 0.75])
def test_slow_foam_has_the_forces_of_its_data_sheet(share: float) -> None:
    slow = {"foam_hysteresis_speed": 1e-4, "foam_rate_gain": 0.0}
    c = share * 0.06
    run = co_simulate("bumper", parameters("foam", **slow), moved(lambda t: (c + 0.01 * t, 0.01)), 1e-5, 1e-5, FORCES)
    assert run["plate.force"][0] == pytest.approx(LAWS["foam"][f"foam_force_{round(100 * share)}"], rel=1e-12)


@pytest.mark.parametrize("exponent", [1.0, 1.0 + 1e-7, 1.0 + 2e-6, 1.4])
def test_gas_spring_at_the_limits_of_its_exponent(exponent: float) -> None:
    """Isothermal: F0 L ln(L/(L - c)); adiabatic: F0 L/(n - 1) ((1 - c/L)^(1 - n) - 1). Without the air outside."""
    run = loop("gas", 0.2, gas_exponent=exponent, gas_ambient_force=0.0, gas_force=40.0)
    top = len(run["time"]) // 4
    left = 1.0 - 0.048 / 0.09
    assert run["plate.force"][top] == pytest.approx(40.0 * left**-exponent, rel=1e-12)
    n = exponent - 1.0
    work = -math.log(left) if n < 1e-9 else math.expm1(-n * math.log(left)) / n
    # The series below 1e-6 leaves out a term of n^2.
    assert run["energy.stored"][top] == pytest.approx(40.0 * 0.09 * work, rel=1e-12)


def test_two_springs_in_series_are_softer_than_each_until_the_first_is_solid() -> None:
    run = loop("series", 0.1, second_preload=0.0)
    c, force = run["compression"], run["plate.force"]
    both = 1.0 / (1.0 / 500.0 + 1.0 / 1500.0)
    knee = 0.02 * (1.0 + 500.0 / 1500.0)  # the first has moved 20 mm
    free = (c > 0.0) & (c < knee)
    solid = c > knee
    assert force[free] == pytest.approx(3.0 + both * c[free], rel=1e-12)
    assert force[solid] == pytest.approx(3.0 + 500.0 * 0.02 + 1500.0 * (c[solid] - knee), rel=1e-12)
    assert np.sum(free) > 100
    assert np.sum(solid) > 100


def test_a_captive_second_spring_waits_for_its_preload() -> None:
    run = loop("series", 0.1)
    c, force = run["compression"], run["plate.force"]
    waits = (c > 0.0) & (c < (6.0 - 3.0) / 500.0)
    assert force[waits] == pytest.approx(3.0 + 500.0 * c[waits], rel=1e-12)
    assert np.sum(waits) > 20


def test_a_lever_balances_force_times_its_arm() -> None:
    run = loop("lever", 0.1)
    spring = 3.0 + 400.0 * 1.6 * run["compression"]
    assert run["plate.force"] * 1.0 == pytest.approx(spring * 1.6, rel=1e-12)
    top = len(run["time"]) // 4
    assert run["energy.stored"][top] == pytest.approx(3.0 * 0.0768 + 0.5 * 400.0 * 0.0768**2, rel=1e-12)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("version", [2, 3])
def test_a_thrown_mass(name: str, version: int, tmp_path: Path) -> None:
    """FMPy steps the FMU, a mass is thrown onto it; against scipy's solution of the definition as one system."""
    mass, speed, stop, step = 1.5, 0.55, 0.3, 1e-4

    def rate(_: float, y: np.ndarray) -> list[float]:
        return [y[1], -pressing(name, y[0], y[1]) / mass]

    def clear(_: float, y: np.ndarray) -> float:  # the mass has left the plate
        return y[0] + 1e-9

    clear.terminal = True  # type: ignore[attr-defined]
    exact = solve_ivp(
        rate, (0.0, stop), [0.0, speed], method="Radau", rtol=1e-9, atol=1e-11, events=clear, max_step=1e-3,
        dense_output=True,
    )  # fmt: skip
    end = float(exact.t[-1])
    c, v = coupled(name, version, mass, speed, step, round(end / step) - 1, tmp_path)
    wanted = exact.sol(step * np.arange(len(c)))
    # A coupling of first order: it is behind by the way of a step, at most.
    assert np.max(np.abs(c - wanted[0])) < speed * step
    assert np.max(np.abs(v - wanted[1])) < 2e-2 * speed
    assert np.max(c) > 0.006


def pressing(name: str, c: float, rate: float) -> float:
    """On a mass that lies on the plate: it is not pulled."""
    stop = max(0.0, STOP * (c - TRAVEL) * (1.0 + STOP_DAMPING * rate)) if c > TRAVEL else 0.0
    return max(0.0, law_force(name, LAWS[name], c, rate) + stop)


def coupled(
    name: str, version: int, mass: float, speed: float, step: float, count: int, folder: Path
) -> tuple[np.ndarray, np.ndarray]:
    fmu = Fmu(fmu_path("bumper", version), version, folder)
    assert fmu.instantiate()
    for key, value in {**parameters(name), "plate.velocity": -speed}.items():
        assert fmu.set(key, value) == OK, fmu.last_message
    assert fmu.setup() == OK
    assert fmu.exit_initialisation() == OK, fmu.last_message
    c, v = 0.0, speed
    rows = [(c, v)]
    for k in range(count):
        acceleration = -max(0.0, fmu.get("plate.force")) / mass
        c += v * step + 0.5 * acceleration * step**2
        v += acceleration * step
        rows.append((c, v))
        assert fmu.set("plate.position", -c) == OK
        assert fmu.set("plate.velocity", -v) == OK
        assert fmu.step(k * step, step) == OK, fmu.last_message
    fmu.free()
    places, speeds = np.array(rows).T
    return places, speeds


@pytest.mark.parametrize("name", LAWS)
def test_in_fmpy(name: str) -> None:
    """The released file in an importer, with its own validation."""
    speed = 0.2
    time = np.array([0.0, 0.2])
    signals = np.array(
        [(t, speed * t, speed, 0.0, 0.0) for t in time],
        dtype=[(key, float) for key in ("time", "carrier.position", "carrier.velocity", "plate.position",
                                        "plate.velocity")],
    )  # fmt: skip
    result = fmpy.simulate_fmu(
        str(fmu_path("bumper", 3)),
        stop_time=0.2,
        step_size=1e-3,
        output_interval=1e-3,
        start_values=parameters(name),
        input=signals,
        output=["plate.force", "compression", "energy.residual"],
    )
    for row in result[1::40]:
        wanted = law_force(name, LAWS[name], row["compression"], speed)
        assert row["plate.force"] == pytest.approx(wanted, rel=1e-9, abs=1e-9)
    assert np.max(np.abs(result["energy.residual"])) < 5e-7


SMALL = table_parameters([0.0, 0.06], [0.0, 0.5], [[0.0, 1.0], [50.0, 70.0]])
REFUSED: dict[str, tuple[str, dict[str, Any], list[str]]] = {
    "foam too thin": ("foam", {"foam_thickness": 0.05}, ["bumper.travel = 0.05", "bumper.foam_thickness = 0.0475"]),
    "foam that falls": ("foam", {"foam_force_25": 60.0}, ["bumper.foam_force_50 = 40", "falls"]),
    "gas too short": ("gas", {"gas_length": 0.05}, ["bumper.travel = 0.05", "0.95 bumper.gas_length = 0.0475"]),
    "a second spring that never moves": (
        "series", {"second_preload": 14.0}, ["bumper.second_preload = 14", "bumper.first_travel = 13"],
    ),
    "a table that starts late": (
        "table", table_parameters([0.01, 0.06], [0.0], [[0.0], [50.0]]), ["bumper.table_travel[0] = 0.01"],
    ),
    "travels that fall": (
        "table", table_parameters([0.0, 0.06, 0.05], [0.0], [[0.0], [50.0], [60.0]]),
        ["bumper.table_travel[2] = 0.05", "0.06"],
    ),
    "a table that ends early": (
        "table", table_parameters([0.0, 0.04], [0.0], [[0.0], [50.0]]), ["bumper.travel = 0.05"],
    ),
    "no speed 0": (
        "table", table_parameters([0.0, 0.06], [0.1, 0.5], [[0.0, 1.0], [50.0, 70.0]]), ["bumper.table_speed[0] = 0.1"],
    ),
    "speeds that fall": (
        "table", table_parameters([0.0, 0.06], [0.0, -0.5], [[0.0, 1.0], [50.0, 70.0]]),
        ["bumper.table_speed[1] = -0.5"],
    ),
    "a force that falls with the speed": (
        "table", table_parameters([0.0, 0.06], [0.0, 0.5], [[0.0, 1.0], [50.0, 49.0]]),
        ["bumper.table_force[7] = 49", "create energy", "50"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_does_not_fit_together_is_named(case: str) -> None:
    name, changes, words = REFUSED[case]
    message = refusal("bumper", parameters(name, **changes))
    for word in words:
        assert word in message, message


def test_a_small_table_is_accepted() -> None:
    run = co_simulate("bumper", parameters("table", **SMALL), moved(lambda t: (0.03, 0.0)), 1e-3, 1e-3, FORCES)
    assert run["plate.force"][0] == pytest.approx(25.0, rel=1e-12)
