"""The time that one co-simulated second takes with FMPy, and its parts."""

from __future__ import annotations

import dataclasses
import statistics
import time
from dataclasses import dataclass

from giveway import experiments
from giveway.simulation.master import simulate

__all__ = ["Timing", "measure"]

SIMULATED_S = 1.0


@dataclass(frozen=True)
class Timing:
    """Wall time of one part over several runs, ms."""

    name: str
    minimum_ms: float
    median_ms: float


def measure(repeats: int, fmi_version: int) -> list[Timing]:
    """Wall times of 1 s of the motionless experiment, which contains a whole collision.

    "run" is the whole call of the master (making, initialising, stepping and freeing instances, copying traces);
    "stepping" is its loop alone. The FMUs' shares come from separate, profiled runs.
    """
    scenario = experiments.get("motionless").scenario("magnetic")
    scenario = dataclasses.replace(scenario, duration_s=SIMULATED_S, fmi_version=fmi_version)
    simulate(scenario)  # unpacks the FMUs, imports FMPy
    parts: dict[str, list[float]] = {"run": [], "stepping": [], "testbed FMU": [], "controller FMU": []}
    for _ in range(repeats):
        started = time.perf_counter()
        record = simulate(scenario)
        parts["run"].append(time.perf_counter() - started)
        parts["stepping"].append(record.wall_s)
        profiled = simulate(scenario, profile=True)
        for model, wall in profiled.step_wall_s.items():
            parts[f"{model} FMU"].append(wall)
    return [Timing(name, 1e3 * min(times), 1e3 * statistics.median(times)) for name, times in parts.items()]
