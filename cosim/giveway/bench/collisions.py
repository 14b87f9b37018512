"""Collisions per second with FMPy, ecos, the batch library (event-exact and with fixed steps) and MuJoCo; and errors.

Runs are the motionless experiment's first 0.6 s: the hit, the detection and the start of the escape, with three wheels
on bristle rollers, the 2 kHz servos and the 1 kHz controller. The other engines are in a separate environment that
`make bench` prepares (bench/ in the repository); without it their lines say so.
"""

from __future__ import annotations

import dataclasses
import functools
import json
import os
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway import batch, experiments
from giveway.base import native
from giveway.base.errors import FileError
from giveway.robot.presets import PAPER
from giveway.robot.variables import table
from giveway.scenario.random_collisions import random_collisions
from giveway.simulation.runner import run

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

    from giveway.scenario.scenario import Scenario

__all__ = [
    "ACCURACY_HEADER",
    "ACCURACY_RUNS",
    "HEADER",
    "SCALE_COUNTS",
    "SCALE_HEADER",
    "SIMULATED_S",
    "accuracy",
    "measure",
    "scale",
    "scale_name",
]

SIMULATED_S = 0.6
FMPY_RUNS, EXACT_RUNS, FIXED_RUNS = 5, 20, 400
HEADER = ("way", "best (runs/s)", "median (runs/s)", "plant step (ms)", "peak force error", "times MuJoCo")
SLOWEST_PERIOD_S = 0.01
TOOLS = "GIVEWAY_BENCH_TOOLS"
_ECOS = {"real": "real", "integer": "int", "boolean": "bool"}

ACCURACY_RUNS = 2000
ACCURACY_SEED = 1
ACCURACY_HEADER = ("of all designs", "")
SCALE_HEADER = ("designs", "runs/s", "s", "memory so far (MB)")
SCALE_COUNTS = (1000, 10_000, 100_000, 1_000_000)
SCALE_DESIGNS, SCALE_PORTION = 1000, 10_000
SCALE_LONGEST_S = 1500.0


@dataclass
class _Way:
    """One way to run a number of collisions, the measured rates, and peak force and plant step of one collision."""

    name: str
    runs: int
    run: Callable[[], tuple[float, float]]  # N, s (0: adaptive)
    rates: list[float] = dataclasses.field(default_factory=list)
    peak_n: float = np.nan
    step_s: float = 0.0

    def go(self) -> None:
        started = time.perf_counter()
        self.peak_n, self.step_s = self.run()
        self.rates.append(self.runs / (time.perf_counter() - started))


def collision() -> Scenario:
    """The collision that is repeated."""
    scenario = experiments.get("motionless").scenario("magnetic")
    return dataclasses.replace(scenario, duration_s=SIMULATED_S)


def measure(repeats: int) -> list[tuple[str, ...]]:
    """Rows of `HEADER`: runs per second with all metrics and no traces, best and median of ``repeats``."""
    scenario = collision()
    run(scenario)  # unpacks the FMUs, imports FMPy
    ways = [
        _Way("FMPy loop", FMPY_RUNS, functools.partial(_fmpy_loop, scenario)),
        *(_fixed_or_exact(scenario, "event-exact", None, threads) for threads in (1, 2)),
        *(_fixed_or_exact(scenario, "fixed-step", lanes, 1) for lanes in batch.LANES if lanes <= batch.widest_lanes()),
        _fixed_or_exact(scenario, "fixed-step", batch.widest_lanes(), 2),
    ]
    idle = dataclasses.replace(scenario, controller={**scenario.controller, "controller.period": SLOWEST_PERIOD_S})
    without = _fixed_or_exact(idle, "fixed-step", batch.widest_lanes(), 1)
    for _ in range(repeats):  # alternately, so that other load slows all of them
        for way in (*ways, without):
            way.go()
    exact_n = ways[1].peak_n
    engines = {name: _engine(name, repeats) for name in ("ecos", "mujoco")}
    mujoco = engines["mujoco"]
    reference = float(mujoco["runs_per_s"]) if mujoco else None
    rows = [_row(way, exact_n, reference) for way in ways]
    rows.insert(1, _engine_row("ecos loop, loaded once", engines["ecos"], reference))
    name = "mujoco.rollout, 1 thread" + (f" ({mujoco['version']}, no controller, no sensors)" if mujoco else "")
    rows.append(_engine_row(name, mujoco, reference))
    widest = ways[-2]
    # The share of the controller's cost that remains at a tenth of its rate counts as the controller's.
    share = (1.0 - max(widest.rates) / max(without.rates)) / (1.0 - 1e-3 / SLOWEST_PERIOD_S)
    rows.append((f"the controller's share of {widest.name}", f"{100.0 * share:.0f} %", "", "", "", ""))
    return rows


def _fmpy_loop(scenario: Scenario) -> tuple[float, float]:
    for _ in range(FMPY_RUNS):
        result = run(scenario)
    peak_n = result.metric("peak force of the run").value
    return np.nan if peak_n is None else peak_n, 0.0


def _fixed_or_exact(scenario: Scenario, method: str, lanes: int | None, threads: int) -> _Way:
    runs = EXACT_RUNS if method == "event-exact" else FIXED_RUNS
    prepared = batch.Prepared([scenario] * runs)
    name = method if lanes is None else f"{method}, {lanes} lane{'s' if lanes > 1 else ''}"
    plural = "s" if threads > 1 else ""

    def run() -> tuple[float, float]:
        found = prepared.run(threads=threads, method=method, lanes=lanes)
        return float(found["peak force of the run"][0]), float(found["plant step"][0])

    return _Way(f"{name}, {threads} thread{plural}", runs, run)


def _row(way: _Way, exact_n: float, mujoco: float | None) -> tuple[str, ...]:
    step = f"{1e3 * way.step_s:.4g}" if way.step_s > 0.0 else "adaptive"
    error = f"{abs(way.peak_n / exact_n - 1.0):.1e}"
    best = max(way.rates)
    times = "" if mujoco is None else f"{best / mujoco:.1f}"
    return (way.name, f"{best:.0f}", f"{float(np.median(way.rates)):.0f}", step, error, times)


def _engine_row(name: str, found: dict[str, float] | None, mujoco: float | None) -> tuple[str, ...]:
    if found is None:
        return (f"{name}: not here; `make bench` prepares it", "", "", "", "", "")
    step = f"{1e3 * found['step_s']:.4g}" if "step_s" in found else "adaptive"
    times = "" if mujoco is None else f"{found['runs_per_s'] / mujoco:.1f}"
    return (name, f"{found['runs_per_s']:.0f}", "", step, "", times)


def _engine(name: str, repeats: int) -> dict[str, float] | None:
    """The output of another engine's script; None if its environment is missing."""
    tools = os.environ.get(TOOLS)
    if not tools:
        return None
    scripts = {"ecos": ("ecos_loop.py", [str(native.batch_library().parent)]), "mujoco": ("mujoco_rollout.py", [])}
    script, arguments = scripts[name]
    file = Path(tools) / script
    if not file.is_file():
        raise FileError(file, "is not there", f"{TOOLS} names the folder bench of the repository")
    python = file.parents[1] / "build" / "bench" / "tools" / "bin" / "python"
    command = [str(python), str(file), *arguments, str(SIMULATED_S), str(max(repeats, 3))]
    connections = json.dumps(_connections())
    done = subprocess.run(command, input=connections, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise FileError(file, f"failed: {done.stderr.strip().splitlines()[-1] if done.stderr else 'no message'}")
    return dict(json.loads(done.stdout.splitlines()[-1]))


def _connections() -> list[tuple[str, str, str]]:
    """Outputs of one model that are inputs of the other: kind, source and target with ecos' names."""
    pairs = (("testbed", "controller"), ("controller", "testbed"))
    return [
        (_ECOS[variable.type], f"{source}::{variable.name}", f"{target}::{variable.name}")
        for source, target in pairs
        for variable in table(target)
        if variable.causality == "input"
        and any(other.name == variable.name and other.causality == "output" for other in table(source))
    ]


def detection_rows(found: xarray.Dataset) -> NDArray[np.float64]:
    """Time of each detection, ms since the start, rounded to milliseconds; NaN without one."""
    return np.asarray(np.round(found["detection time"].values + 1e3 * found["contact time"].values))


def accuracy(count: int = ACCURACY_RUNS, seed: int = ACCURACY_SEED) -> tuple[list[tuple[str, str]], list[str]]:
    """Rows of `ACCURACY_HEADER` for ``count`` random collisions, and one line for each detected on another tick."""
    # The plants are compared; a reflex that decides on the first samples of a hit may see another encoder count first.
    scenarios = random_collisions(count, seed, preset=PAPER)
    exact = batch.run_many(scenarios)
    fixed = batch.run_many(scenarios, method="fixed-step")
    hit = exact["peak force of the run"].values > 0.0
    error = np.abs(fixed["peak force of the run"].values[hit] / exact["peak force of the run"].values[hit] - 1.0)
    ticks = detection_rows(fixed) - detection_rows(exact)
    one_only = np.isnan(detection_rows(fixed)) != np.isnan(detection_rows(exact))
    off = np.flatnonzero((np.nan_to_num(ticks) != 0.0) | one_only)
    steps, counts = np.unique(fixed["plant step"].values, return_counts=True)
    rows = [
        ("designs; with a collision; detected", f"{count}; {hit.sum()}; {np.isfinite(detection_rows(exact)).sum()}"),
        ("peak force error: median, 99 %, largest", ", ".join(f"{value:.1e}" for value in _quantiles(error))),
        ("designs above 0.5 %", f"{(error > 0.005).sum()}"),
        ("detected on another tick", f"{len(off)} ({100.0 * len(off) / count:.2f} %)"),
        ("contact time error, largest", f"{1e6 * _largest(fixed, exact, 'contact time'):.2f} us"),
        ("energy residual: median, 99 %, largest", _spread(fixed["energy residual"].values)),
        ("event-exact: the same", _spread(exact["energy residual"].values)),
        *(
            (f"steps of {1e3 * step:.4g} ms" if step > 0.0 else "event-exact instead", f"{number}")
            for step, number in zip(steps, counts, strict=True)
        ),
    ]
    lines = [
        f"design {index}: {scenarios[index].bumper}, peak force {float(exact['peak force of the run'][index]):.1f} N, "
        f"detected after {float(fixed['detection time'][index]):.1f} ms, event-exact after "
        f"{float(exact['detection time'][index]):.1f} ms"
        for index in off
    ]
    return rows, lines


def _quantiles(values: NDArray[np.float64]) -> tuple[float, float, float]:
    return float(np.median(values)), float(np.quantile(values, 0.99)), float(values.max())


def _spread(values: NDArray[np.float64]) -> str:
    return ", ".join(f"{value:.1e}" for value in _quantiles(values))


def _largest(a: xarray.Dataset, b: xarray.Dataset, name: str) -> float:
    return float(np.nanmax(np.abs(a[name].values - b[name].values)))


def scale_name(count: int) -> str:
    """What `scale` calls a count when it reports its progress."""
    return f"{count:,} designs"


def scale(counts: Sequence[int], progress: Callable[[str, float], None] | None = None) -> Iterator[tuple[str, ...]]:
    """Rows of `SCALE_HEADER`: given numbers of random collisions with fixed steps on all processors.

    A row is yielded as soon as it is known. The designs repeat after `SCALE_DESIGNS`, and are passed in portions of
    `SCALE_PORTION`, so memory does not grow with their number; each is computed. A count that would take longer than
    `SCALE_LONGEST_S` at the previous rate is left out. ``progress`` gets a count's name and the finished share.
    Ctrl-C ends it at once with KeyboardInterrupt.
    """
    designs = random_collisions(SCALE_DESIGNS, ACCURACY_SEED)
    rate = 0.0
    for count in counts:
        if rate > 0.0 and count / rate > SCALE_LONGEST_S:
            yield (f"{count:,}", "left out", f"{count / rate:.0f} expected", "")
            continue
        portion = min(count, SCALE_PORTION)
        prepared = batch.Prepared([designs[index % SCALE_DESIGNS] for index in range(portion)])
        started = time.perf_counter()
        for before in range(0, count, portion):

            def report(done: int, _runs: int, before: int = before, count: int = count) -> None:
                if progress is not None:
                    progress(scale_name(count), (before + done) / count)

            if prepared.run(method="fixed-step", progress=report).attrs["interrupted"]:
                raise KeyboardInterrupt
        elapsed = time.perf_counter() - started
        rate = count / elapsed
        import resource

        memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        yield (f"{count:,}", f"{rate:.0f}", f"{elapsed:.1f}", f"{memory_mb:.0f}")
