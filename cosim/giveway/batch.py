"""Runs without FMUs, in libgiveway_batch: the same bits as over FMPy, many times as fast, and many at once.

`run` is `giveway.run` in one native call. `run_many` runs scenarios in threads and returns a table of metrics, and the
traces that are asked for. Both leave the interpreter free (the GIL is released) and end cleanly on Ctrl-C.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base import native
from giveway.base.checks import finite, whole
from giveway.base.errors import FileError, GivewayError, SimulationError, UnknownNameError
from giveway.robot.variables import Value, Variable, table
from giveway.scenario.plan import PLAN_INPUTS, PUSH_INPUTS, Rest
from giveway.scenario.plan_limits import check_plan, limits_of
from giveway.simulation.master import Progress, Record, plan_table, push_table
from giveway.simulation.run_warnings import METRICS, Stated, codes_of

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

    from giveway.scenario.scenario import Scenario
    from giveway.simulation.result import Result

__all__ = ["LANES", "METHODS", "BatchProgress", "Prepared", "run", "run_many", "widest_lanes"]

BatchProgress = Callable[[int, int], None]
"""Called now and then with the number of finished runs and of all runs."""

METHODS = ("event-exact", "fixed-step")
LANES = (1, 4, 8)
PLANT_STEP_RANGE_S = (1e-6, 5e-4)
STATUSES = ("ok", "cancelled", "wrong", "refused", "failed", "no memory")
OK, CANCELLED, WRONG = 0, 1, 2
NONE = 2**32 - 1  # no model, no reference
MESSAGE_SIZE = 512
THREADS_MAX = 1024
WAIT_S = 0.1

_DTYPES: Mapping[str, Any] = {"real": np.float64, "integer": np.int32, "boolean": np.bool_}
_POINTER = np.uintp
_SETTING = np.dtype([("model", "u4"), ("reference", "u4"), ("value", "f8")], align=True)
_COLUMN = np.dtype([("model", "u4"), ("reference", "u4"), ("values", _POINTER)], align=True)
_SPEC = np.dtype(
    [
        ("step_s", "f8"),
        ("step_count", "u4"),
        ("setting_count", "u4"),
        ("settings", _POINTER),
        ("plan", _POINTER),
        ("push", _POINTER),
        ("plan_rows", "u4"),
        ("push_rows", "u4"),
        ("columns", _POINTER),
        ("column_count", "u4"),
        ("reserved", "u4"),
        ("transient_limit_n", "f8"),
        ("lasting_limit_n", "f8"),
    ],
    align=True,
)


class _MetricInfo(ctypes.Structure):
    _fields_ = [
        ("name", ctypes.c_char_p),
        ("unit", ctypes.c_char_p),
        ("has_truth", ctypes.c_uint32),
        ("decimals", ctypes.c_int32),
        ("shown", ctypes.c_uint32),
        ("line", ctypes.c_uint32),
        ("description", ctypes.c_char_p),
    ]


class _Variable(ctypes.Structure):
    _fields_ = [
        ("model", ctypes.c_uint32),
        ("reference", ctypes.c_uint32),
        ("type", ctypes.c_uint32),
        ("causality", ctypes.c_uint32),
        ("minimum", ctypes.c_double),
        ("maximum", ctypes.c_double),
        ("name", ctypes.c_char_p),
    ]


class _Options(ctypes.Structure):
    _fields_ = [
        ("threads", ctypes.c_uint32),
        ("method", ctypes.c_uint32),
        ("lanes", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("plant_step_s", ctypes.c_double),
    ]


class _Progress(ctypes.Structure):
    _fields_ = [(name, ctypes.c_uint64) for name in ("runs_done", "runs", "steps_done", "steps")]


@dataclass(frozen=True)
class _NativeMetric:
    name: str
    unit: str
    has_truth: bool


@dataclass(frozen=True)
class _Model:
    """One model inside the library, for the manifest."""

    path: Path
    token: str
    sha256: str


class _Library:
    """The loaded library: its functions, its metrics, and the layout of its results."""

    def __init__(self, path: Path) -> None:
        try:
            self._dll = ctypes.CDLL(str(path))
        except OSError as error:
            raise FileError(path, f"cannot be loaded: {error}") from None
        pointer, size, number = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint32
        self._function("gwb_token", ctypes.c_char_p, number)
        self._function("gwb_find_variable", ctypes.c_int, number, ctypes.c_char_p, pointer)
        self._function("gwb_metric_info", ctypes.c_int, number, pointer)
        self._function("gwb_metric_count", number)
        self.start = self._function(
            "gwb_start", ctypes.c_int, pointer, size, pointer, pointer, pointer, ctypes.c_char_p
        )
        self.wait = self._function("gwb_wait", ctypes.c_int, pointer, ctypes.c_double, pointer)
        self.cancel = self._function("gwb_cancel", None, pointer)
        self.widest_lanes = self._function("gwb_widest_lanes", number)
        self.finish = self._function("gwb_finish", None, pointer)
        sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
        self.models: dict[str, _Model] = {}
        for number_of_model, model in enumerate(native.MODELS):
            self._check_matches(path, number_of_model, model)
            self.models[model] = _Model(path, self._dll.gwb_token(number_of_model).decode(), sha256)
        self.metrics = [self._metric(index) for index in range(self._dll.gwb_metric_count())]
        metric_count = len(self.metrics)
        self.result = np.dtype(
            [
                ("status", "u4"),
                ("model", "u4"),
                ("reference", "u4"),
                ("rows", "u4"),
                ("method", "u4"),
                ("reserved", "u4"),
                ("time_s", "f8"),
                ("plant_step_s", "f8"),
                ("value", "f8"),
                ("minimum", "f8"),
                ("maximum", "f8"),
                ("metric", "f8", (metric_count,)),
                ("truth", "f8", (metric_count,)),
                ("message", f"S{MESSAGE_SIZE}"),
            ],
            align=True,
        )

    def _function(self, name: str, returns: Any, *arguments: Any) -> Callable[..., Any]:
        function = getattr(self._dll, name)
        function.restype, function.argtypes = returns, arguments
        return function  # type: ignore[no-any-return]

    def _check_matches(self, path: Path, number: int, model: str) -> None:
        """Refuse a library that was built from another variable table: its references would mean other things."""
        for variable in table(model):
            found = _Variable()
            known = self._dll.gwb_find_variable(number, variable.name.encode(), ctypes.byref(found))
            if not known or found.reference != variable.reference:
                reason = f"was built from another variable table: {model}.{variable.name} differs"
                raise FileError(path, reason, "build the library and the tables together")

    def _metric(self, index: int) -> _NativeMetric:
        info = _MetricInfo()
        self._dll.gwb_metric_info(index, ctypes.byref(info))
        return _NativeMetric(info.name.decode(), info.unit.decode(), bool(info.has_truth))


def _library() -> _Library:
    path = native.batch_library()
    return _load(path, path.stat().st_mtime_ns)


@functools.cache
def _load(path: Path, _modified_ns: int) -> _Library:
    return _Library(path)


def native_metrics() -> list[_NativeMetric]:
    """What the library measures, with units, in the order of its results."""
    return _library().metrics


@dataclass(frozen=True)
class _Trace:
    """A variable to record."""

    model: str
    variable: Variable

    @property
    def name(self) -> str:
        return f"{self.model}.{self.variable.name}"

    @property
    def dtype(self) -> Any:
        return _DTYPES[self.variable.type]


class _Batch:
    """The arrays that the library reads and writes; they must outlive the call."""

    def __init__(self, scenarios: Sequence[Scenario], traces: Sequence[_Trace]) -> None:
        self.library = _library()
        self.parameters = [_parameters(index, scenario) for index, scenario in enumerate(scenarios)]
        self.results = np.zeros(len(scenarios), dtype=self.library.result)
        self.stated = Stated.of(scenarios)
        self._specs = np.zeros(len(scenarios), dtype=_SPEC)
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
        self._settings = np.array(rows, dtype=_SETTING)
        self._specs["setting_count"] = counts
        first = np.cumsum([0, *counts[:-1]]) if counts else np.zeros(0, dtype=np.intp)
        self._specs["settings"] = self._settings.ctypes.data + first * _SETTING.itemsize

    def _set_columns(self, traces: Sequence[_Trace]) -> None:
        self._columns = np.zeros((len(self.results), len(traces)), dtype=_COLUMN)
        for column, trace in enumerate(traces):
            array = self.traces[trace.name]
            self._columns["model"][:, column] = native.MODELS.index(trace.model)
            self._columns["reference"][:, column] = trace.variable.reference
            self._columns["values"][:, column] = array.ctypes.data + np.arange(len(array)) * array.strides[0]
        self._specs["column_count"] = len(traces)
        self._specs["columns"] = self._columns.ctypes.data + np.arange(len(self.results)) * self._columns.strides[0]

    def execute(self, options: _Options, report: Callable[[_Progress], None]) -> bool:
        """Run everything; True if Ctrl-C ended it early. ``report`` is called on this thread."""
        library, progress, interrupted = self.library, _Progress(), False
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
            library.finish(handle)  # whatever happened, no thread writes to the arrays any more
        return interrupted

    def error(self, index: int) -> GivewayError:
        """What went wrong in a run, as giveway.run would raise it."""
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
    """One kind of input table of all specs; those that share a function share the memory."""

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
    # The library holds the last row for ever: one is enough to rest.
    return values[:1] if isinstance(scenario.plan, Rest) else values


def _parameters(index: int, scenario: Scenario) -> dict[str, dict[str, Value]]:
    try:
        found = {model: scenario.parameters(model) for model in native.MODELS}
        if not isinstance(scenario.plan, Rest):
            check_plan(scenario.plan, limits_of(found["controller"]))
        return found
    except GivewayError as error:
        error.field = f"run {index}: {error.field}"
        raise


def run(scenario: Scenario, progress: Progress | None = None) -> Result:
    """Run ``scenario`` natively: the same result as `giveway.run`, every bit of every trace.

    ``progress``, if given, is called now and then with the simulated time and the duration (both in s). Ctrl-C ends the
    run cleanly; the result then holds what was computed and says so in its manifest. ``fmi_version`` is not used.
    """
    from giveway.simulation.runner import judge

    inputs = {"controller": PLAN_INPUTS, "testbed": () if scenario.push is None else PUSH_INPUTS}
    traces = [
        _Trace(model, variable)
        for model in native.MODELS
        for variable in table(model)
        if variable.causality == "output" or variable.name in inputs[model]
    ]
    batch = _Batch([scenario], traces)

    def report(state: _Progress) -> None:
        if progress is not None:
            progress(state.steps_done * scenario.step_s, scenario.duration_s)

    started = time.perf_counter()
    interrupted = batch.execute(_Options(threads=1), report)
    elapsed = time.perf_counter() - started
    status, rows = int(batch.results["status"][0]), int(batch.results["rows"][0])
    if status not in (OK, CANCELLED):
        raise batch.error(0)
    if rows == 0:
        raise KeyboardInterrupt
    record = Record(
        time_s=np.arange(rows, dtype=np.float64) * scenario.step_s,
        traces={name: values[0, :rows] for name, values in batch.traces.items()},
        parameters=batch.parameters[0],
        files=batch.library.models,
        interrupted=interrupted and status == CANCELLED,
        wall_s=elapsed,
    )
    return judge(scenario, record)


def run_many(
    scenarios: Sequence[Scenario],
    *,
    threads: int | None = None,
    traces: Sequence[str] = (),
    progress: BatchProgress | None = None,
    method: str = "event-exact",
    lanes: int | None = None,
    plant_step_s: float | None = None,
) -> xarray.Dataset:
    """Run ``scenarios`` in ``threads`` threads (None: one per processor) and return a table.

    Over the dimension ``run``, in the order of ``scenarios``: every metric under its name with its unit, the truth it
    is compared with as ``NAME (true)``, NaN for what did not happen; ``status`` ("ok", "cancelled", "refused",
    "failed", ...), ``message`` (empty if ok), ``simulated`` (s, how far the run came) and ``warnings`` (codes of what
    happened otherwise than asked, see `simulation.run_warnings`; empty if nothing did). A run that fails does not
    stop the others. Over ``run`` and ``time``: the variables named in ``traces`` ("testbed.truth.contact_force"), zero
    from where a run ended early; for these all scenarios need the same duration and step.

    ``method`` "event-exact" gives the bits of `giveway.run`. "fixed-step" computes ``lanes`` designs side by side (1, 4
    or 8; None: as many as the processor can) over fixed steps of ``plant_step_s`` (1e-6 to 5e-4 s; None: as each design
    needs): several times as fast, with the errors that fmu/batch/README.md lists, and each design with the same bits
    whatever the lanes, threads and other scenarios. Its table says per run how it was computed: ``method`` (what cannot
    be done over fixed steps is done event-exact) and ``plant step`` (s, 0 if event-exact); the attributes ``method``
    and ``lanes`` are those of the batch.

    Wrong scenarios are refused before anything runs. Ctrl-C ends the batch; what is done is kept, the rest is
    "cancelled", and the attribute ``interrupted`` is true.
    """
    prepared = Prepared(scenarios, traces=traces)
    return prepared.run(threads=threads, progress=progress, method=method, lanes=lanes, plant_step_s=plant_step_s)


class Prepared:
    """Scenarios as the library takes them, checked once, to be run as often as wanted.

    Args:
        scenarios, traces: as in `run_many`.
    """

    def __init__(self, scenarios: Sequence[Scenario], *, traces: Sequence[str] = ()) -> None:
        scenarios = list(scenarios)
        self._traces = [_trace(name) for name in dict.fromkeys(traces)]
        if self._traces and len({(scenario.steps, scenario.step_s) for scenario in scenarios}) > 1:
            raise GivewayError("traces", ", ".join(traces), "none, or scenarios of one duration and step")
        self._step_s = scenarios[0].step_s if scenarios else 0.0
        self._batch = _Batch(scenarios, self._traces)

    def run(
        self,
        *,
        threads: int | None = None,
        progress: BatchProgress | None = None,
        method: str = "event-exact",
        lanes: int | None = None,
        plant_step_s: float | None = None,
    ) -> xarray.Dataset:
        """Run them all, as `run_many`; what the run before recorded in its traces is overwritten."""
        if threads is None:
            threads = min(len(os.sched_getaffinity(0)), THREADS_MAX)
        whole("threads", threads, 1, THREADS_MAX)
        options = _options(threads, method, lanes, plant_step_s)

        def report(state: _Progress) -> None:
            if progress is not None:
                progress(int(state.runs_done), int(state.runs))

        interrupted = self._batch.execute(options, report)
        table = _dataset(self._batch, self._traces, self._step_s)
        return table.assign_attrs(interrupted=interrupted, method=method, lanes=int(options.lanes))


def widest_lanes() -> int:
    """Designs that this processor computes side by side: 8 with AVX-512, 4 with AVX2, else 1."""
    return int(_library().widest_lanes())


def _options(threads: int, method: str, lanes: int | None, plant_step_s: float | None) -> _Options:
    if method not in METHODS:
        raise UnknownNameError("method", method, METHODS)
    if method == "event-exact":
        for name, value in (("lanes", lanes), ("plant_step_s", plant_step_s)):
            if value is not None:
                raise GivewayError(name, value, "none with the method event-exact")
        return _Options(threads=threads)
    widest = widest_lanes()
    possible = [number for number in LANES if number <= widest]
    if lanes is not None and lanes not in possible:
        raise GivewayError("lanes", lanes, f"one of {', '.join(map(str, possible))} on this processor")
    if plant_step_s is not None:
        finite("plant_step_s", plant_step_s, *PLANT_STEP_RANGE_S, "s")
    return _Options(threads, METHODS.index(method), lanes or widest, 0, plant_step_s or 0.0)


def _trace(name: str) -> _Trace:
    model, _, variable = name.partition(".")
    if model not in native.MODELS:
        raise UnknownNameError("traces: model", model, native.MODELS)
    chosen = table(model)[variable]
    if chosen.causality not in ("input", "output"):
        raise GivewayError("traces", name, f"an input or output ({name} is a {chosen.causality})")
    return _Trace(model, chosen)


def _dataset(batch: _Batch, traces: Sequence[_Trace], step_s: float) -> xarray.Dataset:
    import xarray

    results = batch.results
    columns: dict[str, Any] = {
        "status": ("run", np.array(STATUSES)[results["status"]]),
        "message": ("run", np.array([message.decode() for message in results["message"]], dtype=np.str_)),
        "simulated": ("run", results["time_s"].copy(), {"units": "s", "long_name": "Simulated time"}),
        "method": ("run", np.array(METHODS)[results["method"]]),
        "plant step": ("run", results["plant_step_s"].copy(), {"units": "s", "long_name": "Fixed step of the plant"}),
    }
    for index, metric in enumerate(batch.library.metrics):
        attributes = {"units": metric.unit}
        columns[metric.name] = ("run", results["metric"][:, index].copy(), attributes)
        if metric.has_truth:
            columns[f"{metric.name} (true)"] = ("run", results["truth"][:, index].copy(), attributes)
    codes = codes_of(batch.stated, {name: columns[name][1] for name in METRICS})
    warnings = [found if status == OK else "" for found, status in zip(codes, results["status"], strict=True)]
    columns["warnings"] = ("run", np.array(warnings, dtype=np.str_))
    coordinates: dict[str, Any] = {"run": np.arange(len(results))}
    for trace in traces:
        attributes = {"units": trace.variable.unit or "1", "long_name": trace.variable.description}
        columns[trace.name] = (("run", "time"), batch.traces[trace.name], attributes)
        rows = batch.traces[trace.name].shape[1]
        coordinates["time"] = ("time", np.arange(rows) * step_s, {"units": "s", "long_name": "Simulated time"})
    return xarray.Dataset(columns, coords=coordinates)
