"""The equations that Model Exchange hands out: declared dependencies, indicators, events, and the order of calls."""

from __future__ import annotations

import ctypes
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmu_driver import ERROR, INTEGRATED, OK, Fmu, fmu_path

VERSIONS = pytest.mark.parametrize("version", [2, 3])


@pytest.fixture
def make(tmp_path: Path) -> Iterator[Callable[[str, int], Fmu]]:
    """An instance for Model Exchange, before initialisation."""
    made: list[Fmu] = []

    def instance(model: str, version: int) -> Fmu:
        fmu = Fmu(fmu_path(model, version), version, tmp_path / f"{model}{len(made)}")
        assert fmu.instantiate_exchange(), fmu.last_message
        made.append(fmu)
        return fmu

    yield instance
    for fmu in made:
        fmu.free()


def enter_continuous_time(fmu: Fmu) -> dict[str, float]:
    assert fmu.setup() == OK, fmu.last_message
    assert fmu.exit_initialisation() == OK, fmu.last_message
    said = fmu.settle()
    assert fmu.call("EnterContinuousTimeMode") == OK, fmu.last_message
    return said


def names(fmu: Fmu, prefix: str) -> list[str]:
    return [name for name in fmu.variables if name.startswith(prefix)]


def sizes(fmu: Fmu) -> tuple[int, int]:
    return fmu.description.numberOfContinuousStates, fmu.description.numberOfEventIndicators


@VERSIONS
@pytest.mark.parametrize("model", INTEGRATED)
def test_arrays_and_variables_are_the_same_numbers(model: str, version: int, make: Callable[..., Fmu]) -> None:
    fmu = make(model, version)
    enter_continuous_time(fmu)
    states, indicators = sizes(fmu)
    assert states == len(names(fmu, "state.")) == len(names(fmu, "der("))
    assert indicators == len(names(fmu, "indicator."))
    values = [0.01 * (i + 1) for i in range(states)]
    assert fmu.set_states(values) == OK, fmu.last_message
    assert [fmu.get(name) for name in names(fmu, "state.")] == values == fmu.array("GetContinuousStates", states)
    assert [fmu.get(name) for name in names(fmu, "der(")] == fmu.array(fmu.derivatives_function, states)
    assert [fmu.get(name) for name in names(fmu, "indicator.")] == fmu.array("GetEventIndicators", indicators)
    nominals = [fmu.nominal(name) for name in names(fmu, "state.")]
    assert fmu.array("GetNominalsOfContinuousStates", states) == nominals
    for derivative, state in zip(names(fmu, "der("), names(fmu, "state."), strict=True):
        assert derivative == f"der({state})"
        assert fmu.variables[derivative].derivative.name == state


@pytest.mark.parametrize("model", INTEGRATED)
def test_locals_can_be_read_beside_co_simulation(model: str, tmp_path: Path) -> None:
    """And reading them changes nothing."""
    traces = []
    for curious in (False, True):
        fmu = Fmu(fmu_path(model, 3), 3, tmp_path / str(curious))
        fmu.start()
        inputs = [v for v in fmu.variables.values() if v.causality == "input" and v.type == "Float64"]
        rows = []
        for k in range(100):
            for i, variable in enumerate(inputs):
                assert fmu.set(variable.name, 0.3 * math.sin(0.1 * k + i)) == OK
            if curious:
                assert all(math.isfinite(fmu.get(name)) for name in (*names(fmu, "der("), *names(fmu, "indicator.")))
            assert fmu.step(k * 1e-3, 1e-3) == OK, fmu.last_message
            rows.append([repr(fmu.get(name)) for name, v in fmu.variables.items() if v.causality == "output"])
            if curious:
                assert all(math.isfinite(fmu.get(name)) for name in names(fmu, "state."))
        traces.append(rows)
        fmu.free()
    assert traces[0] == traces[1]


def element(name: str) -> list[str]:
    """The index of an array's element, if it is one."""
    return re.findall(r"\[\d+\]", name)


SITUATIONS: dict[str, list[dict[str, float]]] = {
    "drivetrain": [{"start.motor_speed": 0.5, "load.coulomb": 1.0}, {}],
    "bumper": [{"bumper.kind": kind, "bumper.latch_model": latch} for kind in (1, 2) for latch in (0, 1)],
    "testbed": [
        {"start.vx": 0.2, "start.omega": 0.3, "bumper.kind": kind, "bumper.mount": mount, "bumper.latch_model": latch,
         "slider.target_x": 0.153046, "slider.target_y": 0.265083, "slider.run_up": 0.001}
        for kind, mount, latch in ((0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 1, 0), (2, 1, 1), (2, 0, 1))
    ] + [
        {"base.tipping": True, "start.vx": 0.2, "start.omega": 0.3, "bumper.kind": kind, "bumper.latch_model": latch,
         "slider.run_up": 0.001, "wall.present": kind == 1}
        for kind, latch in ((0, 0), (1, 0), (2, 1))
    ] + [
        {"roller.arrangement": 1, "roller.phase[0]": 0.1, "roller.phase[1]": -0.1, "roller.phase[2]": 0.05,
         "base.tipping": tipping, "start.vx": 0.2, "start.omega": 0.3, "slider.run_up": 0.001}
        for tipping in (False, True)
    ],
}  # fmt: skip


@pytest.mark.parametrize("model", INTEGRATED)
def test_nothing_depends_on_what_is_not_declared(model: str, make: Callable[..., Fmu]) -> None:
    """One state or input at a time is moved, in many situations; what changes must be declared, all but a few of
    what is declared must change, and both descriptions must say the same."""
    seen: dict[str, set[str]] = {}
    random = np.random.default_rng(5)
    for situation in SITUATIONS[model] * 3:
        fmu = make(model, 3)
        for name, value in situation.items():
            assert fmu.set(name, value) == OK, fmu.last_message
        enter_continuous_time(fmu)
        states = names(fmu, "state.")
        inputs = [n for n, v in fmu.variables.items() if v.causality == "input" and v.type == "Float64"]
        outputs = [n for n, v in fmu.variables.items() if v.causality == "output" or n.startswith("der(")]
        scale = np.array([fmu.nominal(name) for name in states])
        for _ in range(4):
            # Around where it starts, deep enough for contact, stops and rope.
            here = np.array(fmu.array("GetContinuousStates", len(states))) + scale * random.normal(size=len(states))
            there = {name: float(random.normal()) * 0.02 for name in inputs}
            for name, value in there.items():
                assert fmu.set(name, value) == OK
            assert fmu.call("EnterEventMode") == OK
            fmu.settle()
            assert fmu.call("EnterContinuousTimeMode") == OK
            assert fmu.set_states(here) == OK
            before = {name: fmu.get(name) for name in outputs}
            for i, moved in enumerate([*states, *inputs]):
                if i < len(states):
                    assert fmu.set_states(here + scale * 1e-3 * np.eye(len(states))[i]) == OK
                else:
                    assert fmu.set(moved, there[moved] + 1e-3) == OK
                for name in outputs:
                    now = fmu.get(name)
                    # Rounding: in some sums a term cancels.
                    if abs(now - before[name]) > 1e-9 * max(1.0, abs(before[name])):
                        seen.setdefault(name, set()).add(moved)
                if i < len(states):
                    assert fmu.set_states(here) == OK
                else:
                    assert fmu.set(moved, there[moved]) == OK
    declared: dict[int, dict[str, set[str]]] = {}
    for version in (2, 3):
        description = fmpy.read_model_description(str(fmu_path(model, version)))
        unknowns = [*description.outputs, *description.derivatives]
        declared[version] = {u.variable.name: {d.name for d in u.dependencies} for u in unknowns}
    assert declared[2] == declared[3]
    undeclared = {name: sorted(moved - declared[3][name]) for name, moved in seen.items() if moved - declared[3][name]}
    assert undeclared == {}
    # Groups declare dependencies for all their elements, so different elements need not depend on each other. Booleans
    # seldom change.
    pairs = {
        (name, on)
        for name, known in declared[3].items()
        for on in known
        if fmu.variables[name].type == "Float64" and len({*element(name), *element(on)}) < 2
    }
    idle = pairs - {(name, on) for name, moved in seen.items() for on in moved}
    assert len(pairs) > 25
    assert len(idle) <= 0.06 * len(pairs), sorted(idle)


@VERSIONS
def test_an_event_that_happened_does_not_happen_again(version: int, make: Callable[..., Fmu]) -> None:
    """The gear at its break-away: within the hysteresis there is no event; beyond it there is exactly one."""
    fmu = make("drivetrain", version)
    enter_continuous_time(fmu)
    stiction = fmu.get("drivetrain.gear_stiction")
    for torque, event in ((stiction + 0.5e-8, False), (stiction + 2e-8, True), (stiction, False)):
        assert fmu.set("motor.torque", torque) == OK
        assert fmu.completed_step() == (OK, event)
        before = fmu.get("events")
        assert fmu.call("EnterEventMode") == OK
        said = fmu.settle()
        assert min(fmu.array("GetEventIndicators", 1)) > 0.0
        assert fmu.get("events") == before + event
        assert bool(said["states_changed"]) == event
        again = fmu.settle()
        assert not again["states_changed"]
        assert fmu.get("events") == before + event
        assert fmu.call("EnterContinuousTimeMode") == OK
    assert not fmu.get("gear.stuck")


@VERSIONS
def test_an_input_set_in_event_mode_changes_the_states_only_if_it_changes(
    version: int, make: Callable[..., Fmu]
) -> None:
    """Of the states one counts the discontinuities: an importer that is told restarts its integration."""
    fmu = make("drivetrain", version)
    enter_continuous_time(fmu)
    assert fmu.get("motor.torque") == 0.0
    for torque, jumps in ((0.0, False), (1.0, True), (1.0, False), (2.0, True)):  # less than the gear's stiction
        before = fmu.get("state.discontinuities")
        assert fmu.call("EnterEventMode") == OK
        assert fmu.set("motor.torque", torque) == OK
        assert bool(fmu.settle()["states_changed"]) == jumps
        assert fmu.get("state.discontinuities") == before + jumps
        assert fmu.call("EnterContinuousTimeMode") == OK


@VERSIONS
def test_without_a_servo_no_time_event_and_with_it_every_tick(version: int, make: Callable[..., Fmu]) -> None:
    assert not enter_continuous_time(make("drivetrain", version))["has_next_time"]
    fmu = make("drivetrain", version)
    assert fmu.set("servo.enabled", True) == OK
    assert fmu.set("servo.reference_angle", 0.01) == OK
    said = enter_continuous_time(fmu)
    kp_times_error = fmu.get("servo.kp") * 0.01
    assert fmu.get("servo.torque") == pytest.approx(kp_times_error, rel=1e-6)  # at the first tick
    for k in range(1, 4):
        assert said["has_next_time"]
        assert said["next_time"] == pytest.approx(k * 5e-4, rel=1e-12)
        assert fmu.call("SetTime", ctypes.c_double(said["next_time"])) == OK
        assert fmu.call("EnterEventMode") == OK
        said = fmu.settle()
        assert fmu.call("EnterContinuousTimeMode") == OK


@VERSIONS
@pytest.mark.parametrize(("model", "parameter"), [("testbed", None), ("drivetrain", "servo.enabled")])
def test_a_tick_that_was_passed_over_is_an_error(
    model: str, parameter: str | None, version: int, make: Callable[..., Fmu]
) -> None:
    fmu = make(model, version)
    if parameter:
        assert fmu.set(parameter, True) == OK
    enter_continuous_time(fmu)
    assert fmu.call("SetTime", ctypes.c_double(0.0011)) == OK
    assert fmu.call("EnterEventMode") == OK
    assert fmu.update()[0] == ERROR
    assert "the event at t = 0.0005 s was passed over; it is now t = 0.0011 s" in fmu.last_message


@VERSIONS
def test_sensors_come_before_the_command_is_taken(version: int, make: Callable[..., Fmu]) -> None:
    """Two updates at a bus tick: an importer can pass the new sensor values on to a controller in between."""
    fmu = make("testbed", version)
    assert fmu.set("electronics.command_delay", 0) == OK
    said = enter_continuous_time(fmu)
    counter = fmu.get("sensor.counter")
    for again in (False, True):  # a tick of the servo, then one of servo and bus
        assert fmu.call("SetTime", ctypes.c_double(said["next_time"])) == OK
        assert fmu.call("EnterEventMode") == OK
        status, said = fmu.update()
        assert (status, bool(said["again"])) == (OK, again)
        assert again or fmu.call("EnterContinuousTimeMode") == OK
    assert fmu.get("sensor.counter") == counter + 1
    assert fmu.get("truth.motor_torque[0]") == 0.0
    assert fmu.call("EnterContinuousTimeMode") == ERROR
    assert "the last update of discrete states asked for another one" in fmu.last_message
    assert fmu.set("command.wheel_angle[0]", 0.01) == OK
    assert not fmu.settle()["again"]
    assert fmu.get("truth.motor_torque[0]") > 1.0


def test_a_simple_importer_without_root_finding(make: Callable[..., Fmu]) -> None:
    """FMPy's Euler does not stop at events; the completed step reports them. It is of first order, so coarse."""
    start = {"load.inertia": 0.2, "start.motor_speed": 3.0, "start.load_speed": 3.0}
    coasting = fmpy.simulate_fmu(
        str(fmu_path("drivetrain", 3)), fmi_type="ModelExchange", solver="Euler", step_size=1e-5, output_interval=1e-3,
        start_values=start, stop_time=0.5, output=["motor.speed", "gear.stuck", "events"],
    )  # fmt: skip
    # Momentum over gear friction, a little less for the viscous part: it stops after (0.0523 + 0.2) 3/2.8 = 0.27 s.
    stop = coasting["time"][np.argmax(coasting["gear.stuck"])]
    assert 0.2 < stop < 0.3
    assert coasting["events"][-1] >= 1
    assert set(coasting["motor.speed"][coasting["gear.stuck"]]) == {0.0}


def _array(fmu: Fmu, name: str, size: int) -> int:
    return fmu.call(name, (ctypes.c_double * size)(), ctypes.c_size_t(size))


@VERSIONS
def test_wrong_arrays_and_numbers_are_refused(version: int, make: Callable[..., Fmu]) -> None:
    fmu = make("drivetrain", version)
    enter_continuous_time(fmu)
    assert fmu.set_states([0.0] * 5) == ERROR
    assert "5 values, but this FMU has 7 continuous states" in fmu.last_message
    assert fmu.set_states([0.0, math.nan, *[0.0] * 5]) == ERROR
    assert "state state.motor_speed is nan, but must be finite" in fmu.last_message
    assert _array(fmu, "GetEventIndicators", 2) == ERROR
    assert "2 values, but this FMU has 1 event indicators" in fmu.last_message
    assert fmu.call("GetContinuousStates", None, ctypes.c_size_t(7)) == ERROR
    assert "null pointer" in fmu.last_message
    assert fmu.call("SetTime", ctypes.c_double(math.inf)) == ERROR
    assert "time is inf, but must be finite" in fmu.last_message


@VERSIONS
def test_an_instance_for_co_simulation_has_no_modes_to_change(version: int, tmp_path: Path) -> None:
    fmu = Fmu(fmu_path("drivetrain", version), version, tmp_path)
    fmu.start()
    for name in ("EnterEventMode", "EnterContinuousTimeMode"):
        assert fmu.call(name) == ERROR
        assert "was made for Co-Simulation, not for Model Exchange" in fmu.last_message
    assert fmu.step(0.0, 0.001) == OK
    fmu.free()


def test_fmi3_counts_what_it_has(make: Callable[..., Fmu]) -> None:
    fmu = make("testbed", 3)
    for function, wanted in (("GetNumberOfContinuousStates", 41), ("GetNumberOfEventIndicators", 16)):
        count = ctypes.c_size_t()
        assert fmu.call(function, ctypes.byref(count)) == OK
        assert count.value == wanted
        assert fmu.call(function, None) == ERROR
