"""Runs without FMUs, in the batch library: its arrays made of scenarios, and one run as the master gives it."""

from __future__ import annotations

import ctypes
import functools
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base import native
from giveway.base.errors import GivewayError, SimulationError
from giveway.library.batch_library import (
    CANCELLED,
    COLUMN,
    DTYPES,
    MESSAGE_SIZE,
    NONE,
    OK,
    SETTING,
    SPEC,
    WRONG,
    Options,
    ProgressCounts,
    library,
)
from giveway.robot.variables import Value, Variable, table
from giveway.scenario.plan import PLAN_INPUTS, PUSH_INPUTS, Rest
from giveway.simulation.master import Progress, Record, plan_table, push_table
from giveway.simulation.run_warnings import Stated

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.scenario.scenario import Scenario

__all__ = ["NativeRuns", "Trace", "simulate"]

WAIT_S = 0.1


@dataclass(frozen=True)
class Trace:
    """A variable to record."""

    model: str
    variable: Variable

    @property
    def name(self) -> str:
        return f"{self.model}.{self.variable.name}"

    @property
    def dtype(self) -> Any:
        return DTYPES[self.variable.type]


class NativeRuns:
    """The arrays that the library reads and writes; they must outlive the call.

    Args:
        scenarios: what to run.
        parameters: per scenario and model, the parameters that are set.
        traces: what to record of each; then all have as many steps.
    """

    def __init__(
        self,
        scenarios: Sequence[Scenario],
        parameters: Sequence[Mapping[str, Mapping[str, Value]]],
        traces: Sequence[Trace],
    ) -> None:
        self.library = library()
        self.parameters = parameters
        self.results = np.zeros(len(scenarios), dtype=self.library.result)
        self.stated = Stated.of(scenarios)
        self._specs = np.zeros(len(scenarios), dtype=SPEC)
        self._specs["step_s"] = [scenario.step_s for scenario in scenarios]
        self._specs["step_count"] = [scenario.steps for scenario in scenarios]
        self._set_parameters()
        for index, scenario in enumerate(scenarios):
            if (region := scenario.judged) is not None:
                self._specs["transient_limit_n"][index] = region.peak_limit_n
                self._specs["lasting_limit_n"][index] = region.lasting_limit_n
        self._plans = _Tables(self._specs, "plan")
        self._pushes = _Tables(self._specs, "push")
        for index, scenario in enumerate(scenarios):
            grid = (scenario.duration_s, scenario.step_s)
            plan = scenario.plan if isinstance(scenario.plan, Rest) else (grid, id(scenario.plan))
            self._plans.set(index, plan, functools.partial(_plan, scenario))
            if scenario.push is not None:
                self._pushes.set(index, (grid, id(scenario.push)), functools.partial(push_table, scenario))
        longest = max(scenarios, key=lambda scenario: scenario.steps, default=None)
        if longest is not None:
            longest.check_traces(len(traces), len(scenarios))
        rows = 0 if longest is None else longest.steps + 1
        self.traces = {trace.name: np.zeros((len(scenarios), rows), dtype=trace.dtype) for trace in traces}
        self._set_columns(traces)

    def _set_parameters(self) -> None:
        counts = [sum(map(len, values.values())) for values in self.parameters]
        tables = {model: table(model) for model in native.MODELS}
        rows = [
            (number, tables[model][name].reference, float(value))
            for values in self.parameters
            for number, model in enumerate(native.MODELS)
            for name, value in values[model].items()
        ]
        self._settings = np.array(rows, dtype=SETTING)
        self._specs["setting_count"] = counts
        first = np.cumsum([0, *counts[:-1]]) if counts else np.zeros(0, dtype=np.intp)
        self._specs["settings"] = self._settings.ctypes.data + first * SETTING.itemsize

    def _set_columns(self, traces: Sequence[Trace]) -> None:
        self._columns = np.zeros((len(self.results), len(traces)), dtype=COLUMN)
        for column, trace in enumerate(traces):
            array = self.traces[trace.name]
            self._columns["model"][:, column] = native.MODELS.index(trace.model)
            self._columns["reference"][:, column] = trace.variable.reference
            self._columns["values"][:, column] = array.ctypes.data + np.arange(len(array)) * array.strides[0]
        self._specs["column_count"] = len(traces)
        self._specs["columns"] = self._columns.ctypes.data + np.arange(len(self.results)) * self._columns.strides[0]

    def execute(self, options: Options, report: Callable[[ProgressCounts], None]) -> bool:
        """Run everything; True if Ctrl-C ended it early. ``report`` is called on this thread."""
        library, progress, interrupted = self.library, ProgressCounts(), False
        handle = ctypes.c_void_p()
        message = ctypes.create_string_buffer(MESSAGE_SIZE)
        try:
            specs, results = self._specs.ctypes.data, self.results.ctypes.data
            chosen = ctypes.byref(options)
            if not library.start(specs, len(self.results), chosen, results, ctypes.byref(handle), message):
                raise SimulationError("batch library", message.value.decode(), 0.0)
            done = False
            while not done:
                try:
                    done = bool(library.wait(handle, WAIT_S, ctypes.byref(progress)))
                    report(progress)
                except KeyboardInterrupt:
                    library.cancel(handle)
                    interrupted = True
        finally:
            library.finish(handle)  # from here on no thread writes to the arrays, also after an exception
        return interrupted

    def error(self, index: int) -> GivewayError:
        """The error of a run, as giveway.run would raise it."""
        result = self.results[index]
        message = result["message"].decode()
        if result["model"] == NONE:
            return SimulationError("batch library", message, float(result["time_s"]))
        model = native.MODELS[result["model"]]
        if result["status"] == WRONG and result["reference"] != NONE:
            variable = next(v for v in table(model) if v.reference == result["reference"])
            return GivewayError(f"{model}.{variable.name}", float(result["value"]), variable.allowed)
        return SimulationError(model, message.removeprefix(f"{model}: "), float(result["time_s"]))


class _Tables:
    """One kind of input table of all specs; specs with the same function share the memory."""

    def __init__(self, specs: NDArray[Any], field: str) -> None:
        self._specs, self._field = specs, field
        self._made: dict[object, NDArray[np.float64]] = {}

    def set(self, index: int, key: object, make: Callable[[], NDArray[np.float64] | None]) -> None:
        if key not in self._made:
            made = make()
            assert made is not None
            self._made[key] = made
        values = self._made[key]
        self._specs[self._field][index] = values.ctypes.data
        self._specs[f"{self._field}_rows"][index] = len(values)


def _plan(scenario: Scenario) -> NDArray[np.float64]:
    values = plan_table(scenario)
    # The library holds the last row for ever, so a robot at rest needs only one.
    return values[:1] if isinstance(scenario.plan, Rest) else values


def simulate(scenario: Scenario, progress: Progress | None = None) -> Record:
    """One run, every bit as `master.simulate` records it; there are no FMUs, so ``fmi_version`` says nothing."""
    inputs = {"controller": PLAN_INPUTS, "testbed": () if scenario.push is None else PUSH_INPUTS}
    traces = [
        Trace(model, variable)
        for model in native.MODELS
        for variable in table(model)
        if variable.causality == "output" or variable.name in inputs[model]
    ]
    parameters = {model: scenario.parameters(model) for model in native.MODELS}
    runs = NativeRuns([scenario], [parameters], traces)

    def report(state: ProgressCounts) -> None:
        if progress is not None:
            progress(state.steps_done * scenario.step_s, scenario.duration_s)

    started = time.perf_counter()
    interrupted = runs.execute(Options(threads=1), report)
    elapsed = time.perf_counter() - started
    status, rows = int(runs.results["status"][0]), int(runs.results["rows"][0])
    if status not in (OK, CANCELLED):
        raise runs.error(0)
    if rows == 0:
        raise KeyboardInterrupt
    return Record(
        time_s=np.arange(rows, dtype=np.float64) * scenario.step_s,
        traces={name: values[0, :rows] for name, values in runs.traces.items()},
        parameters=parameters,
        files=runs.library.models,
        interrupted=interrupted and status == CANCELLED,
        wall_s=elapsed,
    )
