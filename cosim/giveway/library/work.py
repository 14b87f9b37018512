"""Runs as plain numbers: arrays in, arrays out, no scenario per run, and nothing that another machine could not run."""

from __future__ import annotations

import ctypes
import dataclasses
import hashlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import SimulationError
from giveway.base.system import processors
from giveway.library.batch_library import (
    MESSAGE_SIZE,
    OK,
    SETTING,
    SPEC,
    STATUSES,
    THREADS_MAX,
    ProgressCounts,
    library,
    native_metrics,
    options,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["CaseWork", "Done", "RunningWork", "Work", "default_threads", "result_columns", "run_work"]

WAIT_S = 0.1


def default_threads() -> int:
    """One per processor that this process may use."""
    return min(processors(), THREADS_MAX)


def result_columns() -> list[tuple[str, str]]:
    """Name and unit of every number that the library gives back per run.

    A plant step of 0: that run was done event-exact, whatever the method.
    """
    found = [("simulated", "s"), ("plant step", "s")]
    for metric in native_metrics():
        found.append((metric.name, metric.unit))
        if metric.has_truth:
            found.append((f"{metric.name} (true)", metric.unit))
    return found


@dataclass(frozen=True)
class CaseWork:
    """What runs share: steps, limits of the force (0: none), tables of plan and pushes."""

    step_s: float
    steps: int
    transient_limit_n: float
    lasting_limit_n: float
    plan: NDArray[np.float64] | None
    push: NDArray[np.float64] | None


@dataclass(frozen=True)
class Work:
    """Some runs.

    Attributes:
        cases: what they share; ``case`` (n,) says which.
        model, reference: of the parameters that are set, (settings,).
        common: their values, (settings,), but those of the settings ``differing``, which
        values: has for each run, (n, differing).
        method, plant_step_s: one of `batch_library.METHODS`; None: as each run needs.
    """

    cases: tuple[CaseWork, ...]
    case: NDArray[np.int64]
    model: NDArray[np.uint32]
    reference: NDArray[np.uint32]
    common: NDArray[np.float64]
    differing: NDArray[np.int64]
    values: NDArray[np.float64]
    method: str
    plant_step_s: float | None

    def __len__(self) -> int:
        return len(self.case)

    def only(self, where: NDArray[np.int64]) -> Work:
        """Some of the runs."""
        return dataclasses.replace(self, case=self.case[where], values=self.values[where])


@dataclass(frozen=True)
class Done:
    """What became of runs: ``status`` (n,), ``numbers`` (n, `result_columns`), and why those failed that did."""

    status: NDArray[np.uint32]
    numbers: NDArray[np.float64]
    messages: dict[int, str]

    def only(self, where: NDArray[np.int64]) -> Done:
        """Of some of the runs."""
        said = {at: self.messages[run] for at, run in enumerate(where.tolist()) if run in self.messages}
        return Done(self.status[where], self.numbers[where], said)

    def digest(self) -> str:
        """Hash of every bit."""
        found = hashlib.blake2b(self.status.astype("<u4").tobytes(), digest_size=16)
        found.update(self.numbers.astype("<f8").tobytes())
        found.update(repr([STATUSES, sorted(self.messages.items())]).encode())
        return found.hexdigest()


class RunningWork:
    """Runs in native threads."""

    def __init__(self, work: Work) -> None:
        self._library = library()
        self._work = work
        count, used = len(work), len(work.model)
        values = np.repeat(work.common[None, :], count, axis=0)
        values[:, work.differing] = work.values
        self._settings = np.zeros((count, used), dtype=SETTING)
        self._settings["model"] = work.model
        self._settings["reference"] = work.reference
        self._settings["value"] = values
        self._specs = np.zeros(count, dtype=SPEC)
        self._specs["setting_count"] = used
        self._specs["settings"] = self._settings.ctypes.data + np.arange(count) * self._settings.strides[0]
        for index, one in enumerate(work.cases):
            mine = work.case == index
            self._specs["step_s"][mine] = one.step_s
            self._specs["step_count"][mine] = one.steps
            self._specs["transient_limit_n"][mine] = one.transient_limit_n
            self._specs["lasting_limit_n"][mine] = one.lasting_limit_n
            for field, table in (("plan", one.plan), ("push", one.push)):
                if table is not None:
                    self._specs[field][mine] = table.ctypes.data
                    self._specs[f"{field}_rows"][mine] = len(table)
        self._results = np.zeros(count, dtype=self._library.result)
        self._handle = ctypes.c_void_p()

    def start(self, threads: int) -> None:
        """Begin; `finish` must follow, whatever happens. A call of its own, so that Ctrl-C cannot lose the handle."""
        message = ctypes.create_string_buffer(MESSAGE_SIZE)
        chosen = ctypes.byref(options(threads, self._work.method, None, self._work.plant_step_s))
        started = self._library.start(
            self._specs.ctypes.data,
            len(self._specs),
            chosen,
            self._results.ctypes.data,
            ctypes.byref(self._handle),
            message,
        )
        if not started:
            raise SimulationError("batch library", message.value.decode(), 0.0)

    def wait(self, timeout_s: float) -> tuple[bool, int]:
        """Whether all is done after at most ``timeout_s``, and how many runs are."""
        progress: Any = ProgressCounts()
        done = bool(self._library.wait(self._handle, timeout_s, ctypes.byref(progress)))
        return done, int(progress.runs_done)

    def finish(self) -> None:
        """Cancel what is not done and free the batch; no thread writes to the arrays any more."""
        self._library.finish(self._handle)
        self._handle = ctypes.c_void_p()

    def done(self) -> Done:
        """The results, after `finish`."""
        results = self._results
        columns = [results["time_s"], results["plant_step_s"]]
        for index, metric in enumerate(native_metrics()):
            columns.append(results["metric"][:, index])
            if metric.has_truth:
                columns.append(results["truth"][:, index])
        numbers = np.stack(columns, axis=1)
        numbers[np.isnan(numbers)] = np.nan  # processors differ in the bits of theirs
        said = {int(run): results["message"][run].decode() for run in np.flatnonzero(results["status"] != OK)}
        return Done(results["status"].copy(), numbers, said)


def run_work(work: Work, threads: int = 1) -> Done:
    """Run all of ``work`` and wait for it."""
    running = RunningWork(work)
    try:
        running.start(threads)
        while not running.wait(WAIT_S)[0]:
            pass
    finally:
        running.finish()
    return running.done()
