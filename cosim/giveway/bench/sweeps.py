"""What a study costs beside its runs: the same designs in the batch library, as a study, and on workers of Dask."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.files import scratch_folder
from giveway.library.work import RunningWork, default_threads
from giveway.study import Study
from giveway.study.engine import Progress, plan_runs, sweep

if TYPE_CHECKING:
    from giveway.study.setup import Setup

__all__ = ["DESIGNS", "HEADER", "ROUNDS", "Found", "measure", "names"]

DESIGNS, ROUNDS = 32_768, 3
HEADER = ("way", "runs/s", "of the batch library", "of the study in threads")
PORTION = 8192
MILLION, BILLION = 10**6, 10**9
HOUR_S = 3600.0
SHARE = 0.9  # of its processor that the command may need


@dataclass
class Found:
    """Runs/s of each way by round, and what the command took in the last one: s of a processor and bytes per run."""

    rates: dict[str, list[float]] = field(default_factory=dict)
    command_s: float = 0.0
    stored_bytes: float = 0.0

    def rows(self) -> list[tuple[str, ...]]:
        """Rows of `HEADER`: medians, the shares of rates that were measured one after the other."""
        library, threads = list(self.rates)[:2]
        return [
            (
                way,
                f"{np.median(rates):.0f}",
                f"{np.median(np.divide(rates, self.rates[library])):.3f}",
                "" if way == library else f"{np.median(np.divide(rates, self.rates[threads])):.3f}",
            )
            for way, rates in self.rates.items()
        ]

    def in_words(self, threads: int) -> list[str]:
        """What a million and a billion runs cost."""
        last = list(self.rates)[-1]
        core_s = threads / float(np.median(self.rates[last]))
        feeds = SHARE * core_s / self.command_s
        return [
            f"A run takes {1e3 * core_s:.2f} ms of a core, {1e6 * self.command_s:.0f} us of the command's processor, "
            f"{self.stored_bytes:.0f} bytes on the disk; one command can feed {feeds:.0f} cores.",
            *(
                f"{count:,} runs: {count * core_s / HOUR_S:,.2f} core hours, {count * self.command_s / HOUR_S:,.2f} of "
                f"the command, {count * self.stored_bytes / 1e9:,.1f} GB."
                for count in (MILLION, BILLION)
            ),
        ]


def names(threads: int) -> list[str]:
    """What `measure` measures."""
    each = f"{threads} worker{'s' if threads > 1 else ''} of 1 thread"
    return [f"batch library, {threads} threads", f"study, {threads} threads", f"study, --dask local: {each}"]


def setup_of(designs: int) -> Setup:
    """Bumpers of two continuous quantities, hit once: the cheapest runs, so that all else costs the most."""
    study = Study("bench", duration=0.6, bumper="magnetic", method="fixed-step")
    study.collision("front", speed=0.5, mass=9.08, edge=0, time=0.12)
    study.vary("testbed.bumper.latch_force", low=0.0, high=60.0)
    study.vary("testbed.bumper.spring_rate", low=0.6, high=2.4, unit="N/mm")
    return study.designs("sobol", count=designs).objective("detection time").setup()


def measure(
    designs: int = DESIGNS, rounds: int = ROUNDS, progress: Callable[[str, float], None] = lambda name, share: None
) -> Found:
    """Each way in turn, so that other load slows all of them.

    Raises:
        MissingExtraError: Dask is not installed.
    """
    threads, setup = default_threads(), setup_of(designs)
    ways = names(threads)
    runs_alone = _alone(setup, threads)
    found = Found({name: [] for name in ways})
    with scratch_folder("giveway-bench-") as folder:
        for number in range(rounds):
            for way, name in enumerate(ways):
                progress(name, number / rounds)
                if way == 0:
                    found.rates[name].append(runs_alone())
                    continue
                where = folder / f"{number}-{way}" / "study"  # apart: they would share their results
                at: list[tuple[int, float]] = []

                def note(state: Progress, at: list[tuple[int, float]] = at) -> None:
                    at.append((state.done, time.thread_time()))

                outcome = sweep(setup, where, threads=threads, dask="local" if way == 2 else None, progress=note)
                found.rates[name].append(outcome.runs / outcome.wall_s)
                begun = next(one for one in at if one[0] > 0)  # what starts the workers is over
                found.command_s = (at[-1][1] - begun[1]) / (at[-1][0] - begun[0])
                parts = list(where.rglob("part-*.parquet"))
                found.stored_bytes = sum(path.stat().st_size for path in parts) / outcome.runs
                progress(name, (number + 1) / rounds)
    return found


def _alone(setup: Setup, threads: int) -> Callable[[], float]:
    """The runs of the study without anything around them; returns runs/s."""
    table = plan_runs(setup)
    design, sample, case = table.split(np.arange(table.count))
    works = []
    for first in range(0, table.count, PORTION):
        part = slice(first, first + PORTION)
        rows = table.rows(design[part], sample[part], 0)
        works.append(table.work(rows.values, case[part], setup.method, setup.plant_step_s))

    def run() -> float:
        elapsed_s = 0.0
        for work in works:
            running = RunningWork(work)
            started = time.perf_counter()
            try:
                running.start(threads)
                while not running.wait(0.1)[0]:
                    pass
            finally:
                running.finish()
            elapsed_s += time.perf_counter() - started
        return table.count / elapsed_s

    return run
