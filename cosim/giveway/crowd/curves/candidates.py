"""What is compared: `CANDIDATES`, in the order of the figure.

Those with ``settings`` are the controller's own detectors, judged by the statistic that they compare with their
threshold (`detection.statistic`). ``residual`` ones are textbook detectors behind the high-pass, on the residual of the
controller's full estimator, with the noise of other quiet robots of the draw, learned apart for still and for turning
wheels. Those with ``scaled`` parameters have several thresholds, or start anew when they trip: the controller runs with
all thresholds multiplied, reactions included.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from giveway.crowd.curves import cusum, glr, kalman, matched_filter
from giveway.crowd.curves.noise import Noise, high_passed, learned, restarted
from giveway.crowd.curves.situations import REST
from giveway.crowd.population import start_value

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from giveway.robot.variables import Value

    Numbers = NDArray[np.float64]

__all__ = ["CANDIDATES", "FULL", "OURS", "RESIDUAL", "Candidate", "Model", "Residual", "learn", "scaled", "statistics"]

FULL: Mapping[str, Value] = MappingProxyType(
    {
        "estimator.friction_model": 1,
        "estimator.acceleration_source": 1,
        "estimator.velocity_source": 1,
        "estimator.rate_cutoff": 200.0,
        "estimator.aligned": 1,
        "estimator.creep_speed": 0.04,
    }
)
"""The estimator of the two channels."""

PAPER: Mapping[str, Value] = MappingProxyType(
    {
        "estimator.friction_model": 0,
        "estimator.acceleration_source": 0,
        "estimator.velocity_source": 0,
        "estimator.rate_cutoff": 200.0,
        "estimator.aligned": 0,
        "estimator.creep_speed": 0.03,
    }
)
"""That of the paper."""

DEAF: Mapping[str, Value] = MappingProxyType({"detector.force_threshold": 1e4, "detector.impulse_threshold": 1e3})
"""Thresholds that nothing reaches: the controller never reacts."""

RESIDUAL: Mapping[str, Value] = MappingProxyType(
    {**FULL, **DEAF, "detector.kind": 0, "estimator.average_window": 1, "estimator.rest_ticks": 100000}
)
"""The residual of every tick is an output, and its zero never changes: what a high-pass needs."""


def _thresholds(low: float, high: float, count: int = 40) -> tuple[float, ...]:
    return tuple(np.geomspace(low, high, count).tolist())


@dataclass(frozen=True)
class Candidate:
    """One detector.

    Attributes:
        name: in tables and figure.
        unit: of its thresholds.
        thresholds: ascending.
        settings: of the controller that has this detector; None: it works on the residual.
        scaled: its parameters that are multiplied by each of ``thresholds``; none: the statistic is compared with them.
    """

    name: str
    unit: str
    thresholds: tuple[float, ...]
    settings: Mapping[str, Value] | None = None
    scaled: tuple[str, ...] = ()


OURS = Candidate(
    "two channels",
    "of the default",
    (0.6, 0.8, 1.0, 1.4, 2.0),
    MappingProxyType({**FULL, "detector.kind": 2}),
    (
        *("channels.noise_multiple", "channels.model_multiple", "channels.rocking"),
        *(f"channels.{channel}_{regime}" for channel in ("fast", "slow") for regime in ("rest", "creep", "motion")),
    ),
)

IMPULSE = Candidate(
    "leaky impulse, paper's estimator",
    "of the default",
    (1.0, 3.0, 10.0),
    MappingProxyType({**PAPER, "detector.kind": 1}),
    ("detector.impulse_threshold", *(f"detector.leak_{regime}" for regime in ("rest", "creep", "motion"))),
)

CANDIDATES: tuple[Candidate, ...] = (
    Candidate("force average, paper's estimator", "N", _thresholds(2.0, 300.0), {**PAPER, **DEAF, "detector.kind": 0}),
    IMPULSE,
    Candidate("force average", "N", _thresholds(1.0, 150.0), {**FULL, **DEAF, "detector.kind": 0}),
    Candidate("matched filters", "sigma", _thresholds(3.0, 300.0)),
    Candidate("CUSUM", "log likelihood", _thresholds(3.0, 3000.0)),
    Candidate("GLR", "sigma", _thresholds(3.0, 300.0)),
    Candidate("Kalman observer", "sigma", _thresholds(3.0, 300.0)),
    OURS,
)


def scaled(
    candidate: Candidate, scale: float, controller: Mapping[str, Value], robot: Path | None = None
) -> dict[str, Value]:
    """The controller with this detector, and what ``controller`` sets, with all thresholds ``scale`` times as large.

    ``robot``: whose file states the others; None: Trikey's.
    """
    own: dict[str, Value] = {**(candidate.settings or {}), **controller}
    for name in candidate.scaled:
        own[name] = scale * float(own.get(name, start_value(name, "controller", robot)))
    return own


@dataclass(frozen=True)
class Model:
    """The noise while the wheels are still, and while they turn; variances of the observed wrench, too."""

    noise: tuple[Noise, Noise]
    observed: tuple[Numbers, Numbers]


def learn(residual: Residual) -> Model:
    """From quiet residuals."""
    passed = residual.passed()
    pieces: tuple[list[Numbers], list[Numbers]] = ([], [])
    for values, turns in zip(passed, ~residual.still, strict=True):
        ends = [0, *(np.flatnonzero(np.diff(turns)) + 1).tolist(), len(turns)]
        for first, end in itertools.pairwise(ends):
            pieces[int(turns[first])].append(values[:, first:end])
    still, turning = learned(pieces[0]), learned(pieces[1])
    of_still = kalman.observed(passed, still).swapaxes(0, 1)[:, residual.still]
    of_turning = kalman.observed(passed, turning).swapaxes(0, 1)[:, ~residual.still]
    return Model((still, turning), (np.mean(of_still**2, axis=1), np.mean(of_turning**2, axis=1)))


@dataclass(frozen=True)
class Residual:
    """What textbook detectors are given.

    Attributes:
        wrench: (runs, 3, n).
        situations: of each tick, (runs, n).
        still: at rest, and no encoder has moved for a while, (runs, n).
    """

    wrench: Numbers
    situations: NDArray[np.int8]
    still: NDArray[np.bool_]

    def passed(self) -> Numbers:
        """The wrench behind the high-pass, which takes a new zero when the robot has come to rest."""
        rests = self.situations == REST
        comes = rests[:, 1:] & ~rests[:, :-1]
        rows = [np.flatnonzero(one) + 1 for one in comes]
        return np.stack([restarted(high_passed(one), at) for one, at in zip(self.wrench, rows, strict=True)])


def statistics(model: Model, residual: Residual) -> dict[str, Numbers]:
    """By candidate of the residual: statistics (runs, n)."""
    passed, still = residual.passed(), residual.still
    white = np.where(still[:, None, :], model.noise[0].whitened(passed), model.noise[1].whitened(passed))

    def chosen(of: list[Numbers]) -> Numbers:
        return np.where(still, of[0], of[1])

    return {
        "matched filters": chosen([matched_filter.statistic(white, noise) for noise in model.noise]),
        "CUSUM": cusum.statistic(white),
        "GLR": chosen([glr.statistic(white, noise) for noise in model.noise]),
        "Kalman observer": chosen(
            [
                kalman.statistic(kalman.observed(passed, noise), variance)
                for noise, variance in zip(model.noise, model.observed, strict=True)
            ]
        ),
    }
