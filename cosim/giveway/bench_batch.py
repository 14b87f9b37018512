"""How many collisions a second: the co-simulation over FMPy against the batch library on one and two threads."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass

import giveway
from giveway import batch, experiments

__all__ = ["SIMULATED_S", "Rate", "measure"]

SIMULATED_S = 0.6  # the hit, the detection and the start of the escape
RUNS_PER_REPEAT = 20


@dataclass(frozen=True)
class Rate:
    """Runs per second of one way to run; best and median over the repeats."""

    name: str
    best: float
    median: float


def measure(repeats: int) -> list[Rate]:
    """Runs per second of the motionless experiment's first 0.6 s, metrics included; the library records no traces."""
    scenario = experiments.get("motionless").scenario("magnetic")
    scenario = dataclasses.replace(scenario, duration_s=SIMULATED_S)
    many = [scenario] * RUNS_PER_REPEAT
    ways: dict[str, Callable[[], object]] = {
        "FMPy loop": lambda: [giveway.run(scenario) for _ in many],
        "event-exact, 1 thread": lambda: batch.run_many(many, threads=1),
        "event-exact, 2 threads": lambda: batch.run_many(many, threads=2),
    }
    giveway.run(scenario)  # unpacks the FMUs, imports FMPy
    batch.run(scenario)
    rates: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(repeats):  # in turns, so that a busy machine slows all of them
        for name, way in ways.items():
            started = time.perf_counter()
            way()
            rates[name].append(RUNS_PER_REPEAT / (time.perf_counter() - started))
    return [Rate(name, max(found), sorted(found)[len(found) // 2]) for name, found in rates.items()]
