"""How sure a recommendation is: how probable it is, within the tolerances, that a design exceeds a limit of the study.

The samples of a design are runs of the study with other tolerance samples, in DIR/sure/design-N-METHOD: stored in
parts, so that after Ctrl-C or a kill the same call goes on with the same bits. Every sample follows from the seed and
from the stored runs before it.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import FileError, GivewayError
from giveway.study import engine
from giveway.study.designs import deviations_at
from giveway.study.engine import Report, Runner
from giveway.study.limits import limit_words
from giveway.study.results_table import read_part
from giveway.study.runs import RunTable
from giveway.study.store import Store, list_parts, read_manifest
from giveway.study.subset import SAMPLER, Sampled, binomial_interval, plain, subset
from giveway.study.sure_plan import METHODS, SurePlan

if TYPE_CHECKING:
    from _typeshed import DataclassInstance
    from numpy.typing import NDArray

    from giveway.study.answers import Answers
    from giveway.study.metrics import Metric
    from giveway.study.setup import Constraint, Setup

__all__ = [
    "SURE",
    "LimitShare",
    "Probability",
    "Samples",
    "about",
    "best_designs",
    "concluded",
    "plan_with",
    "probability",
    "stored",
    "uncertain",
    "wanted",
]

SURE = "sure"  # folder in that of the study
KIND = "giveway sure"
RESULT = "result"  # in the manifest


@dataclass(frozen=True)
class LimitShare:
    """One limit alone.

    Attributes:
        limit, allowed: its name, and what is allowed in words.
        value: the probability that it is exceeded.
        high: the upper end of its 95 % interval if it was never exceeded; else None.
    """

    limit: str
    allowed: str
    value: float
    high: float | None


@dataclass(frozen=True)
class Probability:
    """That a design exceeds any limit of its study.

    Attributes:
        design: its number.
        method: one of `sure_plan.METHODS`.
        value, low, high: of the probability; ends of its 95 % interval. A value of 0: never seen, and at most ``high``.
        samples: of the tolerances; ``runs``: one per collision for each.
        exceeded, plainly: in how many of the plain samples among them a limit is exceeded, and how many these are.
        agrees: the plain samples alone do not contradict it.
        failed: samples with a run that failed or was refused, which count as exceeded.
        limits: each limit alone.
    """

    design: int
    method: str
    value: float
    low: float
    high: float
    samples: int
    runs: int
    exceeded: int
    plainly: int
    agrees: bool
    failed: int
    limits: tuple[LimitShare, ...]


def judged_limits(setup: Setup) -> list[tuple[int, Constraint]]:
    """The limits that depend on runs, with their numbers among the constraints."""
    return [(i, one) for i, one in enumerate(setup.constraints) if not one.goal.metric.of_design]


def uncertain(setup: Setup) -> str:
    """Why there is nothing to be unsure of; "" if there is."""
    if not judged_limits(setup):
        return "the study has no [[constraint]] on what happens in a run"
    if not (setup.tolerances or setup.crowd or setup.noise_seeds):
        return "nothing differs from sample to sample: the study has no [[tolerance]]"
    return ""


def wanted(answers: Answers) -> bool:
    """The study asks for it, or does not say no."""
    return answers.setup.sure.probability and not uncertain(answers.setup) and answers.complete


def best_designs(answers: Answers) -> list[int]:
    """The designs whose probability is told: the recommended one, and the next best."""
    from giveway.study.recommended import recommended

    found = recommended(answers)
    if found is None:
        return []
    others = [*found.following, *answers.order.tolist()]
    return list(dict.fromkeys([found.design, *others]))[: answers.setup.sure.designs]


class Samples:
    """Runs of one design with tolerance samples that are asked for block by block, each stored before the next.

    Their folder is that of what they are for: as ``with`` begins, its manifest says what was asked, and `conclude`
    writes the result into it.
    """

    def __init__(
        self,
        answers: Answers,
        design: int,
        purpose: str,
        decides: dict[str, Any],
        metrics: Sequence[Metric],
        samples: int,
        threads: int | None,
        progress: Report | None,
    ) -> None:
        """``decides``: what the samples depend on besides; ``samples``: so many are expected."""
        from giveway.library.work import default_threads

        setup = self._setup = answers.setup
        width = answers.runs.deviations.shape[1]
        self.table = RunTable(setup, answers.runs.designs[[design]], np.empty((0, width)))
        shared = engine.shared_facts(setup)
        contexts = [case.context(shared) for case in self.table.cases]
        told = [engine.fingerprint_of(self.table, contexts), decides, np.__version__, setup.seed]
        fingerprint = hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()
        self._metrics, self._expected = metrics, samples * len(setup.cases)
        self._names = sorted({name for one in metrics for name in one.columns})
        self._told = {"name": f"design {design} of {setup.name}", "asked": decides, "seed": setup.seed}
        self._store = Store(_folder(answers, design, purpose), fingerprint, KIND)
        self._runner = Runner(setup, contexts, self._store, threads or default_threads(), progress)

    def __enter__(self) -> Samples:
        self._store.write_manifest({**self._told, "complete": False, RESULT: None})
        return self

    def __exit__(self, *_: object) -> None:
        self._store.close()

    def conclude(self, result: DataclassInstance) -> None:
        """Store what the samples were for."""
        self._store.write_manifest({**self._told, "complete": True, RESULT: asdict(result)})

    def run(
        self, deviations: NDArray[np.float64], noise: NDArray[np.float64] | None = None
    ) -> tuple[list[NDArray[np.float64]], NDArray[np.bool_]]:
        """Run more samples; returns the metrics, each (n, collisions), and whether each sample ran (n, collisions).

        ``noise``: what the seed of the sensor noise is greater by in every sample, if it differs.
        """
        before = self.table.count
        self.table = self.table.with_deviations(np.concatenate([self.table.deviations, deviations]), noise)
        outcome = self._runner.run(self.table, max(self._expected, self.table.count))
        if outcome.interrupted:
            raise KeyboardInterrupt
        parts = [
            read_part(path, ["status", *self._names])
            for first, end, path in list_parts(self._store.parts_folder)
            if before <= first and end <= self.table.count
        ]
        found = {name: np.concatenate([part[name].to_numpy() for part in parts]) for name in self._names}
        ran = np.concatenate([np.array(part["status"].to_pylist()) == "ok" for part in parts])
        shape = (len(deviations), len(self.table.cases))
        return [one.of(found).reshape(shape) for one in self._metrics], ran.reshape(shape)

    def deviations_at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """The tolerance samples at points (n, d) of the standard normal space."""
        from scipy.special import ndtr

        return deviations_at(self._setup.tolerances, ndtr(points))


class _Judge:
    """The samples of one design, judged by the limits."""

    def __init__(self, limits: Sequence[Constraint], samples: Samples) -> None:
        self._limits, self._samples = limits, samples
        self._beyond: list[NDArray[np.bool_]] = []
        self.failed = 0

    def excess(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far samples are beyond the nearest limit or behind it, in shares of the limit."""
        found, ran = self._samples.run(self._samples.deviations_at(points))
        self.failed += int((~ran.all(axis=1)).sum())
        each = np.stack([_beyond(one, values) for one, values in zip(self._limits, found, strict=True)], axis=1)
        each[~ran.all(axis=1)] = math.inf  # what is not known is not allowed
        self._beyond.append(each > 0.0)
        return np.asarray(each.max(axis=1))

    def shares(self, numbers: NDArray[np.int64]) -> list[float]:
        """Of the samples ``numbers``, the share that is beyond each limit."""
        if not len(numbers):
            return [0.0] * len(self._limits)
        return [float(share) for share in np.concatenate(self._beyond)[numbers].mean(axis=0)]

    def ever(self, samples: int) -> list[bool]:
        """Which limits one of the first ``samples`` is beyond."""
        return [bool(beyond.any()) for beyond in np.concatenate(self._beyond)[:samples].T]


def _beyond(limit: Constraint, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of samples (n, collisions), in shares of the limit; infinite where the metric is missing."""
    upper = math.isfinite(limit.maximum)
    at = limit.maximum if upper else limit.minimum
    over = (values - at if upper else at - values) / (abs(at) or 1.0)
    over = np.where(np.isnan(over), math.inf, over)
    return np.asarray(over.max(axis=1) if limit.goal.collisions == "worst" else over.mean(axis=1))


def probability(
    answers: Answers,
    design: int,
    plan: SurePlan | None = None,
    *,
    threads: int | None = None,
    progress: Report | None = None,
) -> Probability:
    """How probable it is that a design exceeds a limit; what is stored is not run again.

    Args:
        answers: of the study.
        design: its number.
        plan: method and number of runs; None: the study's.
        threads: native ones; None: all processors.
        progress: called now and then.

    Raises:
        GivewayError: nothing is uncertain, or nothing is limited.
        KeyboardInterrupt: after Ctrl-C; what is stored is kept.
    """
    plan = answers.setup.sure if plan is None else plan
    if reason := uncertain(answers.setup):
        raise GivewayError("constraint" if "constraint" in reason else "tolerance", "nothing", reason)
    limits = judged_limits(answers.setup)
    dimensions = answers.runs.deviations.shape[1]
    method = plan.method if dimensions else METHODS[1]  # noise alone has no direction towards a limit
    decides = {"sampler": SAMPLER, "method": method, "samples": plan.runs, "about": about(answers, design)}
    metrics = [one.goal.metric for _, one in limits]
    if (known := _stored(answers, design, method, decides)) is not None:
        return known
    with Samples(answers, design, method, decides, metrics, plan.runs, threads, progress) as samples:
        judge = _Judge([one for _, one in limits], samples)
        sampler = plain if method == METHODS[1] else subset
        found = sampler(judge.excess, dimensions, plan.runs, answers.setup.seed)
        result = _result(answers, design, method, found, judge, [number for number, _ in limits])
        samples.conclude(result)
        return result


def _result(
    answers: Answers, design: int, method: str, found: Sampled, judge: _Judge, numbers: Sequence[int]
) -> Probability:
    offset = len(answers.setup.objectives)
    # A limit that is never exceeded: not more probable than any, nor than the plain samples allow.
    _, never = binomial_interval(0, found.plainly)
    highs = [found.high if ever else min(found.high, never) for ever in judge.ever(found.plainly)]
    limits = tuple(
        LimitShare(
            answers.goals[offset + number].metric.name,
            limit_words(answers.setup, number),
            share * found.value,
            None if share else high,
        )
        for number, share, high in zip(numbers, judge.shares(found.beyond), highs, strict=True)
    )
    runs = found.samples * len(answers.setup.cases)
    plainly = (found.exceeded, found.plainly, found.agrees)
    return Probability(
        design, method, found.value, found.low, found.high, found.samples, runs, *plainly, judge.failed, limits
    )


def _folder(answers: Answers, design: int, purpose: str) -> Path:
    return answers.folder / SURE / f"design-{design}-{purpose}"


def about(answers: Answers, design: int) -> str:
    """Hash of what a probability is about, however it is found: the study's runs, the design, tolerances, limits."""
    document = {key: answers.setup.document.get(key) for key in ("tolerance", "tolerances", "constraint")}
    told = [answers.manifest["fingerprint"], answers.designs[design].tolist(), document]
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


def stored(answers: Answers, design: int) -> list[Probability]:
    """What is known of a design: the study's method first, then others."""
    methods = sorted(METHODS, key=lambda one: one != answers.setup.sure.method)
    found = (_stored(answers, design, method, None) for method in methods)
    return [one for one in found if one is not None]


def _stored(answers: Answers, design: int, method: str, decides: dict[str, Any] | None) -> Probability | None:
    told = concluded(answers, design, method, decides)
    if told is None:
        return None
    # Of an earlier version: a limit is exceeded at most as often as any.
    limits = (LimitShare(**{"high": None if one["value"] else told["high"], **one}) for one in told["limits"])
    return Probability(**{**told, "limits": tuple(limits)})


def concluded(answers: Answers, design: int, purpose: str, decides: dict[str, Any] | None) -> dict[str, Any] | None:
    """The result of a design's samples that are stored; ``decides``: only if it was found in this way."""
    try:
        manifest = read_manifest(_folder(answers, design, purpose), KIND)
    except FileError:
        return None
    asked, told = manifest.get("asked", {}), manifest.get(RESULT)
    if told is None or asked.get("about") != about(answers, design) or decides not in (None, asked):
        return None
    return dict(told)


def plan_with(plan: SurePlan, runs: int | None, method: str | None) -> SurePlan:
    """``plan``, with what is not None instead."""
    from giveway.base.errors import UnknownNameError
    from giveway.study.sure_plan import checked_runs

    if method is not None and method not in METHODS:
        raise UnknownNameError("--method", method, METHODS)
    if runs is not None:
        plan = replace(plan, runs=checked_runs("--runs", runs))
    return plan if method is None else replace(plan, method=method)
