"""The summary of a study: one HTML file that opens without a network."""

from __future__ import annotations

import datetime
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from giveway.base.files import write_text
from giveway.report.figures import NamedFigure
from giveway.study.advice import MARGIN_HEADER, advice
from giveway.study.asked import all_asked
from giveway.study.part_rules import misfit
from giveway.study.tables import search_in_words

if TYPE_CHECKING:
    from markupsafe import Markup
    from matplotlib.figure import Figure

    from giveway.study.answers import Answers

__all__ = ["write_report"]

REASONS_MAX, DESIGNS_MAX = 8, 25
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def write_report(path: Path, answers: Answers) -> None:
    """Write the summary of ``answers`` to ``path``."""
    import jinja2

    from giveway.report.page import page
    from giveway.simulation.metrics import definitions
    from giveway.study import certainty, tables
    from giveway.study.page_data import page_data

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("giveway.report", "templates"), autoescape=True, undefined=jinja2.StrictUndefined
    )
    environment.filters["breakable"] = _breakable
    setup, told = answers.setup, certainty.recommended_indices(answers)
    known = bool((answers.stored > 0).any())
    figures = _figures(answers)
    data = page_data(answers) if known else {}
    body = environment.get_template("study.html.j2").render(
        title=setup.name,
        counts=tables.counts(answers),
        advice=advice(answers),
        margin_header=MARGIN_HEADER,
        complete=answers.complete,
        manifest=answers.manifest,
        created=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        known=known,
        in_page=_in_page(data),
        header=[_breakable(name) for name in tables.goal_header(answers)],
        rows=tables.design_rows(answers, DESIGNS_MAX),
        definitions=definitions(goal.metric.column for goal in answers.goals),
        ranked=len(answers.order),
        figures=figures,
        sensitivity_header=tables.sensitivity_header(answers),
        sensitivities=tables.sensitivity_rows(answers),
        unknown=answers.sensitivities().reason,
        asked=all_asked(setup),
        index_title="" if told is None else certainty.index_title(told),
        index_header=certainty.INDEX_HEADER,
        index_note=certainty.INDEX_NOTE,
        index_rows=[] if told is None else certainty.index_rows(told),
        index_reason="" if told is None else told.reason,
        misfit_header=tables.MISFIT_HEADER,
        misfits=tables.misfit_rows(answers, DESIGNS_MAX),
        reasons=_reasons({design: text for design, text in answers.reason.items() if misfit(text) is None}),
        warnings=_warnings(answers.warnings),
    )
    drawn = {"figures": [figure.data for figure in figures]}
    write_text(path, page("study", f"giveway study: {setup.name}", drawn | data, body=body, engine=known))


def _in_page(data: Mapping[str, Any]) -> str:
    """Which designs of a large study the page has."""
    if not data or data["count"] == data["total"]:
        return ""
    return (
        f"This page has {data['count']:,} of {data['total']:,} designs: the best ranked, those that the text names, "
        "and a sample of the others."
    )


def _reasons(reason: Mapping[int, str]) -> list[tuple[str, list[int]]]:
    """The most frequent reasons, each in the words of its first design; those that differ in numbers are one."""
    found: dict[str, tuple[str, list[int]]] = {}
    for design, text in reason.items():
        found.setdefault(_NUMBER.sub("#", text), (text, []))[1].append(design)
    return sorted(found.values(), key=lambda item: -len(item[1]))[:REASONS_MAX]


def _warnings(warnings: Mapping[int, Mapping[str, int]]) -> list[tuple[str, str, list[int]]]:
    """Each code with what it means and the designs that have it, the most frequent first."""
    from giveway.simulation.run_warnings import MEANINGS

    found: dict[str, list[int]] = {}
    for design in sorted(warnings):
        for code in warnings[design]:
            found.setdefault(code, []).append(design)
    return sorted(((code, MEANINGS[code], designs) for code, designs in found.items()), key=lambda one: -len(one[2]))


def _breakable(name: str) -> Markup:
    """A name that a narrow column may break where a reader would."""
    from markupsafe import Markup, escape

    return Markup(re.sub(r"([._])(?=\w)", r"\1<wbr>", str(escape(name))))


def _figures(answers: Answers) -> list[NamedFigure]:
    """How a search went, and what decides: the page's script draws the designs themselves."""
    from matplotlib.style import context

    from giveway.report.figure_data import figure_data
    from giveway.report.style import STYLE
    from giveway.study import figures

    found: list[NamedFigure] = []

    def add(title: str, caption: str, figure: Figure | None) -> None:
        if figure is not None:
            found.append(NamedFigure(title, caption, figure_data(figure)))

    with context(STYLE):
        if optimum := answers.manifest.get("optimum"):
            add("How the search went", _search_caption(answers, optimum), figures.growth(answers))
        if bool((answers.stored > 0).any()):
            add("What decides", _sensitivity_caption(answers), figures.sensitivities(answers))
    return found


def _search_caption(answers: Answers, told: Mapping[str, Any]) -> str:
    """What the hypervolume's figure shows."""
    reference = ", ".join(
        f"{answers.goals[index].metric.name} {answers.goal_unit(index).of(value):.4g} {answers.goal_unit(index).shown}"
        for index, value in enumerate(told["reference"] or ())
    )
    return f"One point per generation; reference point: {reference}. {search_in_words(answers)}"


def _sensitivity_caption(answers: Answers) -> str:
    if answers.setup.plan.kind == "morris":
        return "Elementary effects (Morris) in the objective's unit: mean of the absolute values, and spread."
    return "Share of the variance of each objective that a quantity alone explains, and in which it has part."
