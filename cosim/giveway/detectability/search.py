"""The smallest force that is noticed, of many robots and probes at once: halved and halved again in the batch library.

A larger force is taken to be noticed if a smaller one is. A robot that raises an alarm in the same run without a force
cannot tell anything there: its smallest force is NaN. What is not noticed at the largest force is infinite.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway import batch
from giveway.base.errors import SimulationError
from giveway.base.gravity import GRAVITY_MPS2
from giveway.detectability.probes import IMPULSE, KINDS, MOTION, REST, Drive, Probe, scenario
from giveway.detectability.robots import Subject
from giveway.robot.variables import Value
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["DECADES", "STEPS", "Interrupted", "Smallest", "largest", "noticed", "smallest"]

DECADES = 3.0  # from the largest force down
STEPS = 7  # halvings of that range: to 5.5 %
PART = 512  # runs whose inputs are in memory at once
IMPULSE_SPEED_MPS = 1.0


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended the search."""


@dataclass(frozen=True)
class Smallest:
    """Of one situation and kind.

    Attributes:
        situation, kind: of `probes`.
        values: smallest N or N s of each robot and probe, shape (robots, probes).
        alarmed: robots that raise an alarm without a force, shape (robots,).
    """

    situation: str
    kind: str
    values: NDArray[np.float64]
    alarmed: NDArray[np.bool_]


def largest(whose: Subject, kind: str) -> float:
    """The largest force that is tried: the robot's weight; the largest impulse stops it from 1 m/s."""
    mass = float(whose.testbed["base.mass"])
    return mass * (IMPULSE_SPEED_MPS if kind == IMPULSE else GRAVITY_MPS2)


def smallest(
    whose: Subject,
    robots: Sequence[Mapping[str, Value]],
    drives: Sequence[Drive] | None,
    kind: str,
    probes: Sequence[Probe],
    controller: Mapping[str, Value],
    threads: int,
    progress: Callable[[float], None] = lambda share: None,
) -> Smallest:
    """The smallest force of ``kind`` that each robot notices at each probe; ``drives``: their motions, or None."""
    assert kind in KINDS

    def make(number: int, probe: Probe | None, size: float) -> Scenario:
        drive = None if drives is None else drives[number]
        return scenario(whose, robots[number], number, drive, kind, probe, size, controller)

    alarmed = noticed((make(number, None, 0.0) for number in range(len(robots))), threads)
    cells = [(number, column) for number in np.flatnonzero(~alarmed).tolist() for column in range(len(probes))]
    top = largest(whose, kind)
    low = np.full(len(cells), math.log10(top) - DECADES)
    high = np.full(len(cells), math.log10(top))
    seen = np.ones(len(cells), dtype=bool)
    for step in range(STEPS + 1):
        sizes = 10.0 ** (high if step == 0 else 0.5 * (low + high))
        found = noticed(
            (make(number, probes[column], size) for (number, column), size in zip(cells, sizes.tolist(), strict=True)),
            threads,
        )
        if step == 0:
            seen = found
        else:
            middle = 0.5 * (low + high)
            low, high = np.where(found, low, middle), np.where(found, middle, high)
        progress((step + 1) / (STEPS + 1))
    values = np.full((len(robots), len(probes)), math.nan)
    for (number, column), value, was in zip(cells, (10.0**high).tolist(), seen.tolist(), strict=True):
        values[number, column] = value if was else math.inf
    return Smallest(REST if drives is None else MOTION, kind, values, alarmed)


def noticed(scenarios: Iterator[Scenario], threads: int) -> NDArray[np.bool_]:
    """Whether each run has a detection."""
    found: list[bool] = []
    part: list[Scenario] = []
    for one in scenarios:
        part.append(one)
        if len(part) == PART:
            found += _detected(part, threads)
            part = []
    if part:
        found += _detected(part, threads)
    return np.array(found, dtype=bool)


def _detected(part: Sequence[Scenario], threads: int) -> list[bool]:
    table = batch.Prepared(part).run(threads=threads, method="fixed-step")
    if table.attrs["interrupted"]:
        raise Interrupted
    for status, message, one in zip(table["status"].values, table["message"].values, part, strict=True):
        if status != "ok":
            raise SimulationError("batch library", f"{one.name}: {message}", one.duration_s)
    return [bool(count > 0) for count in table["detections"].values]
