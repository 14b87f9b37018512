"""The reproduction as one self-contained HTML file: the table, then figure and paper's numbers side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.base import native
from giveway.base.files import write_text
from giveway.experiments.reproduction.findings import CLASSES, PROVENANCES
from giveway.experiments.reproduction.reproduce import number
from giveway.paper.printed import NOT_JUDGED
from giveway.report.figure_data import figure_data
from giveway.report.page import page
from giveway.report.style import STYLE
from giveway.robot.robot_file import read_robot

if TYPE_CHECKING:
    from giveway.experiments.reproduction.findings import Row
    from giveway.experiments.reproduction.reproduce import Reproduction
    from giveway.robot.robot_file import Entry

__all__ = ["render", "write_report"]

VERDICTS = {True: "met", False: "missed", None: ""}


@dataclass(frozen=True)
class _Line:
    """A row as the page shows it."""

    quantity: str
    paper: str
    ours: str
    target: str
    verdict: str
    kind: str
    provenance: str
    reason: str


def write_report(path: Path, reproduction: Reproduction) -> None:
    """Write the report to ``path``, atomically."""
    write_text(path, render(reproduction))


def render(reproduction: Reproduction) -> str:
    """The report as HTML text; it has no external references."""
    import jinja2
    from matplotlib.style import context

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("giveway.report", "templates"), autoescape=True, undefined=jinja2.StrictUndefined
    )
    pictures = [
        (chapter.experiment.name, picture.name, picture.figure)
        for chapter in reproduction.chapters
        for picture in chapter.findings.pictures
    ]
    with context(STYLE):
        figures = [figure_data(figure) for _, _, figure in pictures]
    body = environment.get_template("reproduction.html.j2").render(
        chapters=reproduction.chapters,
        lines={
            chapter.experiment.name: [_line(row) for row in chapter.findings.rows] for chapter in reproduction.chapters
        },
        drawings={(experiment, name): index for index, (experiment, name, _) in enumerate(pictures)},
        summary=list(zip(reproduction.summary(), CLASSES.values(), strict=True)),
        not_judged=NOT_JUDGED,
        interrupted=reproduction.interrupted,
        manifest=reproduction.manifest,
        parameters=_parameters(),
    )
    return page("report", "giveway: the paper, reproduced", {"figures": figures}, body=body)


def _line(row: Row) -> _Line:
    unit = "" if row.unit == "1" else f" {row.unit}"

    def cell(value: float | str | None) -> str:
        return number(value, row.decimals) + (unit if isinstance(value, float | int) else "")

    target = "" if row.target is None else f"{row.target.text}{unit}"
    verdict = VERDICTS[row.met]
    return _Line(row.quantity, cell(row.papers), cell(row.ours), target, verdict, row.kind, row.provenance, row.reason)


def _parameters() -> Sequence[tuple[str, list[tuple[str, Entry]]]]:
    """The robot file's entries by provenance, in the order of `PROVENANCES`."""
    robot = read_robot(native.robot())
    found = [
        (provenance, [(name, entry) for name, entry in robot.entries() if entry.provenance == provenance])
        for provenance in PROVENANCES
    ]
    return [(provenance, entries) for provenance, entries in found if entries]
