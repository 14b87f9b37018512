"""One call of the batch library for one part of a study: arrays in, arrays out, no scenario per run."""

from __future__ import annotations

import ctypes
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import SimulationError
from giveway.library.batch_library import MESSAGE_SIZE, SETTING, SPEC, THREADS_MAX, ProgressCounts, library, options
from giveway.study.runs import RunTable

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["NativePart", "default_threads"]


def default_threads() -> int:
    """One per processor that this process may use."""
    return min(len(os.sched_getaffinity(0)), THREADS_MAX)


class NativePart:
    """Runs of one part. ``values`` has shape (runs, columns), ``case`` shape (runs,)."""

    def __init__(self, table: RunTable, values: NDArray[np.float64], case: NDArray[np.int64]) -> None:
        self._library = library()
        count, used = len(values), table.used
        self._settings = np.zeros((count, len(used)), dtype=SETTING)
        self._settings["model"] = table.columns.model[used]
        self._settings["reference"] = table.columns.reference[used]
        self._settings["value"] = values[:, used]
        self._specs = np.zeros(count, dtype=SPEC)
        self._specs["setting_count"] = len(used)
        self._specs["settings"] = self._settings.ctypes.data + np.arange(count) * self._settings.strides[0]
        for index, one in enumerate(table.cases):
            mine = case == index
            self._specs["step_s"][mine] = one.case.scenario.step_s
            self._specs["step_count"][mine] = one.case.scenario.steps
            if (region := one.case.scenario.judged) is not None:
                self._specs["transient_limit_n"][mine] = region.peak_limit_n
                self._specs["lasting_limit_n"][mine] = region.lasting_limit_n
            for field, values_ in (("plan", one.plan), ("push", one.push)):
                if values_ is not None:
                    self._specs[field][mine] = values_.ctypes.data
                    self._specs[f"{field}_rows"][mine] = len(values_)
        self._table = table  # plans and pushes must live as long as the runs
        self.results = np.zeros(count, dtype=self._library.result)
        self._handle = ctypes.c_void_p()

    def start(self, threads: int, method: str, plant_step_s: float | None) -> None:
        """Begin; `finish` must follow, whatever happens. A call of its own, so that Ctrl-C cannot lose the handle."""
        message = ctypes.create_string_buffer(MESSAGE_SIZE)
        chosen = ctypes.byref(options(threads, method, None, plant_step_s))
        started = self._library.start(
            self._specs.ctypes.data,
            len(self._specs),
            chosen,
            self.results.ctypes.data,
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
