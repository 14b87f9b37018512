"""How the best designs are searched: the table ``[optimise]`` of a study file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from giveway.base.checks import finite, whole
from giveway.base.errors import GivewayError
from giveway.base.shapes import List, Number, Table, Whole
from giveway.base.toml_sections import Section

if TYPE_CHECKING:
    from giveway.study.setup import Goal

__all__ = ["OPTIMISE", "OPTIMISED", "SearchPlan", "search_plan_of"]

OPTIMISED = "optimised"
"""The kind of designs that a search makes."""
DESIGNS_MAX, POPULATION_MIN, POPULATION_MAX = 1_000_000, 4, 4096
OPTIMISE = Table(
    "the search of giveway optimise",
    {
        "designs": Whole("at most so many", POPULATION_MIN, DESIGNS_MAX),
        "population": Whole("designs of a generation", POPULATION_MIN, POPULATION_MAX),
        "patience": Whole("generations with less growth, after which it ends", 1, DESIGNS_MAX),
        "growth": Number("of the hypervolume, as a share", 0.0, 1.0),
        "reference": List("point of the hypervolume: a value of each objective", Number(), "a list of numbers"),
    },
)


@dataclass(frozen=True)
class SearchPlan:
    """The search.

    Attributes:
        designs: at most so many.
        population: designs of a generation.
        patience, growth: it ends when in so many generations the hypervolume grew by no more than this share.
        reference: point of the hypervolume, a value of each objective in the metric's own unit; None: somewhat worse
            than the first feasible designs.
    """

    designs: int = 2000
    population: int = 24
    patience: int = 10
    growth: float = 1e-3
    reference: tuple[float, ...] | None = None


def search_plan_of(top: Section, objectives: Sequence[Goal]) -> SearchPlan:
    """The checked table, or what stands for it."""
    section = top.table("optimise") or Section("optimise", {}, OPTIMISE)
    values, default = section.values, SearchPlan()
    reference = None
    if "reference" in values:
        given = values["reference"]
        if not isinstance(given, list) or len(given) != len(objectives):
            allowed = f"a list of {len(objectives)} numbers, one for each objective"
            raise GivewayError(section.full("reference"), given, allowed)
        units = [goal.metric.unit for goal in objectives]
        reference = tuple(
            finite(f"{section.full('reference')}[{index}]", value, unit=unit)
            for index, (value, unit) in enumerate(zip(given, units, strict=True))
        )
    population = section.whole("population", default.population)
    designs = whole(section.full("designs"), values.get("designs", default.designs), population, DESIGNS_MAX)
    patience, growth = section.whole("patience", default.patience), section.number("growth", default.growth)
    return SearchPlan(designs, population, patience, growth, reference)
