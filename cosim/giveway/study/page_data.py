"""All that the script of a study's page is given: designs, limits, and how each of them is computed again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.report.page import packed
from giveway.study.limit_lines import DETECTION, FORCES, limits_of_metrics, unit_of
from giveway.study.page_columns import Pool, columns_of, flags_of, some_designs
from giveway.study.page_runs import runs_of
from giveway.study.quantities import columns
from giveway.study.recommended import nearest, recommended

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.base.units import WrittenUnit
    from giveway.study.answers import Answers

__all__ = ["DESIGNS_MAX", "SIZE_MAX", "page_data"]

DESIGNS_MAX = 20_000
DRAWN = tuple(f"testbed.{part}." for part in ("outline", "wheel", "bumper", "contact", "slider"))
SIZE_MAX = 4_500_000  # characters; with scripts and library the page stays below 6 MB


def page_data(answers: Answers, most: int = DESIGNS_MAX, size: int = SIZE_MAX) -> dict[str, Any]:
    """The data of at most ``most`` designs, and of no more than fit into about ``size`` characters."""
    designs = some_designs(answers, most)
    found, characters = _data_of(answers, designs)
    if characters > size:
        designs = some_designs(answers, int(0.95 * len(designs) * size / characters))
        found, _ = _data_of(answers, designs)
    return found


def _data_of(answers: Answers, designs: NDArray[np.int64]) -> tuple[dict[str, Any], int]:
    pool, chosen = Pool(), _chosen(answers)
    place = np.full(len(answers.designs), -1, dtype=np.int32)
    place[answers.order] = np.arange(len(answers.order), dtype=np.int32)
    force, time = unit_of(answers, FORCES, "N"), unit_of(answers, (DETECTION,), "ms")
    found = {
        "name": answers.setup.name,
        "total": len(answers.designs),
        "count": len(designs),
        "designs": packed(designs.astype(np.int32)),
        "flags": packed(flags_of(answers, designs)),
        "rank": packed(place[designs]),
        "columns": columns_of(answers, designs, pool),
        "warnings": pool.add_texts([answers.warning_text(int(design)) for design in designs]),
        "reasons": pool.add_texts([answers.reason.get(int(design), "") for design in designs]),
        "chosen": chosen,
        "best": answers.order[: answers.setup.chosen].tolist(),
        "chosen_words": "recommended" if len(answers.order) else "nearest to what is allowed",
        "runs": runs_of(answers, designs, pool),
        "starts": _starts(),
        "force": _shown(force) | {"limits": _limits(answers, FORCES, force)},
        "time": _shown(time) | {"limits": _limits(answers, (DETECTION,), time)},
    }
    return found | {"arrays": pool.stored}, pool.size


def _chosen(answers: Answers) -> int | None:
    """The design beside which others are shown: the recommended one, or the one nearest to what is allowed."""
    if (best := recommended(answers)) is not None:
        return best.design
    near = nearest(answers)
    return None if near is None else near.design


def _starts() -> dict[str, float]:
    """Start values of the parameters from which robot, slider and bumper are drawn."""
    known = columns()
    return {name: known.start[column].item() for name, column in known.index.items() if name.startswith(DRAWN)}


def _shown(unit: WrittenUnit) -> dict[str, Any]:
    return {"unit": unit.shown, "scale": unit.scale}


def _limits(answers: Answers, metrics: Sequence[str], unit: WrittenUnit) -> list[dict[str, Any]]:
    return [{"at": limit.at, "words": limit.words} for limit in limits_of_metrics(answers, tuple(metrics), unit)]
