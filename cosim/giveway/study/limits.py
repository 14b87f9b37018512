"""The limits of a study: what they are called, and how far designs are from them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.base.units import WrittenUnit
    from giveway.study.answers import Answers
    from giveway.study.setup import Constraint, Setup

__all__ = ["Margin", "limit_name", "limit_of", "limit_words", "margins_of", "rooms", "shares"]


@dataclass(frozen=True)
class Margin:
    """How far a design is from a limit, in the user's unit.

    Attributes:
        name: of what is limited.
        allowed: the limit in words.
        value: of the design.
        limit: the limit itself.
        room: how much is left; negative: so far beyond.
        share: of the limit, that is left; NaN for a limit of 0.
        unit: of value, limit and room.
    """

    name: str
    allowed: str
    value: float
    limit: float
    room: float
    share: float
    unit: WrittenUnit


def limit_of(constraint: Constraint) -> float:
    """The limit in the metric's unit."""
    return constraint.maximum if math.isfinite(constraint.maximum) else constraint.minimum


def limit_name(setup: Setup, index: int) -> str:
    """What the limit is called if it is one of a body region: "transient limit of lower leg"; "" for a number."""
    stated = setup.document["constraint"][index]
    word = stated.get("maximum", stated.get("minimum"))
    judged = setup.cases[0].scenario.judged
    return f"{word} of {judged.name}" if isinstance(word, str) and judged is not None else ""


def limit_words(setup: Setup, index: int) -> str:
    """ "at most 110 N", with the limit's name where it has one."""
    one, name = setup.constraints[index], limit_name(setup, index)
    unit = f" {one.unit.shown}" if one.unit.shown else ""
    words = f"at {'most' if math.isfinite(one.maximum) else 'least'} {one.unit.of(limit_of(one)):.6g}{unit}"
    return words + (f" ({name})" if name else "")


def rooms(answers: Answers) -> NDArray[np.float64]:
    """What every design has left to every limit, in the metric's unit, shape (designs, constraints)."""
    offset, found = len(answers.setup.objectives), np.empty((len(answers.designs), len(answers.setup.constraints)))
    for index, one in enumerate(answers.setup.constraints):
        values = answers.values[:, offset + index]
        found[:, index] = one.maximum - values if math.isfinite(one.maximum) else values - one.minimum
    return found


def shares(answers: Answers) -> NDArray[np.float64]:
    """The same in shares of the limit; of a limit of 0 in the metric's unit."""
    sizes = np.array([abs(limit_of(one)) or 1.0 for one in answers.setup.constraints])
    return np.asarray(rooms(answers) / sizes)


def margins_of(answers: Answers, design: int) -> list[Margin]:
    """How far ``design`` is from every limit."""
    offset, room = len(answers.setup.objectives), rooms(answers)[design]
    found = []
    for index, one in enumerate(answers.setup.constraints):
        limit, left = limit_of(one), float(room[index])
        found.append(
            Margin(
                answers.goal_name(offset + index),
                limit_words(answers.setup, index),
                one.unit.of(float(answers.values[design, offset + index])),
                one.unit.of(limit),
                one.unit.of(left),
                left / abs(limit) if limit else math.nan,
                one.unit,
            )
        )
    return found
