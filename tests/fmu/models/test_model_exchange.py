"""Model Exchange in FMPy's CVODE against our own Co-Simulation: signals to 1e-4 of their peaks, events to 10 us."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import fmpy
import numpy as np
import pytest
from bumper_law_reference import KINDS as LAW_KINDS
from bumper_law_reference import LAWS
from component_run import co_simulate
from drivetrain_reference import Parameters
from fmpy import fmi2, fmi3
from fmpy.sundials import CVodeSolver
from fmu_driver import OK, Fmu, fmu_path
from test_bumper import KINDS, moved, triangle
from test_bumper import parameters as bumper_parameters
from test_bumper_laws import parameters as law_parameters
from test_drivetrain import shove

SIGNALS = 1e-4  # of the peak
INSTANTS = 10e-6  # s
# CVODE's norm is a mean over all states: the testbed's twelve tipping states, which are at rest here, and the count of
# discontinuities would dilute it.
IMPORTER_TOLERANCE = 1e-8 * (28 / 41) ** 0.5
# Our run has a tighter tolerance, so that the difference is the importer's error.
CO_SIMULATION = {"solver.relative_tolerance": 1e-8, "solver.absolute_scale": 1e-2}
# Set at a tick: an integrating importer sees it there, a co-simulation at the end of the step in which it acts.
ACTS_FROM_THE_TICK = ("servo.torque", "truth.motor_torque", "gear.stuck", "truth.gear_stuck")


@dataclass
class Case:
    model: str
    parameters: Mapping[str, float] = field(default_factory=dict)
    inputs: Callable[[float], Mapping[str, float]] = lambda t: {}
    stop: float = 0.4
    step: float = 5e-4
    least_events: int = 4
    moving_inputs: bool = False  # that change between their jumps
    importer_tolerance: float = IMPORTER_TOLERANCE


def shoved(t: float) -> dict[str, float]:
    motor, environment = shove(t)
    return {
        "motor.torque": motor, "environment.torque": environment,
        "servo.reference_angle": 0.0, "servo.reference_speed": 0.0,
    }  # fmt: skip


def servoed(t: float) -> dict[str, float]:
    return {
        "motor.torque": 0.0, "environment.torque": -4.0 if t > 0.2 else 0.0,
        "servo.reference_angle": 0.04 if t < 0.15 else -0.03 if t < 0.3 else 0.02, "servo.reference_speed": 0.0,
    }  # fmt: skip


def pushed(t: float) -> dict[str, float]:
    """The slider hits, then a corner is pushed; the drives are commanded to turn a little."""
    speeds = {f"command.wheel_speed[{i}]": 0.0 for i in range(3)}
    angles = {f"command.wheel_angle[{i}]": (0.02 if t > 0.25 else 0.0) * (i - 1) for i in range(3)}
    push = {"push.force_x": 30.0 if t > 0.2 else 0.0, "push.force_y": -50.0 if t > 0.21 else 0.0}
    return {**speeds, **angles, **push, "command.enable": True, "push.point_x": 0.2, "push.point_y": 0.1}


ON_THE_ROBOT = {"bumper.mount": 1, "slider.target_x": 0.153046, "slider.target_y": 0.265083}
SMOOTH = {"electronics.torque_resolution": 0.0}  # a quantum more or less has no meaning
CASES = {
    "drivetrain": Case("drivetrain", Parameters().as_variables(), shoved, stop=0.5),
    "drivetrain with servo": Case(
        "drivetrain",
        {**Parameters(load_inertia=0.1, delay=1).as_variables(), "servo.enabled": True},
        servoed,
        least_events=1,
    ),
    **{
        f"bumper, {kind}": Case(
            "bumper", bumper_parameters(kind), moved(triangle(0.25, 0.05435, -0.00065)), 0.44, 1e-3, moving_inputs=True
        )
        for kind in KINDS
    },
    **{
        f"bumper, {name}": Case(
            "bumper", law_parameters(name), moved(triangle(0.25, 0.05435, -0.00065)), 0.44, 1e-3, moving_inputs=True
        )
        for name in LAWS
    },
    "testbed": Case("testbed", SMOOTH),
    **{
        f"testbed, {name}": Case("testbed", {**SMOOTH, "bumper.kind": number}, importer_tolerance=1e-10)
        for name, number in LAW_KINDS.items()
        if name != "table"
    },
    "testbed, lever with inertia on the robot": Case(
        "testbed",
        {**SMOOTH, **ON_THE_ROBOT, "bumper.kind": LAW_KINDS["lever"], "bumper.lever_mass": 0.3},
        stop=0.3,
        importer_tolerance=1e-10,
    ),
    "testbed, pushed": Case("testbed", SMOOTH, pushed, stop=0.3),
    "testbed, motor current": Case("testbed", {**SMOOTH, "drivetrain.sensing": 1}, pushed, stop=0.3),
    "testbed, spring": Case("testbed", {**SMOOTH, "bumper.kind": 1}),
    "testbed, ideal latch": Case("testbed", {**SMOOTH, "bumper.latch_model": 1}),
    "testbed, bumper on the robot": Case("testbed", {**SMOOTH, **ON_THE_ROBOT}),
    "testbed, ideal latch on the robot": Case("testbed", {**SMOOTH, **ON_THE_ROBOT, "bumper.latch_model": 1}),
    "testbed, no power": Case(
        "testbed", {**SMOOTH, "command.enable": False, "start.vx": 0.15, "start.omega": 0.2, "slider.present": False}
    ),
    # Until the slider, thrown back, has tightened the rope again.
    "testbed, landing": Case(
        "testbed", {**SMOOTH, "rope.drop_height": 0.06, "roller.model": 1, "drivetrain.gear_stiction": 3.2}, stop=0.5
    ),
    # Off the middle of the side: in the middle two wheels do everything at the same instant.
    "testbed, wheels and wall": Case(
        "testbed",
        {
            **SMOOTH,
            "bumper.kind": 0,
            "outline.wheels": True,
            "contact.height": 0.12,
            "rope.attached": False,
            "slider.direction": -2.0,
            "slider.speed": 0.5,
            "slider.run_up": 0.06,
            "slider.mass": 4.0,
            "wall.present": True,
            "wall.distance": 0.01,
        },
        importer_tolerance=1e-10,  # its errors grow with every bounce: 4e-4 at 1e-8, 4e-5 with this tolerance
    ),
    "testbed, long edge": Case(
        "testbed",
        {**SMOOTH, "bumper.kind": 0, "contact.nose_shape": 1, "slider.direction": -2.0, "slider.run_up": 0.06},
    ),
    "testbed, tipping": Case(
        "testbed",
        {
            **SMOOTH,
            "base.tipping": True,
            "contact.height": 0.5,
            "bumper.kind": 0,
            "slider.direction": -2.0,
            # In motion: at rest, at an angle of 0, the importer's rounding decides between two encoder counts.
            "command.enable": False,
            "start.vx": 0.1,
            "start.omega": 0.2,
        },
    ),
}


def signals(case: Case) -> np.ndarray:
    """The inputs for FMPy: a second row wherever one of them jumps."""
    grid = np.round(np.arange(round(case.stop / case.step) + 1) * case.step, 9)
    names = list(case.inputs(0.0))
    rows: list[tuple[float, ...]] = []
    for time in grid:
        now = tuple(case.inputs(time).values())
        if rows:
            # Positions are integrated from their speeds; everything else is held.
            before = dict(zip(names, rows[-1][1:], strict=True))
            arrived = {n: v + before.get(n.replace("position", "velocity"), 0.0) * (time - rows[-1][0])
                       if n.endswith("position") else v for n, v in before.items()}  # fmt: skip
            if case.moving_inputs or tuple(arrived.values()) != now:
                rows.append((time, *arrived.values()))
        if not rows or not np.allclose(rows[-1][1:], now, rtol=0, atol=1e-12) or time == grid[-1]:
            rows.append((time, *now))
    kinds = [(name, np.bool_ if name == "command.enable" else np.double) for name in names]
    return np.array(rows, dtype=[("time", np.double), *kinds])


def exchange(case: Case, version: int, outputs: list[str]) -> np.ndarray:
    start = {name: value for name, value in case.parameters.items() if not name.startswith("solver.")}
    return fmpy.simulate_fmu(
        str(fmu_path(case.model, version)), fmi_type="ModelExchange", solver="CVode", start_values=start,
        relative_tolerance=case.importer_tolerance, input=signals(case) if case.inputs(0.0) else None, output=outputs,
        stop_time=case.stop, output_interval=case.step, record_events=False,
    )  # fmt: skip


@pytest.fixture
def inputs_at_every_evaluation(monkeypatch: pytest.MonkeyPatch) -> None:
    """FMPy's CVODE sets the inputs only after a step; inputs that change continuously must be set for each
    evaluation."""
    evaluate = CVodeSolver.f

    def with_inputs(self: CVodeSolver, t: float, y: object, ydot: object, user_data: object) -> int:
        self.input.apply(t, discrete=False)
        return evaluate(self, t, y, ydot, user_data)

    monkeypatch.setattr(CVodeSolver, "f", with_inputs)


@dataclass
class Comparison:
    signals: dict[str, float]  # largest deviation over the peak; booleans and integers: 1 if they differ
    instants: float  # s, of state events
    events: int
    same_events: bool


def compare(case: Case, version: int, changes: Mapping[str, float] | None = None) -> Comparison:
    """``changes``: other parameters for the importer, to see that they would be noticed."""
    description = fmpy.read_model_description(str(fmu_path(case.model, version)))
    outputs = [v for v in description.modelVariables if v.causality == "output" and not v.name.startswith("solver.")]
    names = [v.name for v in outputs]
    parameters = {**case.parameters, **CO_SIMULATION}
    ours = co_simulate(case.model, parameters, case.inputs, case.stop, case.step, names, version)
    theirs = exchange(replace(case, parameters={**case.parameters, **(changes or {})}), version, names)
    assert np.allclose(theirs["time"], ours["time"], rtol=0, atol=1e-9)

    near_event = np.min(np.abs(ours["time"][:, None] - np.unique(ours["last_event_time"])), axis=1) < INSTANTS
    # At a jump of the inputs, one run shows the values after it and the other the values before it.
    times = signals(case)["time"] if case.inputs(0.0) else np.array([])
    jumps = times[1:][np.diff(times) == 0]
    clear = ~near_event & ~np.isclose(ours["time"][:, None], jumps, rtol=0, atol=1e-9).any(axis=1)
    assert np.count_nonzero(clear) > 0.9 * len(clear)
    same = theirs["events"] == ours["events"]
    instants = np.abs(theirs["last_event_time"] - ours["last_event_time"])[same]

    turned_over = max(np.max(np.abs(ours[f"energy.{kind}"])) for kind in ("stored", "work_in", "dissipated"))
    off: dict[str, float] = {}
    for variable in outputs:
        wanted, found = ours[variable.name], theirs[variable.name].astype(float)
        if variable.name in ("last_event_time", "events"):
            continue
        if variable.name.split("[")[0] in ACTS_FROM_THE_TICK:
            found, before, wanted = found[:-1], wanted[:-1], wanted[1:]
            wanted = np.where(np.abs(found - before) < np.abs(found - wanted), before, wanted)
        deviation = np.abs(found - wanted) * clear[: len(found)]
        if variable.type in ("Boolean", "Integer", "Int32"):
            off[variable.name] = float(np.any(deviation > 0.0))
            continue
        # Both residuals are errors already: measured by the energy that is turned over.
        peak = turned_over if variable.name == "energy.residual" else np.max(np.abs(wanted))
        off[variable.name] = float(np.max(deviation) / (peak if peak > 0.0 else 1.0))
    worst_first = dict(sorted(off.items(), key=lambda item: -item[1]))
    return Comparison(worst_first, float(np.max(instants)), int(ours["events"][-1]), not np.any(~same & clear))


def of_both_versions(name: str) -> list[object]:
    """FMI 2 has another shell around the same model: `make test` tries it on one case of the testbed."""
    first = pytest.param(name, 2, marks=pytest.mark.deep) if name.startswith("testbed, ") else (name, 2)
    return [first, (name, 3)]


@pytest.mark.parametrize(("name", "version"), [case for name in CASES for case in of_both_versions(name)])
def test_an_importer_that_integrates_finds_the_same(name: str, version: int, request: pytest.FixtureRequest) -> None:
    case = CASES[name]
    if case.moving_inputs:
        request.getfixturevalue("inputs_at_every_evaluation")
    found = compare(case, version)
    assert found.events >= case.least_events
    assert found.same_events
    assert found.instants < INSTANTS
    assert max(found.signals.values()) < SIGNALS, list(found.signals.items())[:3]


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("drivetrain", {"drivetrain.damping": 1.01}),
        ("drivetrain with servo", {"servo.kd": 8.01}),
        ("bumper, continuous", {"bumper.latch_gap": 0.00201}),
        ("testbed", {"contact.damping": 0.303}),
        ("testbed, landing", {"rope.drop_height": 0.06002}),
    ],
)
def test_a_small_difference_would_be_noticed(
    name: str, changes: Mapping[str, float], inputs_at_every_evaluation: None
) -> None:
    found = compare(CASES[name], 3, changes)
    assert max(found.signals.values()) > SIGNALS


@pytest.fixture
def importer_that_restarts_only_when_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """FMPy, which restarts its solver after every event, as an importer that does so only when a state has changed."""
    restart = CVodeSolver.reset
    told: list[bool] = []

    def listening(update: Callable[..., tuple[object, ...]]) -> Callable[..., tuple[object, ...]]:
        def updated(self: object) -> tuple[object, ...]:
            said = update(self)
            told.append(bool(said[2] or said[3]))  # nominals, values of continuous states changed
            return said

        return updated

    def reset(self: CVodeSolver, time: float) -> None:
        if any(told):
            restart(self, time)
        told.clear()

    monkeypatch.setattr(CVodeSolver, "reset", reset)
    for kind, name in ((fmi2.FMU2Model, "newDiscreteStates"), (fmi3.FMU3Model, "updateDiscreteStates")):
        monkeypatch.setattr(kind, name, listening(getattr(kind, name)))


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", ["drivetrain", "drivetrain with servo", "bumper, ideal", "testbed"])
def test_an_importer_that_restarts_only_when_told_finds_the_same(
    name: str, version: int, inputs_at_every_evaluation: None, importer_that_restarts_only_when_told: None
) -> None:
    found = compare(CASES[name], version)
    assert found.same_events
    assert found.instants < INSTANTS
    assert max(found.signals.values()) < SIGNALS, list(found.signals.items())[:3]


def test_an_importer_that_never_restarts_would_be_noticed(
    inputs_at_every_evaluation: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(CVodeSolver, "reset", lambda self, time: None)
    for name in ("drivetrain", "bumper, ideal"):
        assert max(compare(CASES[name], 3).signals.values()) > SIGNALS


@pytest.mark.parametrize("version", [2, 3])
def test_a_change_of_states_is_told_to_the_letter(version: int, tmp_path: Path) -> None:
    """Reported if and only if a state has changed; a state changes in every event that changes a derivative."""
    case = CASES["drivetrain with servo"]
    fmu = Fmu(fmu_path(case.model, version), version, tmp_path)
    assert fmu.instantiate_exchange()
    for name, value in {**case.parameters, **case.inputs(0.0)}.items():
        assert fmu.set(name, value) == OK, fmu.last_message
    assert fmu.setup() == OK
    assert fmu.exit_initialisation() == OK
    count = fmu.description.numberOfContinuousStates
    quiet = told = 0
    next_time = 0.0
    for tick in range(1, 400):
        states, rates = fmu.array("GetContinuousStates", count), fmu.array(fmu.derivatives_function, count)
        said = fmu.settle()
        changed = fmu.array("GetContinuousStates", count) != states
        assert bool(said["states_changed"]) == changed
        assert changed or fmu.array(fmu.derivatives_function, count) == rates
        told, quiet = told + changed, quiet + (not changed)
        next_time = said["next_time"]
        assert fmu.call("EnterContinuousTimeMode") == OK
        # Explicit Euler: crude, but every tick is reached and the motor moves.
        rates = fmu.array(fmu.derivatives_function, count)
        states = fmu.array("GetContinuousStates", count)
        assert fmu.call("SetTime", ctypes.c_double(next_time)) == OK
        assert fmu.set_states([x + 5e-4 * r for x, r in zip(states, rates, strict=True)]) == OK
        fmu.completed_step()
        assert fmu.call("EnterEventMode") == OK
        if tick % 50 == 0:
            assert fmu.set("environment.torque", 0.01 * tick) == OK
    fmu.free()
    assert told > 5
    assert quiet > 5
