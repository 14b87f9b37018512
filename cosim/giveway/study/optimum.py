"""A search for the best designs, generation by generation, in the folder of a study.

Every generation is stored before it runs and its runs as parts, like those of a sweep. The next one follows from what
is stored (`optimiser`), so that a search that was killed goes on as if nothing had been, with the same bits.
"""

from __future__ import annotations

import hashlib
import json
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import GivewayError
from giveway.study import engine
from giveway.study.answers import blocks_of, costs_of, cut_off_of, goals_of, whole
from giveway.study.engine import Outcome, Report, Runner
from giveway.study.hypervolume import hypervolume, reference_of, stopped
from giveway.study.optimiser import Known, Space, next_generation, pymoo_version
from giveway.study.runs import RunTable
from giveway.study.setup import Constraint, Setup
from giveway.study.store import Store

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Found", "check_search", "optimise", "violation_of"]

_DECIDES = ("seed", "vary", "parts", "tolerance", "tolerances", "objective", "constraint", "optimise")
NOTHING_NEW = "every design has been tried"


@dataclass(frozen=True)
class Found:
    """What `optimise` did: the runs, and why it ended; "" if it was interrupted."""

    outcome: Outcome
    reason: str


def optimise(
    setup: Setup,
    folder: Path | str,
    *,
    threads: int | None = None,
    progress: Report | None = None,
    dask: str | None = None,
) -> Found:
    """Search the best designs of ``setup`` in ``folder``, or go on with it.

    Ctrl-C ends it cleanly: all parts but those under way are kept, and the same call goes on from there. ``dask`` as in
    `engine.sweep`.

    Raises:
        MissingExtraError: pymoo, or what ``dask`` needs, is not installed.
        GivewayError: the study cannot be optimised as it is; nothing was run.
        FileError: the folder holds something else, is in use, or cannot be written.
        WriteError: writing failed; the parts written before are kept.
        ClusterError: no worker is left, or the scheduler is lost; the parts written before are kept.
    """
    version = check_search(setup)
    folder = Path(folder)
    Store.check(folder)
    engine.check_disk(setup, setup.plan.count * max(1, setup.tolerance_count) * len(setup.cases), folder)
    deviations = engine.deviations_of(setup)
    table = RunTable(setup, np.empty((0, len(setup.varied))), deviations)
    shared = engine.shared_facts(setup)
    contexts = [case.context(shared) for case in table.cases]
    decides = {key: setup.document.get(key) for key in _DECIDES}
    told = json.dumps([engine.fingerprint_of(table, contexts), version, decides], sort_keys=True)
    fingerprint = hashlib.sha256(told.encode()).hexdigest()
    with engine.workforce(threads, dask) as workers, closing(Store(folder, fingerprint)) as store:
        search = _Search(setup, store, deviations, Runner(setup, contexts, store, workers, progress))
        search.manifest = {"shared": shared, "fingerprint": fingerprint}
        return search.run(version)


def check_search(setup: Setup) -> str:
    """Refuse what cannot be searched; returns the version of pymoo.

    Raises:
        MissingExtraError: pymoo is not installed.
        GivewayError: there is nothing to be best in.
    """
    if not setup.objectives:
        raise GivewayError("objective", "nothing", "at least one [[objective]]")
    return pymoo_version()


class _Search:
    """The loop over the generations."""

    def __init__(self, setup: Setup, store: Store, deviations: NDArray[np.float64], runner: Runner) -> None:
        self._setup, self._store, self._deviations, self._runner = setup, store, deviations, runner
        self._space, self._goals = Space(setup.varied), goals_of(setup)
        self._senses = np.array([float(goal.sense) for goal in setup.objectives])
        stated = setup.search.reference
        self._reference = None if stated is None else self._senses * np.array(stated)
        self._volumes: list[float] = []
        self.manifest: dict[str, Any] = {}

    def run(self, version: str) -> Found:
        setup, store = self._setup, self._store
        designs, generation = store.read_generations(len(setup.varied))
        values = np.empty((0, len(self._goals)))
        ran, judged, first = np.empty(0, dtype=bool), 0, True
        while True:
            table = RunTable(setup, designs, self._deviations)
            if len(designs) and (first or len(designs) > len(values)):
                self._write_manifest(table, version, generation, "")
                engine.keep_inputs(setup, store.folder)
            outcome = self._runner.run(table, setup.plan.count * table.per_design)
            if outcome.interrupted:
                return Found(outcome, "")
            for block in blocks_of(store.parts_folder, table, self._goals, len(values)):
                values = np.concatenate([values, block.values])
                there = range(block.first, block.first + len(block.stored))
                cut_off = cut_off_of(setup, block.warnings, there)
                ran = np.concatenate([ran, whole(table.per_design, block.stored, block.failed, cut_off)])
            known = self._known(designs, values, ran)
            for number in range(judged, int(generation[-1]) + 1 if len(generation) else 0):
                self._volumes.append(self._volume(known, generation <= number))
                judged = number + 1
            reason = stopped(setup.search, self._volumes, len(designs))
            if not reason:
                size = min(setup.search.population, setup.search.designs - len(designs))
                fresh = next_generation(self._space, known, setup.seed, judged, size)
                reason = "" if len(fresh) else NOTHING_NEW
            if reason:
                self._write_manifest(table, version, generation, reason)
                return Found(outcome, reason)
            designs = np.concatenate([designs, fresh])
            generation = np.append(generation, np.full(len(fresh), judged))
            store.write_generations(designs, self._deviations, generation)
            first = False

    def _known(self, designs: NDArray[np.float64], values: NDArray[np.float64], ran: NDArray[np.bool_]) -> Known:
        costs = costs_of(self._setup, values)
        costs[~ran | ~np.isfinite(costs).all(axis=1)] = np.nan
        violation = np.zeros(len(designs))
        offset = len(self._setup.objectives)
        for index, constraint in enumerate(self._setup.constraints):
            violation += violation_of(constraint, values[:, offset + index])
        return Known(designs, costs, violation)

    def _volume(self, known: Known, there: NDArray[np.bool_]) -> float:
        costs = known.costs[known.feasible & there]
        if self._reference is None:
            self._reference = reference_of(costs)
        return 0.0 if self._reference is None else hypervolume(costs, self._reference)

    def _write_manifest(self, table: RunTable, version: str, generation: NDArray[np.int64], reason: str) -> None:
        shared, fingerprint = self.manifest["shared"], self.manifest["fingerprint"]
        found = engine.manifest_of(self._setup, table, shared, fingerprint)
        found["versions"]["pymoo"] = version
        found["optimum"] = {
            "designs": [int((generation <= number).sum()) for number in range(len(self._volumes))],
            "hypervolume": self._volumes,
            "reference": None if self._reference is None else (self._reference * self._senses).tolist(),
            "reason": reason,
        }
        self._store.write_manifest({**found, "complete": bool(reason)})


def violation_of(constraint: Constraint, column: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far values (n,) are beyond a constraint, in shares of its limit; 0 where it is met, NaN where nothing is."""
    upper = np.isfinite(constraint.maximum)
    limit = constraint.maximum if upper else constraint.minimum
    beyond = column - limit if upper else limit - column
    return np.asarray(np.maximum(beyond, 0.0) / (abs(limit) or 1.0))
