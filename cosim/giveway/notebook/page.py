"""Results as HTML for notebooks: a picture, tables, warnings. Every text from outside is escaped."""

from __future__ import annotations

import base64
import functools
import io
from collections.abc import Sequence
from html import escape

from matplotlib.figure import Figure
from matplotlib.style import context

from giveway.drivetrain.analysis import Analysis
from giveway.drivetrain.analysis import table_rows as drivetrain_rows
from giveway.drivetrain.model import Drivetrain
from giveway.drivetrain.pictures import picture
from giveway.report.overview import overview
from giveway.report.style import BUMPER_LABELS, STYLE, TRUTH_COLOUR
from giveway.simulation.result import Result
from giveway.simulation.summary import (
    false_detection_line,
    preset_line,
    push_rows,
    table_rows,
    warning_lines,
)
from giveway.study import tables
from giveway.study.advice import MARGIN_HEADER, advice
from giveway.study.answers import Answers
from giveway.study.figures import axis_label

__all__ = ["html_of"]

DPI = 90
Rows = Sequence[Sequence[str]]


@functools.singledispatch
def html_of(thing: object) -> str:
    """``thing`` as HTML."""
    raise TypeError(f"{type(thing).__name__} has no page for notebooks")


@html_of.register
def _(result: Result) -> str:
    bumper = str(result.manifest["scenario"]["bumper"])
    results = {bumper: result}
    label = BUMPER_LABELS[bumper]
    hit = result.manifest["parameters"]["testbed"].get("slider.present", False)
    figure = overview({label: result}) if hit else _forces(result)
    pushes = push_rows(result)
    judged = [] if result.judgement is None else [str(result.judgement)]
    lines = [line for line in (false_detection_line(result), preset_line(results), *judged) if line]
    return _block(
        f"{result.manifest['scenario']['name']}: estimated or measured (true)",
        _image(figure, "The run"),
        _table(pushes[0], pushes[1:]) if pushes else "",
        _table(("", label), table_rows(results)),
        "".join(f"<p>{escape(line)}</p>" for line in lines),
        _warnings(warning_lines(results)),
    )


@html_of.register
def _(answers: Answers) -> str:
    first = advice(answers)
    warned = answers.warning_text(int(answers.order[0])) if len(answers.order) else ""
    return _block(
        f"{answers.setup.name}: {tables.counts(answers)}",
        _image(_designs(answers), "The designs") if len(answers.columns) else "",
        _table((first.title, ""), first.lines),
        _table(MARGIN_HEADER, first.margins) if first.margins else "",
        _table(tables.goal_header(answers), tables.design_rows(answers)),
        _warnings([warned] if warned else []),
    )


@html_of.register
def _(analysis: Analysis) -> str:
    rows = drivetrain_rows(analysis)
    return _block(
        "Linear drivetrain", _image(picture("", analysis), "Bode diagrams"), _table(("", *analysis.cases), rows)
    )


@html_of.register
def _(drivetrain: Drivetrain) -> str:
    from giveway.robot.variables import table

    variables = table("drivetrain")
    rows = [(name, f"{value:g}", variables[name].unit) for name, value in drivetrain.variables().items()]
    return _block("Drivetrain, at the wheel", _table(("", "value", "unit"), rows))


def _block(title: str, *parts: str) -> str:
    return f"<div><h4>{escape(title)}</h4>{''.join(parts)}</div>"


def _table(header: Sequence[str], rows: Rows) -> str:
    def line(cells: Sequence[str], kind: str) -> str:
        return f"<tr>{''.join(f'<{kind}>{escape(cell)}</{kind}>' for cell in cells)}</tr>"

    body = "".join(line(row, "td") for row in rows)
    return f"<table><thead>{line(header, 'th')}</thead><tbody>{body}</tbody></table>"


def _warnings(lines: Sequence[str]) -> str:
    items = "".join(f"<li>{escape(line)}</li>" for line in lines)
    return f"<p><b>Warnings</b></p><ul>{items}</ul>" if lines else ""


def _image(figure: Figure, alt: str) -> str:
    """The figure inside the page, as PNG."""
    buffer = io.BytesIO()
    with context(STYLE):
        figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    data = base64.b64encode(buffer.getvalue()).decode("ascii")
    return f'<img alt="{escape(alt)}" style="max-width: 100%" src="data:image/png;base64,{data}">'


def _forces(result: Result) -> Figure:
    """A run in which nothing collides: its pushes, and what was estimated."""
    traces = result.traces
    with context(STYLE):
        figure = Figure(figsize=(8.0, 2.6), layout="constrained")
        axes = figure.subplots()
        for name, label, colour in (
            ("testbed.push.force", "true", TRUTH_COLOUR),
            ("controller.estimate.force", "estimated", "#0b64a8"),
        ):
            x, y = (traces[f"{name}_{axis}"].values for axis in "xy")
            axes.plot(traces["time"].values, (x**2 + y**2) ** 0.5, label=label, color=colour)
        axes.set(xlabel="time (s)", ylabel="force from outside (N)")
        axes.legend()
    return figure


def _designs(answers: Answers) -> Figure:
    """All designs: the first two objectives, or the first over what varies first."""
    goals = answers.columns[:2]
    names = [axis_label(answers.goal_name(j), answers.goal_unit(j).shown) for j in goals]
    values = [answers.shown_values(j) for j in goals]
    if len(goals) == 1 and answers.setup.varied:
        first = answers.setup.varied[0]
        values.insert(0, answers.shown_designs(0))
        names.insert(0, axis_label(first.quantity.name, first.unit.shown))
    across, up = (values * 2)[:2]
    with context(STYLE):
        figure = Figure(figsize=(6.4, 3.4), layout="constrained")
        axes = figure.subplots()
        axes.plot(across, up, ".", color=TRUTH_COLOUR, label="all")
        for chosen, label, colour in (
            (answers.pareto, "on the front", "#0b64a8"),
            (answers.order[:1], "recommended", "#c8500a"),
        ):
            axes.plot(across[chosen], up[chosen], "o", color=colour, label=label)
        axes.set(xlabel=(names * 2)[0], ylabel=(names * 2)[1])
        axes.legend()
    return figure
