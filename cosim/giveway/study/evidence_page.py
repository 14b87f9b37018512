"""Evidence as one HTML file and as CSV."""

from __future__ import annotations

import datetime
import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from giveway.base.files import replace_files
from giveway.study.advice import design_lines
from giveway.study.asked import all_asked
from giveway.study.certainty import probability_lines
from giveway.study.evidence import NOTICE, Evidence
from giveway.study.limit_lines import draw_limits, limits_of_metrics, unit_of
from giveway.study.limits import limit_words
from giveway.study.tables import number

if TYPE_CHECKING:
    from giveway.study.answers import Answers

__all__ = ["forces", "summary", "write_evidence"]

COLOURS = ("#0b64a8", "#c8500a", "#0a8a63", "#7a2ea0", "#8a6d00")
PEAK = "transient force"


def write_evidence(answers: Answers, found: Evidence) -> list[Path]:
    """Write evidence.html and evidence.csv of a design of ``answers``."""
    import jinja2
    from matplotlib.style import context

    from giveway.report.figure_data import figure_data
    from giveway.report.page import page
    from giveway.report.style import STYLE

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("giveway.report", "templates"), autoescape=True, undefined=jinja2.StrictUndefined
    )
    with context(STYLE):
        picture = figure_data(forces(answers, found))
    table = found.table
    setup = answers.setup
    body = environment.get_template("evidence.html.j2").render(
        title=f"Evidence for design {found.design} of {setup.name}",
        notice=NOTICE,
        created=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        manifest=found.answers.manifest,
        design=[*design_lines(answers, found.design), *probability_lines(answers, found.design)],
        limits=[(one.goal.metric.name, limit_words(setup, i)) for i, one in enumerate(setup.constraints)],
        summary=summary(found),
        header=list(table.columns),
        rows=[[_cell(value) for value in row] for row in table.itertuples(index=False)],
        asked=all_asked(found.answers.setup),
    )
    title = f"giveway: evidence for design {found.design} of {setup.name}"
    text = page("report", title, {"figures": [picture]}, body=body)
    html_file, listed = found.folder / "evidence.html", found.folder / "evidence.csv"
    with replace_files(html_file, listed) as (html, csv):
        html.write_text(text, encoding="utf-8")
        told = "".join(f"# {name}: {text}\n" for name, text in probability_lines(answers, found.design))
        csv.write_text(f"# {NOTICE}\n{told}{table.to_csv(index=False)}", encoding="utf-8")
    return [html_file, listed]


def _cell(value: object) -> str:
    return number(float(value)) if isinstance(value, float) else str(value)


def summary(found: Evidence) -> list[tuple[str, ...]]:
    """Speed by speed, the worst of all places and masses; first the names."""
    worst = [name for name in found.table.columns if ", worst [" in name]
    rows: list[tuple[str, ...]] = [("speed, m/s", *(name.replace(", worst [", ", ").rstrip("]") for name in worst))]
    for speed, some in found.table.groupby("speed [m/s]"):
        # NaN: unknown in one of the runs, and so is the worst.
        rows.append((number(float(speed)), *(number(float(some[name].max(skipna=False))) for name in worst)))
    return rows


def forces(answers: Answers, found: Evidence) -> Figure:
    """Peak force over speed: per mass, the worst place nominal (dashed) and within tolerances."""
    unit = unit_of(answers, (PEAK,), "N")
    figure = Figure(figsize=(9.6, 3.4))
    figure.subplots_adjust(left=0.08, right=0.985, top=0.9, bottom=0.15)
    axes = figure.subplots()
    for colour, (mass, some) in zip(COLOURS * 9, found.table.groupby("mass [kg]"), strict=False):
        by_speed = some.groupby("speed [m/s]")
        speeds = np.array(list(by_speed.groups), dtype=float)
        for kind, style in (("nominal", "--"), ("worst", "-")):
            column = f"peak force, {kind} [{unit.name}]"
            peaks = by_speed[column].max().to_numpy()
            label = f"{mass:.4g} kg, {'worst within tolerances' if kind == 'worst' else 'nominal'}"
            axes.plot(speeds, peaks, f"o{style}", color=colour, ms=4, lw=1.3, label=label)
    axes.set_xlabel("contact speed (m/s)")
    axes.set_ylabel(f"peak force ({unit.shown})")
    limits = limits_of_metrics(answers, (PEAK, "peak force of the run"), unit)
    axes.set_ylim(0.0, 1.1 * max([axes.get_ylim()[1], *(limit.at for limit in limits)]))  # no limit is left out
    draw_limits(axes, limits, "y")
    figure.legend(loc="upper left", ncols=3, fontsize=8.0)
    top = 1.0 - 0.075 * math.ceil(len(axes.lines) / 3)
    figure.subplots_adjust(top=max(0.6, top))
    return figure
