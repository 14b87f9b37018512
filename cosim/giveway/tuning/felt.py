"""What the robot of a file notices with other thresholds: the smallest push and impulse, and how soon."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway import batch
from giveway.detectability.probes import IMPULSE, KINDS, MOTION, PUSH, REST, Drive, places, scenario
from giveway.detectability.robots import subject
from giveway.detectability.search import smallest
from giveway.robot.variables import Value
from giveway.scenario.plan import Pushes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.scenario.scenario import Scenario

__all__ = ["Felt", "felt"]

DIRECTIONS = 6
SPEED_MPS = 0.2
CLEAR = 2.0  # times the smallest push: one whose delay is told
COUNT = "controller.detection.count"


@dataclass(frozen=True)
class Felt:
    """Of the robot as its file says.

    Attributes:
        situation: at rest or in motion.
        kind: push or impulse.
        unit: of ``smallest``.
        smallest: that it notices from all sides; infinite: it does not; NaN: it is alarmed without one.
        delay_s: until it notices twice as much, from the worst side; NaN: it does not.
    """

    situation: str
    kind: str
    unit: str
    smallest: float
    delay_s: float


def felt(robot: Path, controller: Mapping[str, Value], threads: int) -> tuple[Felt, ...]:
    """Pushes and impulses from `DIRECTIONS` sides at the middle of the outline, in the simulated robot of the file."""
    whose = subject(robot)
    probes = places(whose, DIRECTIONS, ("middle",))
    found = []
    for situation, drive in ((REST, None), (MOTION, Drive(SPEED_MPS, 0.5))):
        for kind in (PUSH, IMPULSE):
            drives = None if drive is None else [drive]
            values = smallest(whose, [{}], drives, kind, probes, controller, threads).values[0]
            worst = float(np.max(values)) if not np.isnan(values).any() else math.nan
            delay_s = math.nan
            if math.isfinite(worst):
                runs = [scenario(whose, {}, 0, drive, kind, probe, CLEAR * worst, controller) for probe in probes]
                table = batch.Prepared(runs, traces=(COUNT,)).run(threads=threads, method="fixed-step")
                delay_s = max(_delay(table[COUNT].values[index], run) for index, run in enumerate(runs))
            found.append(Felt(situation, kind, KINDS[kind], worst, delay_s))
    return tuple(found)


def _delay(counts: NDArray[np.int32], run: Scenario) -> float:
    """From the push to the first alarm, s; infinite: there is none."""
    assert isinstance(run.push, Pushes)
    seen = np.flatnonzero(counts > 0)
    return float(seen[0]) * run.step_s - run.push.pushes[0].start_s if len(seen) else math.inf
