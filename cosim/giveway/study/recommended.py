"""Which design to build: what limits it, what comes next; and if none is allowed, which one is nearest to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.scenario.scenario import BUMPERS
from giveway.scenario.stated_bumper import acts
from giveway.study.answers import costs_of, whole
from giveway.study.limits import rooms, shares
from giveway.study.quantities import columns

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.study.answers import Answers
    from giveway.study.distributions import Varied

__all__ = ["Nearest", "Recommended", "at_an_end", "nearest", "recommended"]

END = 0.005  # of a range: what is so near to its end is at its end


@dataclass(frozen=True)
class Recommended:
    """The best design of a ranking.

    Attributes:
        design: its number.
        tempting: the design nearest to what is allowed that is nowhere worse and somewhere better, but for the limits
            that it breaks; None: no limit keeps a better design out.
        broken: which limits that one breaks.
        barred: how many such designs there are.
        ends: quantities that decide something and are at an end of their range: index, and whether the upper one.
        following: the next best designs: of all, and of those with other parts, if that is another one.
    """

    design: int
    tempting: int | None
    broken: tuple[int, ...]
    barred: int
    ends: tuple[tuple[int, bool], ...]
    following: tuple[int, ...]


@dataclass(frozen=True)
class Nearest:
    """If no design is allowed.

    Attributes:
        design: the one whose largest step beyond a limit, as a share of that limit, is the smallest.
        worst: that limit.
        never: limits that no design meets, each with the design that comes nearest to it.
    """

    design: int
    worst: int
    never: tuple[tuple[int, int], ...]


def recommended(answers: Answers) -> Recommended | None:
    """The best ranked design; None if no design is allowed, or nothing says which is better."""
    if not len(answers.order) or not answers.setup.objectives:
        return None
    design = int(answers.order[0])
    costs, mine = costs_of(answers.setup, answers.values), costs_of(answers.setup, answers.values)[design]
    better = _judged(answers) & (costs <= mine).all(axis=1) & (costs < mine).any(axis=1) & ~answers.feasible
    tempting: int | None = None
    broken: tuple[int, ...] = ()
    barred = np.flatnonzero(better)
    if barred.size:
        left = shares(answers)[barred]
        beyond = np.maximum(-left, 0.0).max(axis=1)
        tempting = int(barred[np.lexsort((beyond, (left < 0.0).sum(axis=1)))[0]])
        broken = tuple(np.flatnonzero(rooms(answers)[tempting] < 0.0).tolist())
    ends = [at_an_end(one, value) for one, value in zip(answers.setup.varied, answers.designs[design], strict=True)]
    law = _law(answers, design)
    found = tuple(
        (index, end)
        for index, (one, end) in enumerate(zip(answers.setup.varied, ends, strict=True))
        if end is not None and _decides(one, law)
    )
    return Recommended(design, tempting, broken, len(barred), found, _following(answers))


def nearest(answers: Answers) -> Nearest | None:
    """The design nearest to what is allowed; None if one is allowed, or none ran with everything that is judged."""
    candidates = np.flatnonzero(_judged(answers))
    if len(answers.order) or not answers.setup.constraints or not candidates.size:
        return None
    left, all_rooms = shares(answers), rooms(answers)
    beyond = np.maximum(-left[candidates], 0.0).max(axis=1)
    design = int(candidates[np.argmin(beyond)])
    never = tuple(
        (index, int(candidates[np.argmax(left[candidates, index])]))
        for index in range(left.shape[1])
        if (all_rooms[candidates, index] < 0.0).all()
    )
    return Nearest(design, int(np.argmin(left[design])), never)


def _judged(answers: Answers) -> NDArray[np.bool_]:
    """All runs are there, none failed or was cut off, and all objectives and limits have a value."""
    count = len(answers.setup.objectives) + len(answers.setup.constraints)
    found = whole(answers.runs.per_design, answers.stored, answers.failed, answers.cut_off)
    return np.asarray(found & ~np.isnan(answers.values[:, :count]).any(axis=1))


def _following(answers: Answers) -> tuple[int, ...]:
    """The second of the ranking, and the first one with other parts."""
    order = answers.order
    if len(order) < 2:
        return ()
    parts = [j for j, one in enumerate(answers.setup.varied) if one.parts is not None]
    other = order[(answers.designs[order][:, parts] != answers.designs[order[0]][parts]).any(axis=1)]
    return tuple(dict.fromkeys([int(order[1]), *other[:1].tolist()]))


def _law(answers: Answers, design: int) -> str:
    """Of the design's bumper."""
    row = answers.runs.rows(np.array([design]), np.array([0]), 0).values[0]
    return list(BUMPERS)[int(row[columns().index["testbed.bumper.kind"]])]


def _decides(one: Varied, law: str) -> bool:
    """Whether a design with a bumper of this law is another one with another value."""
    names = [columns().names[column].removeprefix("testbed.") for column in one.columns]
    return not names or any(acts(law, name) for name in names)


def at_an_end(one: Varied, value: float) -> bool | None:
    """Whether ``value`` is at the upper (True) or lower (False) end of what was asked; None: at neither."""
    if one.quantity.kind not in ("real", "integer"):
        return None
    if one.spread is not None:
        low, high = one.spread.low, one.spread.high
    elif len(one.levels) > 1:
        low, high = min(one.levels), max(one.levels)
    else:
        return None
    at = (value - low) / (high - low) if high > low else 0.5
    return False if at <= END else True if at >= 1.0 - END else None
