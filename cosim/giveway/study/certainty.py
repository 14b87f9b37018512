"""How sure the recommendation is, computed for the best designs and told in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from giveway.base.words import counted
from giveway.study import sure, tolerance_indices
from giveway.study.engine import Report
from giveway.study.tolerance_indices import TELLING

if TYPE_CHECKING:
    import pandas

    from giveway.study.answers import Answers
    from giveway.study.sure import LimitShare, Probability
    from giveway.study.tolerance_indices import Indices

__all__ = [
    "INDEX_HEADER",
    "INDEX_NOTE",
    "index_frame",
    "index_rows",
    "index_title",
    "make_sure",
    "probability_frame",
    "probability_lines",
    "probability_words",
    "recommended_indices",
]

NAME = "P(a limit is exceeded)"
METHOD_WORDS = {"subset": "subset simulation", "plain": "plain sampling"}
FEW = 4  # quantities without a rank that are named
INDEX_HEADER = ("metric", "quantity", "rank", "S1", "+-", "ST", "+-")
INDEX_NOTE = (
    "Shares of the variance that a quantity explains alone (S1) and has part in (ST), with half widths of their 95 % "
    f"intervals. Without a rank: the interval of ST begins below {TELLING:g}, so that it has nothing to say."
)


def make_sure(answers: Answers, threads: int | None = None, progress: Report | None = None) -> None:
    """Find what the study asks for of its best designs, and store it; does nothing if it asks for nothing."""
    if not sure.wanted(answers):
        return
    best = sure.best_designs(answers)
    for design in best:
        sure.probability(answers, design, threads=threads, progress=progress)
    if best and answers.setup.sure.indices and tolerance_indices.has_several_inputs(answers.setup):
        tolerance_indices.indices(answers, best[0], threads=threads, progress=progress)


def probability_words(found: Probability) -> str:
    """The probability, its interval, and what it comes from."""
    if found.value > 0.0:
        words = f"{found.value:.2g}, 95 % interval {found.low:.2g} to {found.high:.2g}"
    else:
        words = f"{_never(found.high)}: no sample exceeded it"
    words += f"; {METHOD_WORDS[found.method]}, {counted(found.samples, 'sample')}"
    if found.method == "subset" and found.plainly < found.samples:
        words += f", plainly {found.exceeded:,} of {found.plainly:,}"
    if not found.agrees:
        words += "; the plain samples contradict it: do not rely on it"
    if found.failed:
        words += f"; {found.failed:,} with failed runs, which count as exceeded"
    return words


def probability_lines(answers: Answers, design: int) -> list[tuple[str, str]]:
    """Name and text of what is stored of a design: of any limit, and of each where there are several."""
    lines = []
    for found in sure.stored(answers, design):
        lines.append((NAME, probability_words(found)))
        if len(found.limits) > 1 and found.value > 0.0:
            each = (f"{one.limit}, {one.allowed}: {_of_limit(one)}" for one in found.limits)
            lines.append((f"{NAME}, each", "; ".join(each)))
    return lines


def _of_limit(one: LimitShare) -> str:
    return f"{one.value:.2g}" if one.high is None else _never(one.high)


def _never(high: float) -> str:
    return f"below {high:.1g} (95 %)"


def recommended_indices(answers: Answers) -> Indices | None:
    """The indices that are stored of the recommended design."""
    best = sure.best_designs(answers)
    return tolerance_indices.stored_indices(answers, best[0]) if best else None


def index_title(told: Indices) -> str:
    """Title of the table of indices."""
    return f"What decides within the tolerances of design {told.design}"


def index_rows(told: Indices) -> list[tuple[str, ...]]:
    """Rows below `INDEX_HEADER`."""
    rows: list[tuple[str, ...]] = []
    for metric in dict.fromkeys(one.metric for one in told.found):
        mine = [one for one in told.found if one.metric == metric]
        for one in mine:
            if one.rank:
                numbers = (one.first, one.first_interval, one.total, one.total_interval)
                rows.append((metric, one.quantity, str(one.rank), *(f"{number:.2f}" for number in numbers)))
        if rest := [one for one in mine if not one.rank]:
            quantities = ", ".join(one.quantity for one in rest) if len(rest) < FEW else f"{len(rest)} others"
            most = max(one.total + one.total_interval for one in rest)
            rows.append(
                (
                    metric,
                    quantities,
                    "-",
                    "",
                    "",
                    f"below {most:.2f} each" if len(rest) > 1 else f"below {most:.2f}",
                    "",
                )
            )
    return rows


def probability_frame(found: Probability) -> pandas.DataFrame:
    """A line for any limit, and one for each."""
    import pandas

    told = {"method": found.method, "samples": found.samples, "runs": found.runs, "failed": found.failed}
    first: dict[str, object] = {
        "limit": "any",
        "allowed": "",
        "probability": found.value,
        "low": found.low,
        "high": found.high,
    }
    each: list[dict[str, object]] = [
        {"limit": one.limit, "allowed": one.allowed, "probability": one.value, "high": one.high} for one in found.limits
    ]
    return pandas.DataFrame([{**row, **told} for row in (first, *each)])


def index_frame(found: Indices) -> pandas.DataFrame:
    """A line per metric and uncertain quantity; rank 0: nothing is known but that the share is small."""
    import pandas

    names = ["metric", "quantity", "rank", "first", "first_interval", "total", "total_interval"]
    return pandas.DataFrame([[getattr(one, name) for name in names] for one in found.found], columns=names)
