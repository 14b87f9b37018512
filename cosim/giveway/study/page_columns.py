"""The designs of a study as its page has them: numbers in typed columns, each stored once, however often it is used."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.report.page import packed
from giveway.study.limit_lines import limit_lines
from giveway.study.recommended import nearest, recommended

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.study.answers import Answers

__all__ = ["FEASIBLE", "FRONT", "KNOWN", "Pool", "columns_of", "flags_of", "some_designs"]

LEVELS_MAX = 256  # so many different numbers are a list and a byte for each design
FEASIBLE, FRONT, KNOWN = 1, 2, 4  # bits of `flags_of`


class Pool:
    """Arrays of numbers as texts, each with its number; equal ones are one."""

    def __init__(self) -> None:
        self.stored: list[str | dict[str, str]] = []
        self._number: dict[bytes, int] = {}

    def add(self, values: NDArray[Any]) -> int:
        """The number of ``values``: bits are kept."""
        numbers = np.ascontiguousarray(values, dtype=np.float64).ravel()
        content = numbers.tobytes()
        if content not in self._number:
            self._number[content] = len(self.stored)
            # By their bits: 0 and -0 are two levels, and NaN is one.
            levels, codes = np.unique(numbers.view(np.uint64), return_inverse=True)
            if len(levels) <= min(LEVELS_MAX, len(numbers) // 2):
                level_numbers = packed(levels.view(np.float64))
                self.stored.append({"levels": level_numbers, "codes": packed(codes.ravel().astype(np.uint8))})
            else:
                self.stored.append(packed(numbers))
        return self._number[content]

    def add_texts(self, texts: Sequence[str]) -> dict[str, Any]:
        """Texts, one per design, as a list of the different ones and the number of each."""
        different = list(dict.fromkeys(texts))
        place = {text: number for number, text in enumerate(different)}
        return {"texts": different, "codes": self.add(np.array([place[text] for text in texts], dtype=float))}

    @property
    def size(self) -> int:
        """Characters of all arrays."""
        return sum(len(one) if isinstance(one, str) else sum(map(len, one.values())) for one in self.stored)


def some_designs(answers: Answers, most: int) -> NDArray[np.int64]:
    """All designs; of more than ``most`` the best half as many, those that the text names, and a sample of the rest."""
    count = len(answers.designs)
    if count <= most:
        return np.arange(count, dtype=np.int64)
    kept = np.zeros(count, dtype=bool)
    kept[answers.order[: most // 2]] = True
    kept[_named(answers)] = True
    others = np.flatnonzero(~kept)
    left = max(0, most - int(kept.sum()))
    kept[np.random.default_rng(1).choice(others, left, replace=False)] = True  # the same every time
    return np.flatnonzero(kept)


def _named(answers: Answers) -> list[int]:
    if (best := recommended(answers)) is not None:
        tempting = [] if best.tempting is None else [best.tempting]
        return [best.design, *tempting, *best.following]
    near = nearest(answers)
    return [] if near is None else [near.design, *(design for _, design in near.never)]


def columns_of(answers: Answers, designs: NDArray[np.int64], pool: Pool) -> list[dict[str, Any]]:
    """Quantities, then goals: values in our own units, ``scale`` to the unit that is shown, limits in that one."""
    found: list[dict[str, Any]] = []
    for j, one in enumerate(answers.setup.varied):
        found.append(
            {
                "label": one.quantity.name.removeprefix("testbed."),
                "unit": one.unit.shown,
                "scale": one.unit.scale if one.quantity.kind == "real" else 1.0,
                "role": "quantity",
                "kind": one.quantity.kind,
                "choices": list(one.quantity.choices),
                "log": one.spread is not None and one.spread.kind == "loguniform",
                "sense": 0,
                "limits": [],
                "values": pool.add(answers.designs[designs, j]),
            }
        )
    objectives, constraints = len(answers.setup.objectives), len(answers.setup.constraints)
    for j in answers.columns:
        role = "objective" if j < objectives else "constraint" if j < objectives + constraints else "shown"
        found.append(
            {
                "label": answers.goal_name(j),
                "unit": answers.goal_unit(j).shown,
                "scale": answers.goal_unit(j).scale,
                "role": role,
                "kind": "real",
                "choices": [],
                "log": False,
                "sense": answers.goals[j].sense if role == "objective" else 0,
                "limits": [{"at": limit.at, "words": limit.words} for limit in limit_lines(answers, j)],
                "values": pool.add(answers.values[designs, j]),
            }
        )
    return found


def flags_of(answers: Answers, designs: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Per design, which of the words apply: `FEASIBLE`, `FRONT`, `KNOWN` (all of its runs are stored)."""
    flags = np.zeros(len(designs), dtype=np.uint8)
    known = answers.stored == answers.runs.per_design
    for bit, which in ((FEASIBLE, answers.feasible), (FRONT, answers.pareto), (KNOWN, known)):
        flags[which[designs]] |= bit
    return flags
