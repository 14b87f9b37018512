"""The answers of a study as tables, for the terminal and for the report."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from giveway.base.words import counted
from giveway.study.part_rules import misfit

if TYPE_CHECKING:
    from giveway.study.answers import Answers

__all__ = [
    "MISFIT_HEADER",
    "counts",
    "design_rows",
    "goal_header",
    "misfit_rows",
    "number",
    "search_in_words",
    "sensitivity_header",
    "sensitivity_rows",
]

SHOWN = 12  # designs in the table


def number(value: float) -> str:
    """A value with four digits; "-" for what did not happen."""
    return "-" if math.isnan(value) else f"{value:.4g}"


def goal_header(answers: Answers) -> tuple[str, ...]:
    """The first line of `design_rows`."""
    quantities = [f"{one.quantity.name}{_unit(one.unit.shown)}" for one in answers.setup.varied]
    goals = [f"{answers.goal_name(j)}{_unit(answers.goal_unit(j).shown)}" for j in answers.columns]
    return ("design", *quantities, *goals, "front", *(["warnings"] if answers.warnings else []))


def _unit(unit: str) -> str:
    return f", {unit}" if unit else ""


def design_rows(answers: Answers, count: int = SHOWN) -> list[tuple[str, ...]]:
    """The best designs, in the order of the ranking."""
    rows = []
    for design in answers.order[:count]:
        pairs = zip(answers.setup.varied, answers.designs[design], strict=True)
        values = [number(one.unit.of(v)) if one.quantity.kind == "real" else one.text(v) for one, v in pairs]
        goals = [number(answers.goal_unit(j).of(answers.values[design, j])) for j in answers.columns]
        warned = [answers.warning_text(int(design))] if answers.warnings else []
        rows.append((str(design), *values, *goals, "yes" if answers.pareto[design] else "", *warned))
    return rows


def sensitivity_rows(answers: Answers) -> list[tuple[str, ...]]:
    """Every quantity's part in every objective, the largest first; last those whose intervals hold nothing but 0."""
    found = sorted(answers.sensitivities(), key=lambda one: (one.goal, not one.telling, -one.main))
    goals = [one.goal for one in found]
    units = {one.goal: answers.effect_unit(one.goal) for one in found}
    effects = answers.setup.plan.kind == "morris"
    return [
        (
            one.goal + _unit(units[one.goal].shown),
            one.quantity,
            str(place - goals.index(one.goal)) if one.telling else "-",
            f"{units[one.goal].of(one.main):.3g}",
            f"{units[one.goal].of(one.interval):.2g}",
            "-" if one.total is None else f"{units[one.goal].of(one.total):.3g}",
            *([] if effects else ["-" if one.total_interval is None else f"{one.total_interval:.2g}"]),
        )
        for place, one in enumerate(found, 1)
    ]


def sensitivity_header(answers: Answers) -> tuple[str, ...]:
    """The first line of `sensitivity_rows`."""
    effects = answers.setup.plan.kind == "morris"
    return ("objective", "quantity", "rank", *(("mu*", "+-", "sigma") if effects else ("S1", "+-", "ST", "+-")))


def search_in_words(answers: Answers) -> str:
    """How a search of the best ended; "" for designs that were not searched."""
    told = answers.manifest.get("optimum")
    if told is None:
        return ""
    if told["reason"]:
        return f"The search ended: {told['reason']}."
    return "The search has not ended: it goes on, or was interrupted."


MISFIT_HEADER = ("part", "designs", "does not fit", "for instance")


def misfit_rows(answers: Answers, count: int = SHOWN) -> list[tuple[str, ...]]:
    """Which parts do not fit and why, those with the most designs first; one row sums up those that are left out."""
    found: dict[tuple[str, str], list[tuple[int, str]]] = {}
    for design, reason in answers.reason.items():
        if (told := misfit(reason)) is not None:
            part, rule, words = told
            found.setdefault((part, rule), []).append((design, words))
    ordered = sorted(found.items(), key=lambda item: -len(item[1]))
    rows: list[tuple[str, ...]] = [
        (part, f"{len(designs):,}", rule, f"design {designs[0][0]}: {designs[0][1]}")
        for (part, rule), designs in ordered[:count]
    ]
    if left := ordered[count:]:
        rows.append((f"{len(left):,} others", f"{sum(len(designs) for _, designs in left):,}", "", ""))
    return rows


def counts(answers: Answers) -> str:
    """How many designs there are and what became of them, in one sentence."""
    done = int((answers.stored > 0).sum())
    words = counted(len(answers.designs), "design")
    if not answers.complete:
        words += f" ({done:,} begun; the study is not complete)"
    words += (
        f", {int(answers.feasible.sum()):,} meet all constraints, {int(answers.pareto.sum()):,} on the Pareto front"
    )
    unfit = sum(misfit(reason) is not None for reason in answers.reason.values())
    if unfit:
        words += f", {unfit:,} with parts that do not fit"
    failed = int((answers.failed > 0).sum()) - unfit
    if failed:
        words += f", {failed:,} with failed runs"
    if cut_off := int(answers.cut_off.sum()):
        words += f", {cut_off:,} cut off by the end of their runs"
    if answers.warnings:
        words += f", {len(answers.warnings):,} with warnings"
    return words
