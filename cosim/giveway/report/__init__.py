"""One self-contained HTML file per report: table, figures (inline SVG), and a top-view animation."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.base.files import write_text
from giveway.report.style import BUMPER_LABELS

if TYPE_CHECKING:
    from giveway.simulation.result import Result

__all__ = ["BUMPER_LABELS", "render", "write_picture", "write_report"]


def write_report(path: Path, title: str, summary: str, results: Sequence[Result]) -> None:
    """Write the report of ``results`` (one per bumper) to ``path``, atomically."""
    write_text(path, render(title, summary, results))


def write_picture(path: Path, results: Sequence[Result]) -> None:
    """Write a PNG that shows ``results`` (one per bumper) at a glance."""
    from giveway.report.overview import write_overview

    write_overview(path, {BUMPER_LABELS[result.manifest["scenario"]["bumper"]]: result for result in results})


def render(title: str, summary: str, results: Sequence[Result]) -> str:
    """The report as HTML text; it has no external references. ``summary`` is a sentence below the title."""
    import jinja2

    from giveway.report import pushes
    from giveway.report.animation import motion, scene
    from giveway.report.figures import figures
    from giveway.report.page import page
    from giveway.simulation.metrics import definitions
    from giveway.simulation.summary import false_detection_line, preset_line, push_rows, table_rows, warning_lines

    by_bumper = {result.manifest["scenario"]["bumper"]: result for result in results}
    hit = {
        BUMPER_LABELS[bumper]: result
        for bumper, result in by_bumper.items()
        if result.manifest["parameters"]["testbed"]["slider.present"]
    }
    drawn = [figure for result in results for figure in pushes.figures(result)] + (figures(hit) if hit else [])
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("giveway.report", "templates"), autoescape=True, undefined=jinja2.StrictUndefined
    )
    scenes = [motion(scene(BUMPER_LABELS[bumper], result)) for bumper, result in by_bumper.items()]
    body = environment.get_template("report.html.j2").render(
        title=title,
        summary=" ".join(filter(None, (summary, preset_line(by_bumper)))),
        header=[BUMPER_LABELS[bumper] for bumper in by_bumper],
        rows=table_rows(by_bumper),
        definitions=definitions(metric.name for metric in results[0].metrics),
        judgements=[str(result.judgement) for result in results if result.judgement is not None],
        warnings=warning_lines(by_bumper),
        pushes=[(push_rows(result), false_detection_line(result)) for result in results if result.pushes],
        figures=drawn,
        manifest=results[0].manifest,
        runs=[result.manifest for result in results],
    )
    data = {"figures": [figure.data for figure in drawn], "scenes": scenes}
    return page("report", f"giveway: {title}", data, body=body)
