"""`giveway fmu run`: any FMU, Co-Simulation or Model Exchange, over FMPy; traces as CSV or as a page with plots."""

from __future__ import annotations

import io
import logging
import math
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.checks import finite
from giveway.errors import GivewayError, SimulationError, UnknownNameError, one_line
from giveway.files import check_file, replace_file
from giveway.fmu_info import read_for_use

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription
    from numpy.typing import NDArray

__all__ = ["INTERFACES", "FmuRun", "check_run_output", "run_fmu", "write_run"]

_log = logging.getLogger(__name__)

INTERFACES = {"cs": "CoSimulation", "me": "ModelExchange"}
ENDINGS = (".csv", ".html")
LONGEST_S, MOST_ROWS = 1e6, 2_000_000
DEFAULT_STOP_S, DEFAULT_STEPS = 1.0, 500
PLOTTED_VARIABLES, POINTS_SHOWN = 60, 2000


@dataclass(frozen=True)
class FmuRun:
    """What came out.

    Attributes:
        traces: structured array; field "time" in s, then one field per recorded variable.
        units: per variable, "" if it has none.
    """

    path: Path
    interface: str
    step_s: float
    traces: NDArray[Any]
    units: dict[str, str]
    description: str


def check_run_output(out: Path) -> None:
    """Refuse, before any work is done, what `write_run` could not write."""
    if out.suffix not in ENDINGS:
        raise GivewayError("--out", out, f"a file that ends in {' or '.join(ENDINGS)}")
    check_file(out)


def run_fmu(
    path: Path,
    interface: str | None = None,
    stop_s: float | None = None,
    step_s: float | None = None,
    assignments: list[str] | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> FmuRun:
    """Run the FMU at ``path`` from its start values, inputs held.

    Args:
        interface: "cs" or "me"; None: Co-Simulation if it has one.
        stop_s: simulated time in s; None: the FMU's default experiment, else 1 s.
        step_s: communication step, in Model Exchange the output interval, in s; None: the FMU's own, else a 500th of
            the time.
        assignments: "NAME=VALUE" for inputs and parameters.
        progress: called after each step with the simulated time and the duration, in s.
    """
    import fmpy

    description = read_for_use(path)
    kind = _interface(description, interface)
    start_s, stop, step = _times(description, stop_s, step_s)
    values = _assigned(description, assignments or [])
    printed = io.StringIO()

    def log(_environment: object, status: int, _category: bytes, text: bytes) -> None:
        message = text.decode("utf-8", "replace")
        _log.log(logging.WARNING if status else logging.DEBUG, "%s: %s", path.name, message)
        print(message)

    def stepped(time_s: float, _recorder: object) -> bool:
        if progress is not None:
            progress(time_s, stop)
        return True

    # FMPy's proxy for the messages of FMI 2 keeps a pointer to the last logger that was registered, of any instance,
    # also after that logger is gone. So none is registered: FMPy then prints what it is told, and that is caught here.
    logger = log if str(description.fmiVersion).startswith("3") else None
    try:
        with redirect_stdout(printed):
            traces = fmpy.simulate_fmu(
                str(path), validate=False, start_time=start_s, stop_time=stop, output_interval=step, fmi_type=kind,
                start_values=values, logger=logger, step_finished=stepped, model_description=description,
            )  # fmt: skip
    except Exception as error:  # FMPy raises its own and plain Exceptions
        words = printed.getvalue().splitlines()[-3:]
        raise SimulationError(path.name, one_line(" ".join([str(error), *words])), start_s) from None
    named = {variable.name: variable for variable in description.modelVariables}
    units = {n: (named[n].unit or "") if n in named else "" for n in traces.dtype.names if n != "time"}
    return FmuRun(path, kind, step, traces, units, description.description or description.modelName)


def _interface(description: ModelDescription, wanted: str | None) -> str:
    found = {"cs": description.coSimulation, "me": description.modelExchange}
    offered = [name for name, interface in found.items() if interface is not None]
    if wanted is None and offered:
        return INTERFACES[offered[0]]
    if wanted not in offered:
        raise GivewayError("--interface", wanted, f"{' or '.join(offered) or 'nothing'}: what this FMU has")
    return INTERFACES[wanted]


def _times(description: ModelDescription, stop_s: float | None, step_s: float | None) -> tuple[float, float, float]:
    experiment = description.defaultExperiment
    start, own_stop, own_step = (
        None if experiment is None or value is None else float(value)
        for value in ((experiment.startTime, experiment.stopTime, experiment.stepSize) if experiment else (None,) * 3)
    )
    begin = start or 0.0
    stop = finite("--stop", own_stop or begin + DEFAULT_STOP_S if stop_s is None else stop_s, begin, LONGEST_S, "s")
    if not stop > begin:
        raise GivewayError("--stop", stop, f"a time in s after the start at {begin:g} s")
    step = finite(
        "--step", own_step or (stop - begin) / DEFAULT_STEPS if step_s is None else step_s, 1e-9, stop - begin, "s"
    )
    if (stop - begin) / step > MOST_ROWS:
        raise GivewayError("--step", step, f"at least {(stop - begin) / MOST_ROWS:g} s: no more than {MOST_ROWS} steps")
    return begin, stop, step


def _assigned(description: ModelDescription, assignments: list[str]) -> dict[str, float | bool | str]:
    """Checked against the bounds in the model description, before anything runs."""
    settable = {
        v.name: v for v in description.modelVariables if v.causality in ("input", "parameter", "structuralParameter")
    }
    values: dict[str, float | bool | str] = {}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise GivewayError("--set", assignment, "NAME=VALUE")
        if name not in settable:
            raise UnknownNameError("--set", name, settable)
        variable = settable[name]
        if variable.type == "Boolean":
            if text.lower() not in ("true", "false", "1", "0"):
                raise GivewayError(name, text, "true or false")
            values[name] = text.lower() in ("true", "1")
        elif variable.type in ("String", "Binary"):
            values[name] = text
        else:
            values[name] = _checked_number(variable, text)
    return values


def _checked_number(variable: Any, text: str) -> float:
    low = -math.inf if variable.min is None else float(variable.min)
    high = math.inf if variable.max is None else float(variable.max)
    whole = not variable.type.startswith(("Real", "Float"))
    unit = f" {variable.unit}" if variable.unit else ""
    allowed = f"a {'whole' if whole else 'finite'} number from {low:g} to {high:g}{unit}"
    try:
        value = float(text)
    except ValueError:
        raise GivewayError(variable.name, text, allowed) from None
    if not math.isfinite(value) or not low <= value <= high or (whole and value != int(value)):
        raise GivewayError(variable.name, text, allowed)
    return int(value) if whole else value


def write_run(out: Path, run: FmuRun) -> None:
    """Write ``out``: FILE.csv with every recorded variable, or FILE.html with a plot per unit."""
    with replace_file(out) as temporary:
        if out.suffix == ".csv":
            _write_csv(temporary, run.traces)
        else:
            temporary.write_text(_page(run), encoding="utf-8")


def _write_csv(path: Path, traces: NDArray[Any]) -> None:
    import csv

    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(traces.dtype.names or ())
        for row in traces:
            writer.writerow(value.item() if isinstance(value, np.generic) else value for value in row)


def _page(run: FmuRun) -> str:
    """One self-contained page. Variables that never change are listed, not drawn."""
    from html import escape

    from giveway.report.inline_svg import inline_svg

    moving: dict[str, list[str]] = {}
    still = []
    for name, unit in run.units.items():
        values = run.traces[name]
        if values.ndim == 1 and values.dtype.kind in "fiub" and np.any(values != values[0]):
            kind = "switches" if values.dtype == np.bool_ else unit
            moving.setdefault(kind, []).append(name)
        else:
            still.append(name)
    figures = []
    for number, (unit, names) in enumerate(sorted(moving.items())):
        shown = names[:PLOTTED_VARIABLES]
        more = f"<p>and {len(names) - len(shown)} more, in the CSV</p>" if len(names) > len(shown) else ""
        figures.append(inline_svg(_figure(run.traces, unit, shown), f"plot{number}") + more)
    title = escape(run.path.name)
    constant = ", ".join(escape(f"{name} = {run.traces[name][0]}") for name in still) or "none"
    style = "body{font-family:sans-serif;max-width:70rem;margin:2rem auto;color:#2b2f36}svg{max-width:100%;height:auto}"
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f"<style>{style}</style></head>\n"
        f"<body><h1>{title}</h1><p>{escape(run.description)}</p><p>{run.interface}, {len(run.traces)} rows, "
        f"{run.step_s:g} s apart, to {run.traces['time'][-1]:g} s.</p>\n{''.join(figures)}\n"
        f"<h2>Constant</h2><p>{constant}</p></body></html>\n"
    )


def _figure(traces: NDArray[Any], unit: str, names: list[str]) -> Any:
    from matplotlib.figure import Figure
    from matplotlib.style import context

    from giveway.report.style import STYLE

    every = max(1, len(traces) // POINTS_SHOWN)
    with context(STYLE):
        figure = Figure(figsize=(9.0, 3.2), layout="constrained")
        axes = figure.add_subplot()
        for name in names:
            values = traces[name][::every]
            axes.plot(
                traces["time"][::every],
                values.astype(float),
                label=name,
                drawstyle="steps-post" if values.dtype.kind in "bi" else None,
            )
        axes.set_xlabel("time (s)")
        axes.set_ylabel(unit or "value")
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7, ncols=1 + len(names) // 20)
    return figure
