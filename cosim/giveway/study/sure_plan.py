"""How sure a recommendation is made: the table ``[sure]`` of a study file."""

from __future__ import annotations

from dataclasses import dataclass

from giveway.base.checks import whole
from giveway.base.shapes import Choice, Flag, Table, Whole
from giveway.base.toml_sections import Section

__all__ = ["METHODS", "SURE", "SurePlan", "checked_runs", "sure_plan_of"]

METHODS = ("subset", "plain")
RUNS_MIN, RUNS_MAX, DESIGNS_MAX, INDICES_MAX = 1000, 20_000_000, 20, 1_000_000
SURE = Table(
    "how sure the best designs are, within the tolerances",
    {
        "probability": Flag("how probable it is that a limit is exceeded (true)"),
        "method": Choice("of sampling", METHODS),
        "runs": Whole("samples at most for each design", RUNS_MIN, RUNS_MAX),
        "designs": Whole("how many of the best", 1, DESIGNS_MAX),
        "indices": Whole("base samples of the Sobol' indices; 0: none", 0, INDICES_MAX),
    },
)


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
    section = top.table("sure") or Section("sure", {}, SURE)
    default = SurePlan()
    return SurePlan(
        section.flag("probability", default.probability),
        section.choice("method", METHODS, default.method),
        section.whole("runs", default.runs),
        section.whole("designs", default.designs),
        section.whole("indices", default.indices),
    )
