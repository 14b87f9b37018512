"""`python -m web.bench`: size of giveway_batch.wasm, its time per simulated second beside the native one, and how soon
the studio answers."""

from __future__ import annotations

import gzip
import statistics
import time
from collections.abc import Callable
from typing import Any

import giveway
from giveway.base import native
from giveway.base.terminal import print_columns
from giveway.library import batch_library
from giveway.scenario.scenario import Scenario
from giveway.simulation.native_engine import NativeRuns

from web.bench_studio import MOVES, answer_times_ms, quantiles_ms
from web.engines import LIBRARY, Chromium, Node, module, spec_of

TIMES = 40
WARM_UP = 10  # an engine compiles what runs often once more
METHODS = ("event-exact", "fixed-step")


def native_times(scenario: Scenario, method: str) -> list[float]:
    """Milliseconds of each run, one design at a time as in the engines."""
    parameters = [{model: scenario.parameters(model) for model in native.MODELS}]
    runs = NativeRuns([scenario], parameters, [])
    chosen = batch_library.options(1, method, None if method == "event-exact" else 1, None)
    found = []
    for _ in range(TIMES):
        began = time.perf_counter()
        runs.execute(chosen, lambda _: None)
        found.append(1e3 * (time.perf_counter() - began))
    return found


def main() -> None:
    wasm, script = module().read_bytes(), LIBRARY.read_bytes()
    sizes = [
        (name, f"{len(data) / 1e3:.0f}", f"{len(gzip.compress(data, 9)) / 1e3:.0f}")
        for name, data in (("giveway_batch.wasm", wasm), (LIBRARY.name, script))
    ]
    print_columns("The batch library for browsers", ("file", "kB", "gzip, kB"), sizes)
    scenario = giveway.experiment("motionless").scenario("magnetic")
    engines: dict[str, Callable[[str], Any]] = {
        "native": lambda method: native_times(scenario, method),
        "Node": lambda method: Node().call("time", spec_of(scenario, [], method), TIMES),
        "Chromium": lambda method: Chromium().call("time", spec_of(scenario, [], method), TIMES),
    }
    rows = []
    for name, times in engines.items():
        medians = [statistics.median(times(method)[WARM_UP:]) / scenario.duration_s for method in METHODS]
        rows.append((name, *(f"{median:.1f}" for median in medians)))
    print_columns("One collision alone, ms per simulated second", ("engine", *METHODS), rows)
    median, late = quantiles_ms(answer_times_ms())
    moves = [("studio, 0.6 s with the default controller", f"{median:.0f}", f"{late:.0f}")]
    print_columns(f"From a slider's move to new curves, ms, {MOVES} moves", ("page", "median", "95 %"), moves)


if __name__ == "__main__":
    main()
