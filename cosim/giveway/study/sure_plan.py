"""How sure a recommendation is made: the table ``[sure]`` of a study file."""

from __future__ import annotations

from dataclasses import dataclass

from giveway.base.checks import whole
from giveway.base.toml_sections import Section

__all__ = ["METHODS", "SURE", "SurePlan", "checked_runs", "sure_plan_of"]

SURE = ("probability", "method", "runs", "designs", "indices")
METHODS = ("subset", "plain")
RUNS_MIN, RUNS_MAX, DESIGNS_MAX, INDICES_MAX = 1000, 20_000_000, 20, 1_000_000


@dataclass(frozen=True)
class SurePlan:
    """What is computed of the best designs.

    Attributes:
        probability: how probable it is that a limit is exceeded.
        method: "subset" simulation, which goes towards the limits, or "plain" sampling.
        runs: at most so many samples of the tolerances for each design.
        designs: how many of the best.
        indices: base samples of the Sobol' indices of the recommended design; 0: none.
    """

    probability: bool = True
    method: str = METHODS[0]
    runs: int = 5000
    designs: int = 2
    indices: int = 512


def checked_runs(field: str, value: object) -> int:
    """A number of samples."""
    return whole(field, value, RUNS_MIN, RUNS_MAX)


def sure_plan_of(top: Section) -> SurePlan:
    """The checked table, or what stands for it."""
    section = top.table("sure", SURE) or Section("sure", {}, SURE)
    values, default = section.values, SurePlan()

    def number(key: str, low: int, high: int) -> int:
        return whole(section.full(key), values.get(key, getattr(default, key)), low, high)

    return SurePlan(
        section.flag("probability", default.probability),
        section.choice("method", METHODS, default.method),
        checked_runs(section.full("runs"), values.get("runs", default.runs)),
        number("designs", 1, DESIGNS_MAX),
        number("indices", 0, INDICES_MAX),
    )
