"""The co-simulation master.

Exchange order, once per communication step from t_k to t_k + h (sequential; sensors, controller, plant):

1. read all testbed outputs at t_k: the sensors, and the truth for the record;
2. set the controller's inputs: the sensors, and the plan at the controller's own path time;
3. controller.doStep(t_k, h): the control ticks in [t_k, t_k + h); read all its outputs;
4. set the testbed's inputs: the commands, and the external push at t_k;
5. testbed.doStep(t_k, h).

Delays of bus and sensors are inside the testbed. Row k of every trace holds the testbed's outputs at t_k and the
controller's outputs from them at t_k. A last read of both closes the record at the end time. Other orders (Jacobi,
plant first) give other results: the order is part of the definition of a run.
"""

from __future__ import annotations

import ctypes
import logging
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.robot.variables import Value, Variable, VariableTable, table
from giveway.robot.wheels import WHEELS
from giveway.scenario.plan import PLAN_INPUTS, PUSH_INPUTS
from giveway.simulation.fmu import Instance, open_fmu

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.scenario.scenario import Scenario

__all__ = ["Binary", "OpenController", "Progress", "Record", "Stepped", "plan_table", "push_table", "simulate"]

_log = logging.getLogger(__name__)

KINDS = ("real", "integer", "boolean")
PATH_TICK_S = 1e-3
PROGRESS_INTERVAL_S = 0.1

Progress = Callable[[float, float], None]
"""Called now and then with the simulated time and the duration, both in s."""


def _indexed(name: str) -> tuple[str, ...]:
    return tuple(f"{name}[{wheel}]" for wheel in range(WHEELS))


# Variables that pass from one FMU to the other under the same name; per type, in the order of exchange.
SENSORS = {
    "real": (*_indexed("sensor.torque"), "sensor.acceleration[0]", "sensor.acceleration[1]", "sensor.yaw_rate"),
    "integer": (*_indexed("sensor.encoder"), "sensor.counter", "sensor.imu_counter"),
    "boolean": ("sensor.present", "sensor.imu_present"),
}
COMMANDS = {
    "real": (*_indexed("command.wheel_angle"), *_indexed("command.wheel_speed")),
    "integer": (),
    "boolean": ("command.enable",),
}


class Binary(Protocol):
    """The file with a model's code; `FmuFile` is one."""

    @property
    def path(self) -> Path: ...
    @property
    def token(self) -> str: ...
    @property
    def sha256(self) -> str: ...


class Stepped(Protocol):
    """What the master steps; `Instance` is one."""

    @property
    def file(self) -> Binary: ...
    def initialise(self, parameters: dict[str, Value], table: VariableTable, start_time_s: float = 0.0, /) -> None: ...
    def dtype(self, kind: str) -> Any: ...
    def check(self, status: int, time_s: float) -> None: ...
    def getter(self, kind: str, references: Sequence[int]) -> Callable[[int], int]: ...
    def setter(self, kind: str, references: Sequence[int]) -> Callable[[int], int]: ...
    def stepper(self) -> Callable[[float, float], int]: ...


OpenController = Callable[[], AbstractContextManager[Stepped]]
"""Opens what takes the place of the controller's FMU for one run."""


@dataclass
class Record:
    """The output of one run, before it is labelled.

    Attributes:
        time_s: shape (n,).
        traces: per full name ("testbed.truth.x"), shape (n,).
        parameters: per model, the parameters that were set.
        files: per model, the FMU or the library.
        interrupted: stopped by the user before the end time.
        wall_s: wall time of the stepping loop in s.
        step_wall_s: wall time inside the FMUs' doStep per model in s; empty unless profiled.
        fmi_version: of the FMUs; None if there were none.
    """

    time_s: NDArray[np.float64]
    traces: dict[str, NDArray[Any]]
    parameters: dict[str, dict[str, Value]]
    files: Mapping[str, Binary]
    interrupted: bool
    wall_s: float
    step_wall_s: dict[str, float] = field(default_factory=dict)
    fmi_version: int | None = None


class _Traces:
    """All outputs of one instance over the whole run: one preallocated array per type, one row per step.

    A row is the buffer of the FMU call itself, and the values for the other FMU come first in it, so neither recording
    nor exchanging makes a copy.
    """

    def __init__(self, instance: Stepped, variables: VariableTable, first: dict[str, tuple[str, ...]], rows: int):
        self.names: dict[str, list[str]] = {}
        self.arrays: dict[str, NDArray[Any]] = {}
        self.base: dict[str, int] = {}
        self.stride: dict[str, int] = {}
        self._getters: dict[str, Callable[[int], int]] = {}
        for kind in KINDS:
            passed = [variables[name] for name in first[kind]]
            rest = [v for v in variables.select("output", kind) if v.name not in first[kind]]
            chosen: list[Variable] = passed + rest
            array = np.zeros((rows, max(len(chosen), 1)), dtype=instance.dtype(kind))
            self.names[kind] = [variable.name for variable in chosen]
            self.arrays[kind] = array
            self.base[kind], self.stride[kind] = array.ctypes.data, array.strides[0]
            self._getters[kind] = instance.getter(kind, [variable.reference for variable in chosen])

    def reader(self) -> Callable[[int], int]:
        """A function that fills row k and returns the or-ed FMI status."""
        real, integer, boolean = (self._getters[kind] for kind in KINDS)
        real_at, integer_at, boolean_at = (self.base[kind] for kind in KINDS)
        real_row, integer_row, boolean_row = (self.stride[kind] for kind in KINDS)
        return lambda k: (
            real(real_at + k * real_row) | integer(integer_at + k * integer_row) | boolean(boolean_at + k * boolean_row)
        )

    def sender(self, receiver: Stepped, to: VariableTable, names: dict[str, tuple[str, ...]]) -> Callable[[int], int]:
        """A function that passes the first values of row k to ``receiver`` and returns the or-ed FMI status."""
        used = [kind for kind in KINDS if names[kind]]
        ports = [
            (receiver.setter(kind, [to[name].reference for name in names[kind]]), self.base[kind], self.stride[kind])
            for kind in used
        ]

        def send(k: int) -> int:
            status = 0
            for port, base, stride in ports:
                status |= port(base + k * stride)
            return status

        return send

    def series(self, model: str, rows: int) -> dict[str, NDArray[Any]]:
        """The recorded rows as one contiguous array per variable."""
        found: dict[str, NDArray[Any]] = {}
        for kind in KINDS:
            for column, name in enumerate(self.names[kind]):
                values = self.arrays[kind][:rows, column]
                found[f"{model}.{name}"] = values.astype(np.bool_) if kind == "boolean" else values.copy()
        return found


def simulate(
    scenario: Scenario,
    progress: Progress | None = None,
    *,
    profile: bool = False,
    controller: OpenController | None = None,
) -> Record:
    """Run ``scenario`` and return its traces; ``controller`` takes the place of the controller's FMU.

    KeyboardInterrupt ends the run cleanly and keeps what was computed. An FMU's error is raised as SimulationError
    with the simulated time and the FMU's own message.
    """
    tables = {model: table(model) for model in native.MODELS}
    scenario.check_traces(sum(len(variables.select("output")) for variables in tables.values()))
    parameters = {model: scenario.parameters(model) for model in native.MODELS}
    fmus = {model: open_fmu(native.fmu(model, scenario.fmi_version)) for model in native.MODELS}
    for model, file in fmus.items():
        file.check_matches(tables[model])
    with ExitStack() as stack:
        instances: dict[str, Stepped] = {}
        for model in native.MODELS:
            if model == "controller" and controller is not None:
                instances[model] = stack.enter_context(controller())
            else:
                instances[model] = stack.enter_context(Instance(fmus[model], model))
        for model, instance in instances.items():
            instance.initialise(parameters[model], tables[model])
        record = _loop(scenario, instances, tables, progress, profile)
    files = {model: instance.file for model, instance in instances.items()}
    record.parameters, record.files, record.fmi_version = parameters, files, scenario.fmi_version
    return record


def _loop(
    scenario: Scenario,
    instances: dict[str, Stepped],
    tables: dict[str, VariableTable],
    progress: Progress | None,
    profile: bool,
) -> Record:
    controller, testbed = instances["controller"], instances["testbed"]
    steps, step_s = scenario.steps, scenario.step_s
    sensed = _Traces(testbed, tables["testbed"], SENSORS, steps + 1)
    decided = _Traces(controller, tables["controller"], COMMANDS, steps + 1)
    read_testbed, read_controller = sensed.reader(), decided.reader()
    send_sensors = sensed.sender(controller, tables["controller"], SENSORS)
    send_commands = decided.sender(testbed, tables["testbed"], COMMANDS)

    plan, set_plan = _plan_port(scenario, controller, tables["controller"])
    plan_at, plan_row, plan_last = plan.ctypes.data, plan.strides[0], len(plan) - 1
    path_ticks, path_column, path_width = _integers(decided, "path_ticks")
    push = push_table(scenario)
    set_push, push_at, push_row = _push_port(push, testbed, tables["testbed"])

    wall: dict[str, float] = {}
    step_controller = _maybe_timed(controller.stepper(), "controller", wall, profile)
    step_testbed = _maybe_timed(testbed.stepper(), "testbed", wall, profile)
    check_controller, check_testbed = controller.check, testbed.check

    report_every = max(1, round(PROGRESS_INTERVAL_S / step_s))
    path_row, rows, interrupted = 0, 0, False
    _log.debug("stepping %s: %d steps of %g s", scenario.name, steps, step_s)
    started = time.perf_counter()
    try:
        for k in range(steps + 1):
            now = k * step_s
            if status := read_testbed(k):
                check_testbed(status, now)
            if status := send_sensors(k) | set_plan(plan_at + path_row * plan_row):
                check_controller(status, now)
            if status := step_controller(now, step_s):
                check_controller(status, now)
            if status := read_controller(k):
                check_controller(status, now)
            rows = k + 1
            if k == steps:
                break
            path_row = min(max(path_ticks[k * path_width + path_column], 0), plan_last)
            if status := send_commands(k) | set_push(push_at + k * push_row):
                check_testbed(status, now)
            if status := step_testbed(now, step_s):
                check_testbed(status, now)
            if progress is not None and k % report_every == 0:
                progress(now, scenario.duration_s)
    except KeyboardInterrupt:
        interrupted = True
        if rows == 0:
            raise
    elapsed = time.perf_counter() - started
    if progress is not None:
        progress((rows - 1) * step_s, scenario.duration_s)

    traces = sensed.series("testbed", rows) | decided.series("controller", rows)
    ticks = traces["controller.path_ticks"]
    used = np.clip(np.concatenate(([0], ticks[:-1])), 0, plan_last)
    for column, name in enumerate(PLAN_INPUTS):
        traces[f"controller.{name}"] = plan[used, column]
    if push is not None:
        held = np.minimum(np.arange(rows), steps - 1)  # nothing is set after the last step
        for column, name in enumerate(PUSH_INPUTS):
            traces[f"testbed.{name}"] = push[held, column]
    return Record(
        time_s=_times(rows, step_s),
        traces=traces,
        parameters={},
        files={},
        interrupted=interrupted,
        wall_s=elapsed,
        step_wall_s=wall,
    )


def _plan_port(
    scenario: Scenario, controller: Stepped, variables: VariableTable
) -> tuple[NDArray[np.float64], Callable[[int], int]]:
    """The plan as a table over path time, and the port that sets one row of it."""
    plan = plan_table(scenario)
    return plan, controller.setter("real", [variables[name].reference for name in PLAN_INPUTS])


def _push_port(
    push: NDArray[np.float64] | None, testbed: Stepped, variables: VariableTable
) -> tuple[Callable[[int], int], int, int]:
    """Port, address and row size of the external push; a port that does nothing if there is none."""
    if push is None:
        return (lambda _address: 0), 0, 0
    port = testbed.setter("real", [variables[name].reference for name in PUSH_INPUTS])
    return port, push.ctypes.data, push.strides[0]


def plan_table(scenario: Scenario) -> NDArray[np.float64]:
    """The plan over path time, one row per path tick of 1 ms, shape (n, 9)."""
    ticks = int(np.ceil(scenario.duration_s / PATH_TICK_S)) + 1
    return _table_of("plan", scenario.plan, _times(ticks, PATH_TICK_S), len(PLAN_INPUTS))


def push_table(scenario: Scenario) -> NDArray[np.float64] | None:
    """The external push over time, one row per communication point, shape (n, 4); None if there is none."""
    if scenario.push is None:
        return None
    return _table_of("push", scenario.push, _times(scenario.steps + 1, scenario.step_s), len(PUSH_INPUTS))


def _table_of(
    name: str, function: Callable[[NDArray[np.float64]], Any], times: NDArray[np.float64], columns: int
) -> NDArray[np.float64]:
    values = np.ascontiguousarray(function(times), dtype=np.float64)
    if values.shape != (len(times), columns):
        raise GivewayError(name, f"an array of shape {values.shape}", f"shape {(len(times), columns)}")
    if not np.isfinite(values).all():
        raise GivewayError(name, "an array with NaN or infinity", "finite numbers")
    return values


def _times(count: int, step_s: float) -> NDArray[np.float64]:
    return np.arange(count, dtype=np.float64) * step_s


def _integers(traces: _Traces, name: str) -> tuple[Any, int, int]:
    """The integer trace as a flat ctypes array (quick to read one element of), column of ``name``, and row width."""
    array = traces.arrays["integer"]
    flat = (ctypes.c_int32 * array.size).from_buffer(array.data)
    return flat, traces.names["integer"].index(name), array.shape[1]


def _maybe_timed(
    step: Callable[[float, float], int], model: str, wall: dict[str, float], profile: bool
) -> Callable[[float, float], int]:
    if not profile:
        return step
    wall[model] = 0.0
    clock = time.perf_counter

    def timed(time_s: float, step_s: float) -> int:
        started = clock()
        status = step(time_s, step_s)
        wall[model] += clock() - started
        return status

    return timed
