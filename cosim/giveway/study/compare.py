"""Two studies side by side: what was asked of them otherwise, what they recommend, and the margins."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from giveway.study.advice import advice, design_lines
from giveway.study.asked import all_asked
from giveway.study.certainty import probability_lines
from giveway.study.limits import Margin, margins_of
from giveway.study.recommended import nearest, recommended
from giveway.study.tables import number

if TYPE_CHECKING:
    import pandas

    from giveway.study.answers import Answers

__all__ = ["ASKED_HEADER", "MARGIN_HEADER", "RECOMMENDED_HEADER", "Comparison", "compare"]

ASKED_HEADER = ("asked", "A", "B")
RECOMMENDED_HEADER = ("recommended", "A", "B", "B against A")
MARGIN_HEADER = ("limit", "allowed A", "margin A", "%", "allowed B", "margin B", "%")
NOTHING = "-"


@dataclass(frozen=True)
class Comparison:
    """Studies A and B.

    Attributes:
        names: of both.
        designs: which design each recommends; None: none, and the nearest one is compared.
        titles: the recommendation of each in a line.
        asked: what differs in what was asked: name, text of A, text of B.
        recommended: what both designs are made of and reach, and what is known of their P(a limit is exceeded): name,
            text of A, text of B, B against A.
        margins: by limit, of A and of B; None: not limited there.
    """

    names: tuple[str, str]
    designs: tuple[int | None, int | None]
    titles: tuple[str, str]
    asked: list[tuple[str, str, str]]
    recommended: list[tuple[str, str, str, str]]
    margins: list[tuple[str, Margin | None, Margin | None]]

    def margin_rows(self) -> list[tuple[str, ...]]:
        """Rows below `MARGIN_HEADER`."""
        return [(name, *_margin_cells(a), *_margin_cells(b)) for name, a, b in self.margins]

    def table(self) -> pandas.DataFrame:
        """Recommended designs and margins, one line each: columns "A" and "B"."""
        import pandas

        rows = {name: (a, b) for name, a, b, _ in self.recommended}
        rows |= {f"margin of {name}": (_margin_cells(a)[1], _margin_cells(b)[1]) for name, a, b in self.margins}
        return pandas.DataFrame.from_dict(rows, orient="index", columns=["A", "B"])

    def document(self) -> dict[str, Any]:
        """Everything, as JSON has it; margins are numbers in the unit beside them."""
        pairs = zip(self.names, self.designs, self.titles, strict=True)
        return {
            "studies": [{"name": name, "design": design, "title": title} for name, design, title in pairs],
            "asked": [dict(zip(("name", "A", "B"), row, strict=True)) for row in self.asked],
            "recommended": [dict(zip(("name", "A", "B", "change"), row, strict=True)) for row in self.recommended],
            "margins": [{"name": name, "A": _numbers(a), "B": _numbers(b)} for name, a, b in self.margins],
        }


def compare(a: Answers, b: Answers) -> Comparison:
    """Compare what two studies were asked, what they recommend (or what is nearest to being allowed), and why."""
    one, other = _side(a), _side(b)
    asked = [
        (name, one.asked.get(name, NOTHING), other.asked.get(name, NOTHING)) for name in {**one.asked, **other.asked}
    ]
    rows = [
        (name, one.lines.get(name, NOTHING), other.lines.get(name, NOTHING), _change(one, other, name))
        for name in {**one.lines, **other.lines}
    ]
    return Comparison(
        (a.setup.name, b.setup.name),
        (one.design, other.design),
        (one.title, other.title),
        [row for row in asked if row[1] != row[2]],
        rows,
        [(name, one.margins.get(name), other.margins.get(name)) for name in {**one.margins, **other.margins}],
    )


@dataclass(frozen=True)
class _Side:
    """One of the studies: what `Comparison` has of it, by name; ``reached``: value and own unit of objectives."""

    design: int | None
    title: str
    asked: dict[str, str]
    lines: dict[str, str]
    margins: dict[str, Margin]
    reached: dict[str, tuple[float, str]]


def _side(answers: Answers) -> _Side:
    asked: dict[str, str] = {}
    for name, text in all_asked(answers.setup):
        asked[name] = f"{asked[name]}; {text}" if name in asked else text
    best, near = recommended(answers), nearest(answers)
    title = advice(answers).title
    if best is None and near is None:
        return _Side(None, title, asked, {}, {}, {})
    design = best.design if best is not None else near.design if near is not None else 0
    reached = {
        answers.goal_name(i): (float(answers.values[design, i]), answers.goals[i].metric.unit)
        for i in range(len(answers.setup.objectives))
    }
    margins = {f"{one.name}, {one.allowed[:8]}": one for one in margins_of(answers, design)}  # at most, at least
    title += f": design {design}" if best is None else ""
    lines = dict([*design_lines(answers, design), *probability_lines(answers, design)[:1]])
    return _Side(design if best is not None else None, title, asked, lines, margins, reached)


def _change(one: _Side, other: _Side, name: str) -> str:
    """What B has more than A, in % of A, of an objective that both have."""
    (old, unit), (new, its) = (side.reached.get(name, (math.nan, "")) for side in (one, other))
    return f"{100.0 * (new - old) / abs(old):+.3g} %" if unit == its and old and math.isfinite(new - old) else ""


def _margin_cells(margin: Margin | None) -> tuple[str, str, str]:
    if margin is None:
        return NOTHING, NOTHING, NOTHING
    share = NOTHING if math.isnan(margin.share) else f"{100.0 * margin.share:.3g}"
    return margin.allowed, f"{number(margin.room)} {margin.unit.shown}".rstrip(), share


def _numbers(margin: Margin | None) -> dict[str, Any] | None:
    if margin is None:
        return None
    share = None if math.isnan(margin.share) else margin.share
    return {"allowed": margin.allowed, "value": margin.value, "limit": margin.limit, "margin": margin.room,
            "share": share, "unit": margin.unit.name}  # fmt: skip
