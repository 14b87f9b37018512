"""Output of `giveway fmu run`: every recorded variable as CSV, or a page with plots."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.files import replace_file
from giveway.fmu_tools.inputs import column_name

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.fmu_tools.run import FmuRun

__all__ = ["write_run"]

PLOTTED_VARIABLES, POINTS_SHOWN = 60, 2000
SWITCHES, COUNTS = "switches", "whole numbers"  # separate plots, in addition to those of each unit


def write_run(out: Path, run: FmuRun) -> None:
    """Write ``out``: FILE.csv with every recorded variable, or FILE.html with a plot per unit."""
    with replace_file(out) as temporary:
        if out.suffix == ".csv":
            _write_csv(temporary, run)
        else:
            temporary.write_text(_page(run), encoding="utf-8")


def _write_csv(path: Path, run: FmuRun) -> None:
    import csv

    units = {"time": "s", **run.units}
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(column_name(name, units[name]) for name in run.traces.dtype.names or ())
        for row in run.traces:
            writer.writerow(value.item() if isinstance(value, np.generic) else value for value in row)


def _page(run: FmuRun) -> str:
    """One self-contained page. Variables that are not drawn are listed: those that never change, and counters if there
    are reals."""
    import jinja2

    from giveway.report.figure_data import figure_data
    from giveway.report.page import page

    drawn, others, still = _sorted_out(run)
    figures = {unit or "no unit": _figure(run.traces, unit, names[:PLOTTED_VARIABLES]) for unit, names in drawn.items()}
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("giveway.report", "templates"), autoescape=True, undefined=jinja2.StrictUndefined
    )
    body = environment.get_template("fmu_run.html.j2").render(
        run=run,
        rows=len(run.traces),
        end_s=f"{run.traces['time'][-1]:g}",
        plots=[
            (title, max(0, len(names) - PLOTTED_VARIABLES))
            for title, names in zip(figures, drawn.values(), strict=True)
        ],
        others=", ".join(others),
        still=", ".join(f"{name} = {run.traces[name][0]}" for name in still) or "none",
    )
    found = [figure_data(figure, points_max=POINTS_SHOWN) for figure in figures.values()]
    return page("report", run.path.name, {"figures": found}, body=body)


def _sorted_out(run: FmuRun) -> tuple[dict[str, list[str]], list[str], list[str]]:
    """Drawn variables by unit (reals first, then switches and whole numbers); those not drawn; those that never change.

    Unless the user chose: whole numbers (counters, mostly) are drawn only if there is nothing else.
    """
    drawn: dict[str, list[str]] = {}
    switches: list[str] = []
    counts: list[str] = []
    others: list[str] = []
    still: list[str] = []
    for name, unit in run.units.items():
        values = run.traces[name]
        if values.ndim > 1 or not np.any(values != values[0]):
            still.append(name)
        elif run.plotted and name not in run.plotted:
            others.append(name)
        elif values.dtype.kind == "f":
            drawn.setdefault(unit, []).append(name)
        else:
            (switches if values.dtype == np.bool_ else counts).append(name)
    if not run.plotted and (drawn or switches):
        others, counts = others + counts, []
    return drawn | {kind: names for kind, names in ((SWITCHES, switches), (COUNTS, counts)) if names}, others, still


def _figure(traces: NDArray[Any], unit: str, names: list[str]) -> Any:
    from matplotlib.figure import Figure
    from matplotlib.style import context

    from giveway.report.style import STYLE

    with context(STYLE):
        figure = Figure(figsize=(9.0, 3.2), layout="constrained")
        axes = figure.add_subplot()
        for name in names:
            values = traces[name]
            axes.plot(
                traces["time"],
                values.astype(float),
                label=_label(name),
                drawstyle="steps-post" if values.dtype.kind in "biu" else None,
            )
        axes.set_xlabel("time (s)")
        axes.set_ylabel(_label(unit or "value"))
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7, ncols=1 + len(names) // 20)
    return figure


def _label(text: str) -> str:
    """Names come from the FMU: they are not interpreted as formulas, and none is hidden for its first character."""
    plain = text.replace("$", "\\$")
    return f" {plain}" if plain.startswith("_") else plain
