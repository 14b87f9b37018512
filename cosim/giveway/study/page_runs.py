"""What the page of a study computes a design from: the settings of its nominal runs, bit for bit, and their check."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.library.work import result_columns
from giveway.report.page import packed
from giveway.scenario.plan import Rest
from giveway.study.page_columns import Pool
from giveway.study.results_table import column_of, read_part
from giveway.study.store import PARTS, list_parts

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.study.answers import Answers

__all__ = ["check_of", "checked_metrics", "runs_of"]

_OFFSET, _PRIME = 0x811C9DC5, 0x01000193  # of FNV-1a, 32 bits


def runs_of(answers: Answers, designs: NDArray[np.int64], pool: Pool) -> dict[str, Any]:
    """Method and collisions: what their runs share, what differs by design, and why a design cannot be run."""
    names = checked_metrics(answers)
    checks = _stored_checks(answers, designs, names)
    return {
        "method": answers.setup.method,
        "plant_step_s": answers.setup.plant_step_s,
        "checked": names,
        "cases": [_case(answers, number, designs, pool, checks[number]) for number in range(len(answers.setup.cases))],
    }


def _case(
    answers: Answers, number: int, designs: NDArray[np.int64], pool: Pool, checks: NDArray[np.uint32] | None
) -> dict[str, Any]:
    table = answers.runs
    rows = table.rows(designs, np.zeros_like(designs), number)
    used = rows.values[:, table.used]
    same = (used == used[:1]).all(axis=0)
    names = [table.columns.names[column] for column in table.used]
    case = table.cases[number]
    work = case.work()
    plan = work.plan[:1] if work.plan is not None and isinstance(case.case.scenario.plan, Rest) else work.plan
    refused = [rows.refused.get(at, "") for at in range(len(designs))]
    return {
        "name": case.case.name,
        "step_s": work.step_s,
        "step_count": work.steps,
        "transient_limit_n": work.transient_limit_n,
        "lasting_limit_n": work.lasting_limit_n,
        "plan": None if plan is None else pool.add(plan),
        "push": None if work.push is None else pool.add(work.push),
        "common": {name: used[0, j].item() for j, name in enumerate(names) if same[j]} if len(used) else {},
        "differing": {name: pool.add(used[:, j]) for j, name in enumerate(names) if not same[j]},
        "refused": pool.add_texts(refused) if any(refused) else None,
        "checks": None if checks is None else packed(checks.view(np.int32)),
    }


def checked_metrics(answers: Answers) -> list[str]:
    """The columns of a run that the study judges or shows, and that the library computes."""
    known = {name for name, _ in result_columns()[2:]}
    found = dict.fromkeys(name for goal in answers.goals for name in goal.metric.columns)
    return [name for name in found if name in known]


def _stored_checks(answers: Answers, designs: NDArray[np.int64], names: list[str]) -> list[NDArray[np.uint32] | None]:
    """Per collision, `check_of` the stored nominal run of each design; 0: it is not stored, or failed."""
    table, cases = answers.runs, len(answers.setup.cases)
    if not names:
        return [None] * cases
    values = np.full((cases, len(answers.designs), len(names)), np.nan)
    good = np.zeros((cases, len(answers.designs)), dtype=bool)
    for _, _, path in list_parts(answers.folder / PARTS / answers.manifest["fingerprint"][:16]):
        part = read_part(path, ["run", "status", *names])
        design, sample, case = table.split(column_of(part, "run"))
        nominal = sample == 0
        where = (case[nominal], design[nominal])
        values[where] = np.stack([column_of(part, name)[nominal] for name in names], axis=1)
        good[where] = np.array(part["status"].to_pylist())[nominal] == "ok"
    return [np.where(good[case], check_of(values[case]), 0)[designs].astype(np.uint32) for case in range(cases)]


def check_of(values: NDArray[np.float64]) -> NDArray[np.uint32]:
    """FNV-1a of the bits of each row of ``values`` (n, numbers), little endian; never 0. All NaN are one."""
    numbers = np.where(np.isnan(values), np.nan, values).astype("<f8")
    content = np.ascontiguousarray(numbers).view(np.uint8).reshape(len(values), -1)
    found = np.full(len(values), _OFFSET, dtype=np.uint32)
    for column in content.T:
        found = (found ^ column) * np.uint32(_PRIME)
    return np.maximum(found, 1)
