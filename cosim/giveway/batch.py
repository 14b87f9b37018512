"""Many runs at once, without FMUs: the bits of `giveway.run`, many times as fast.

`run_many` runs scenarios in threads of the batch library and returns a table of metrics, and the traces that are asked
for. It leaves the interpreter free (the GIL is released) and ends cleanly on Ctrl-C.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base import native
from giveway.base.checks import whole
from giveway.base.errors import GivewayError, UnknownNameError
from giveway.base.system import processors
from giveway.library.batch_library import (
    LANES,
    METHODS,
    OK,
    STATUSES,
    THREADS_MAX,
    ProgressCounts,
    native_metrics,
    options,
    widest_lanes,
)
from giveway.robot.variables import Value, table
from giveway.scenario.plan import Rest
from giveway.scenario.plan_limits import check_plan, limits_of
from giveway.simulation.native_engine import NativeRuns, Trace
from giveway.simulation.run_warnings import METRICS, codes_of

if TYPE_CHECKING:
    import xarray

    from giveway.scenario.scenario import Scenario
    from giveway.simulation.master import Progress
    from giveway.simulation.result import Result

__all__ = ["LANES", "METHODS", "BatchProgress", "Prepared", "native_metrics", "run", "run_many", "widest_lanes"]

BatchProgress = Callable[[int, int], None]
"""Called now and then with the number of finished runs and of all runs."""


def run(scenario: Scenario, progress: Progress | None = None) -> Result:
    """``giveway.run(scenario, progress, engine="native")``."""
    from giveway.simulation import runner

    return runner.run(scenario, progress, "native")


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

    Over the dimension ``run``, in the order of ``scenarios``: every metric under its name with its unit, its true value
    as ``NAME (true)``, NaN for events that did not happen; ``status`` ("ok", "cancelled", "refused", "failed", ...),
    ``message`` (empty if ok), ``simulated`` (simulated time, s) and ``warnings`` (codes of deviations from the request,
    see `simulation.run_warnings`; empty if there are none). A run that fails does not stop the others. Over ``run`` and
    ``time``: the variables named in ``traces`` ("testbed.truth.contact_force"), zero after the end of a run that ended
    early; for these all scenarios need the same duration and step.

    ``method`` "event-exact" gives the bits of `giveway.run`. "fixed-step" computes ``lanes`` designs side by side (1, 4
    or 8; None: as many as the processor can) with fixed steps of ``plant_step_s`` (1e-6 to 5e-4 s; None: as each design
    needs). It is several times faster, with the errors listed on the site's page "Fixed steps", and each design has the
    same bits with any lanes, threads and other scenarios. Its table tells for each run how it was computed: ``method``
    (runs that are not possible with fixed steps are event-exact) and ``plant step`` (s, 0 if event-exact); the
    attributes ``method`` and ``lanes`` are those of the batch.

    Wrong scenarios are refused before anything runs. Ctrl-C ends the batch; finished runs are kept, the rest is
    "cancelled", and the attribute ``interrupted`` is true.
    """
    prepared = Prepared(scenarios, traces=traces)
    return prepared.run(threads=threads, progress=progress, method=method, lanes=lanes, plant_step_s=plant_step_s)


class Prepared:
    """Scenarios in the library's form, checked once, to be run any number of times.

    Args:
        scenarios, traces: as in `run_many`.
    """

    def __init__(self, scenarios: Sequence[Scenario], *, traces: Sequence[str] = ()) -> None:
        scenarios = list(scenarios)
        self._traces = [_trace(name) for name in dict.fromkeys(traces)]
        if self._traces and len({(scenario.steps, scenario.step_s) for scenario in scenarios}) > 1:
            raise GivewayError("traces", ", ".join(traces), "none, or scenarios of one duration and step")
        self._step_s = scenarios[0].step_s if scenarios else 0.0
        parameters = [_parameters(index, scenario) for index, scenario in enumerate(scenarios)]
        self._batch = NativeRuns(scenarios, parameters, self._traces)

    def run(
        self,
        *,
        threads: int | None = None,
        progress: BatchProgress | None = None,
        method: str = "event-exact",
        lanes: int | None = None,
        plant_step_s: float | None = None,
    ) -> xarray.Dataset:
        """Run them all, as `run_many`; traces of the previous call are overwritten."""
        if threads is None:
            threads = min(processors(), THREADS_MAX)
        whole("threads", threads, 1, THREADS_MAX)
        chosen = options(threads, method, lanes, plant_step_s)

        def report(state: ProgressCounts) -> None:
            if progress is not None:
                progress(int(state.runs_done), int(state.runs))

        interrupted = self._batch.execute(chosen, report)
        table = _dataset(self._batch, self._traces, self._step_s)
        return table.assign_attrs(interrupted=interrupted, method=method, lanes=int(chosen.lanes))


def _parameters(index: int, scenario: Scenario) -> dict[str, dict[str, Value]]:
    try:
        found = {model: scenario.parameters(model) for model in native.MODELS}
        if not isinstance(scenario.plan, Rest):
            check_plan(scenario.plan, limits_of(found["controller"]))
        return found
    except GivewayError as error:
        error.field = f"run {index}: {error.field}"
        raise


def _trace(name: str) -> Trace:
    model, _, variable = name.partition(".")
    if model not in native.MODELS:
        raise UnknownNameError("traces: model", model, native.MODELS)
    chosen = table(model)[variable]
    if chosen.causality not in ("input", "output"):
        raise GivewayError("traces", name, f"an input or output ({name} is a {chosen.causality})")
    return Trace(model, chosen)


def _dataset(batch: NativeRuns, traces: Sequence[Trace], step_s: float) -> xarray.Dataset:
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
