"""The recommendation in words, for the terminal and for the report."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.words import counted
from giveway.study.certainty import probability_lines
from giveway.study.limits import Margin, limit_words, margins_of
from giveway.study.recommended import Recommended, nearest, recommended
from giveway.study.tables import number

if TYPE_CHECKING:
    from giveway.study.answers import Answers
    from giveway.study.distributions import Varied

__all__ = ["MARGIN_HEADER", "Advice", "advice", "design_lines"]

NAMED = 8  # designs that a line names
MARGIN_HEADER = ("limit", "allowed", "has", "margin", "margin, %")


@dataclass(frozen=True)
class Advice:
    """What to build.

    Attributes:
        title: "Recommended: design 17".
        lines: name and text of what it is made of, what it reaches, what limits it, what comes next.
        margins: rows below `MARGIN_HEADER`.
    """

    title: str
    lines: list[tuple[str, str]]
    margins: list[tuple[str, ...]]


def advice(answers: Answers) -> Advice:
    """Which design to build and why; or which one is nearest to what is allowed."""
    so_far = "" if answers.complete else " so far"
    if not answers.setup.objectives:
        words = "the study has no objective, so no design is better than another one"
        return Advice("No design is recommended", [("why", words)], [])
    if (found := recommended(answers)) is not None:
        sure = probability_lines(answers, found.design)
        why = [*_limited(answers, found), *_following(answers, found), *_cut_off(answers)]
        lines = [*design_lines(answers, found.design), *sure, *why]
        return Advice(f"Recommended{so_far}: design {found.design}", lines, _margin_rows(answers, found.design))
    cut_off = _cut_off(answers)
    title = "No design is recommended" if cut_off else "No design meets all constraints"
    title += so_far
    if (near := nearest(answers)) is None:
        if cut_off:
            return Advice(title, cut_off, [])
        return Advice(title, [("why", "no design has a value for every objective and constraint")], [])
    missed = margins_of(answers, near.design)[near.worst]
    lines = [
        (
            "nearest",
            f"design {near.design}: {missed.name}, {missed.allowed}, is missed by {_room(-missed.room, missed)}",
        ),
        *design_lines(answers, near.design),
    ]
    for index, design in near.never:
        one = margins_of(answers, design)[index]
        has = f"the nearest one, design {design}, has {_valued(one.value, one.unit.shown)}"
        lines.append(("met by no design", f"{one.name}, {one.allowed}: {has}"))
    return Advice(title, [*lines, *cut_off], _margin_rows(answers, near.design))


def design_lines(answers: Answers, design: int) -> list[tuple[str, str]]:
    """What a design is made of, and what it reaches in every objective."""
    lines = []
    for one, value in zip(answers.setup.varied, answers.designs[design], strict=True):
        text = one.parts.words(int(value)) if one.parts is not None else _quantity(one, float(value))
        lines.append((one.quantity.name, text))
    for index in range(len(answers.setup.objectives)):
        unit = answers.goal_unit(index)
        lines.append((answers.goal_name(index), _valued(unit.of(float(answers.values[design, index])), unit.shown)))
    return lines


def _quantity(one: Varied, value: float) -> str:
    real = one.quantity.kind == "real"
    return _valued(one.unit.of(value), one.unit.shown) if real else one.text(value)


def _valued(value: float, unit: str) -> str:
    return number(value) + (f" {unit}" if unit else "")


def _room(room: float, margin: Margin) -> str:
    share = "" if math.isnan(margin.share) else f" ({abs(100.0 * margin.share):.3g} %)"
    return _valued(room, margin.unit.shown) + share


def _margin_rows(answers: Answers, design: int) -> list[tuple[str, ...]]:
    """How far the design is from every limit, the nearest one first."""
    found = sorted(margins_of(answers, design), key=lambda one: math.inf if math.isnan(one.share) else one.share)
    return [
        (
            one.name,
            one.allowed,
            _valued(one.value, one.unit.shown),
            _valued(one.room, one.unit.shown),
            "-" if math.isnan(one.share) else f"{100.0 * one.share:.3g}",
        )
        for one in found
    ]


def _limited(answers: Answers, found: Recommended) -> list[tuple[str, str]]:
    """What keeps the design from being better: limits, and ends of ranges."""
    setup, offset = answers.setup, len(answers.setup.objectives)
    lines: list[tuple[str, str]] = []
    if found.tempting is not None:
        limits = [f"{answers.goal_name(offset + i)}, {limit_words(setup, i)}" for i in found.broken]
        would = f"{counted(found.barred, 'design')} would be better but for the constraints, the nearest to them is"
        changes = "; ".join(_changes(answers, found.tempting, found.design))
        lines.append(("limited by", f"{' and '.join(limits)}: {would} design {found.tempting}: {changes}"))
    elif setup.constraints:
        goals = answers.values[answers.pareto][:, :offset]
        others = int((goals != answers.values[found.design, :offset]).any(axis=1).sum())
        equal = len(goals) - 1 - others
        rest = "".join(
            f"; {counted(count, 'design')} on the front {'is' if count == 1 else 'are'} {how} of them"
            for count, how in ((others, "better in some"), (equal, "equal in all"))
            if count
        )
        lines.append(("limited by", f"no constraint: no design that breaks one is better in all objectives{rest}"))
    for index, upper in found.ends:
        one = setup.varied[index]
        value = _quantity(one, float(answers.designs[found.design, index]))
        end = "highest" if upper else "lowest"
        lines.append(("limited by", f"the {end} {one.quantity.name} of this study, {value}"))
    return lines


def _cut_off(answers: Answers) -> list[tuple[str, str]]:
    """Which designs are not judged because a run was over before its contact."""
    designs = np.flatnonzero(answers.cut_off).tolist()
    if not designs:
        return []
    named = ", ".join(map(str, designs[:NAMED])) + (", ..." if len(designs) > NAMED else "")
    words = (
        f"{counted(len(designs), 'design')} ({named}) cannot be judged: a run ended before its contact was over, and "
        "what it measured may have been still growing; give scenario.duration more than "
        f"{answers.setup.cases[0].scenario.duration_s:g} s"
    )
    return [("cut off", words)]


def _following(answers: Answers, found: Recommended) -> list[tuple[str, str]]:
    """The next best designs, and why they are not recommended."""
    lines = []
    for place, design in enumerate(found.following):
        name = "next best" if place == 0 else "next best with other parts"
        changes = _changes(answers, design, found.design)
        words = f"design {design}: {'; '.join(changes) or 'the same in all objectives'}"
        if parts := _other_parts(answers, design, found.design):
            words += f"; {parts}"
        if answers.pareto[design] and changes:
            far = f"{number(float(answers.score[design]))} instead of {number(float(answers.score[found.design]))}"
            words += f"; farther from the best of all objectives, {far} widths of the front"
        for _, sure in probability_lines(answers, design)[:1]:
            words += f"; a limit is exceeded with P {sure}"
        lines.append((name, words))
    return lines


def _other_parts(answers: Answers, design: int, than: int) -> str:
    """Parts that ``design`` has and ``than`` has not."""
    return ", ".join(
        f"{one.quantity.name} {one.text(answers.designs[design, j])}"
        for j, one in enumerate(answers.setup.varied)
        if one.parts is not None and answers.designs[design, j] != answers.designs[than, j]
    )


def _changes(answers: Answers, design: int, than: int) -> list[str]:
    """What ``design`` loses and what it gains, objective by objective."""
    worse: list[str] = []
    better: list[str] = []
    for index, goal in enumerate(answers.setup.objectives):
        unit, new, old = answers.goal_unit(index), answers.values[design, index], answers.values[than, index]
        if new == old:
            continue
        share = f" ({_percent(100.0 * (new - old) / abs(old))})" if old else ""
        values = _instead(unit.of(float(new)), unit.of(float(old))) + (f" {unit.shown}" if unit.shown else "")
        (worse if goal.sense * (new - old) > 0 else better).append(f"{goal.metric.name} {values}{share}")
    return [f"{word} {', '.join(some)}" for word, some in (("loses:", worse), ("gains:", better)) if some]


def _percent(share: float) -> str:
    """Two digits, or all before the point."""
    return f"{share:+.2g} %" if abs(share) < 99.5 else f"{share:+,.0f} %"


def _instead(new: float, old: float) -> str:
    """Both values with as many digits as tell them apart."""
    digits = next((digits for digits in range(4, 16) if f"{new:.{digits}g}" != f"{old:.{digits}g}"), 17)
    return f"{new:.{digits}g} instead of {old:.{digits}g}"
