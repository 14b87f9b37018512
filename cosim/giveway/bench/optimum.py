"""What a search finds with few runs, against an even sample with many: shares of the sample's hypervolume.

The study is taken at its stated values, without its tolerances, so that a design is a run per collision. Searches do
not end before their runs are used up. All of it is stored, and goes on where it stopped.
"""

from __future__ import annotations

import copy
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.checks import whole
from giveway.base.errors import GivewayError
from giveway.base.toml_sections import lines_named, read_toml
from giveway.study.answers import Answers, costs_of, load
from giveway.study.engine import Progress, sweep
from giveway.study.hypervolume import hypervolume
from giveway.study.optimiser import Known, Space, next_generation
from giveway.study.optimum import check_search, optimise
from giveway.study.search_plan import OPTIMISED, SearchPlan
from giveway.study.study_file import check

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.study.setup import Setup

__all__ = ["HEADER", "Comparison", "compare", "names", "shares_in_words"]

HEADER = ("seed", "runs", "share of the sample's hypervolume", "runs until 0.99 of it", "on the front", "own ms/design")
WANTED = 0.99
RUNS_MAX, SEEDS_MAX = 20_000_000, 1000

Say = Callable[[str, float], None]


@dataclass(frozen=True)
class Comparison:
    """One search against the sample.

    Attributes:
        seed: of the search.
        runs: that it had.
        share: its hypervolume as a share of the sample's.
        enough: after how many runs it had `WANTED` of it; None: never.
        front: designs on its front.
        own_ms: what it costs at the end to find a design, its runs apart.
    """

    seed: int
    runs: int
    share: float
    enough: int | None
    front: int
    own_ms: float

    @property
    def cells(self) -> tuple[str, ...]:
        """A row under `HEADER`."""
        enough = "-" if self.enough is None else f"{self.enough:,}"
        return f"{self.seed}", f"{self.runs:,}", f"{self.share:.4f}", enough, f"{self.front}", f"{self.own_ms:.2f}"


def names(seeds: int) -> list[str]:
    """The parts of the work."""
    return ["even sample", *(f"search {seed}" for seed in range(1, seeds + 1))]


def shares_in_words(found: list[Comparison], sample: int, runs: int) -> str:
    """The result in one sentence."""
    shares = [one.share for one in found]
    return (
        f"{runs:,} searched runs reach {np.median(shares):.4f} of the hypervolume of {sample:,} even ones "
        f"(median of {len(shares)} seeds, {min(shares):.4f} to {max(shares):.4f})."
    )


def compare(study: Path, out: Path, sample: int, runs: int, seeds: int, say: Say) -> Iterator[Comparison]:
    """Sample ``study`` evenly with ``sample`` runs, then search it with each of so many seeds and ``runs`` runs.

    Raises:
        GivewayError: the study cannot be searched, or states no reference point.
        KeyboardInterrupt: after Ctrl-C; what is stored is kept.
    """
    whole("--sample", sample, 2, RUNS_MAX)
    whole("--runs", runs, SearchPlan().population, RUNS_MAX)
    whole("--seeds", seeds, 1, SEEDS_MAX)
    text, document = read_toml(study, "give the path of a study file (TOML)")
    document = {key: value for key, value in document.items() if key not in ("tolerance", "tolerances")}
    hits = max(1, len(document.get("collision", [])))
    search = {**document.get("optimise", {}), "designs": runs // hits, "growth": 0.0, "patience": runs}
    if "reference" not in search:
        raise GivewayError("optimise.reference", "nothing", "a value of each objective: the point of the hypervolumes")

    def made(designs: dict[str, Any], seed: int) -> Setup:
        changed = {**document, "seed": seed, "designs": designs, "optimise": search}
        with lines_named(study, text):
            return check(copy.deepcopy(changed), study.parent, study.stem)

    check_search(made({"kind": OPTIMISED}, 1))
    setup = made({"kind": "sobol", "count": sample // hits}, 1)
    named = iter(names(seeds))
    if sweep(setup, out / "sample", progress=_share(say, next(named))).interrupted:
        raise KeyboardInterrupt
    reference = np.array(setup.search.reference) * np.array([goal.sense for goal in setup.objectives])
    volume = hypervolume(_costs(load(out / "sample")), reference)
    if volume <= 0.0:
        raise GivewayError("optimise.reference", setup.search.reference, "a point that some feasible design beats")
    for seed, name in enumerate(named, 1):
        setup = made({"kind": OPTIMISED}, seed)
        if optimise(setup, out / name.replace(" ", "-"), progress=_share(say, name)).outcome.interrupted:
            raise KeyboardInterrupt
        yield _judged(load(out / name.replace(" ", "-")), reference, volume, seed, hits)


def _share(say: Say, name: str) -> Callable[[Progress], None]:
    say(name, 0.0)
    return lambda progress: say(name, progress.done / progress.runs)


def _costs(answers: Answers) -> NDArray[np.float64]:
    """Of the designs that meet all constraints."""
    return costs_of(answers.setup, answers.values)[answers.feasible]


def _judged(answers: Answers, reference: NDArray[np.float64], volume: float, seed: int, hits: int) -> Comparison:
    told = answers.manifest["optimum"]
    reached = (
        count * hits for count, its in zip(told["designs"], told["hypervolume"], strict=True) if its >= WANTED * volume
    )
    return Comparison(
        seed,
        len(answers.designs) * hits,
        hypervolume(_costs(answers), reference) / volume,
        next(reached, None),
        int(answers.pareto.sum()),
        _own_ms(answers),
    )


def _own_ms(answers: Answers) -> float:
    """Wall time to find one more generation, per design."""
    costs = costs_of(answers.setup, answers.values)
    costs[answers.failed > 0] = np.nan
    known = Known(answers.designs, costs, np.where(answers.feasible, 0.0, 1.0))
    started = time.perf_counter()
    found = next_generation(Space(answers.setup.varied), known, 1, 1, answers.setup.search.population)
    return 1e3 * (time.perf_counter() - started) / max(1, len(found))
