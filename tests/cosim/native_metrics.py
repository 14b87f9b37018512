"""The batch library's metrics of any traces, through the probe library of tests/fmu/batch."""

from __future__ import annotations

import ctypes
import functools
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from giveway import batch
from giveway.scenario.body_regions import BodyRegion


@functools.cache
def _library() -> ctypes.CDLL:
    build = Path(os.environ.get("GIVEWAY_TEST_DIR", Path(__file__).parents[2] / "build" / "tests"))
    library = ctypes.CDLL(str(build / "libgiveway_metrics_probe.so"))
    library.metrics_column_count.restype = ctypes.c_size_t
    library.metrics_column.restype = ctypes.c_char_p
    return library


def evaluate(
    traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]], region: BodyRegion | None = None
) -> dict[str, tuple[float, float]]:
    """Value and truth of every metric by name, NaN for what did not happen; traces that are missing are 0."""
    library = _library()
    names = [library.metrics_column(ctypes.c_size_t(i)).decode() for i in range(library.metrics_column_count())]
    nothing = np.zeros(traces.sizes["time"])
    table = np.ascontiguousarray([traces[n].values if n in traces else nothing for n in names], dtype=float).T.copy()
    testbed, controller = parameters["testbed"], parameters["controller"]
    row = np.array([
        testbed["wheel.radius"],
        testbed["wheel.distance"],
        controller["estimator.average_window"] * controller["controller.period"],
        testbed["bumper.kind"],
        testbed["bumper.travel"],
        testbed["base.tipping"],
        testbed["base.mass"],
        testbed["base.com_height"],
        testbed["contact.height"],
        testbed["push.height"],
        0.0 if region is None else region.peak_limit_n,
        0.0 if region is None else region.lasting_limit_n,
        min(testbed["electronics.torque_range"], controller["sensor_check.torque_limit"]),
        testbed["drivetrain.torque_limit"],
    ], dtype=float)  # fmt: skip
    metrics = batch.native_metrics()
    value, truth = np.full(len(metrics), math.inf), np.full(len(metrics), math.inf)
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in (row, value, truth)]
    library.metrics_evaluate(ctypes.c_void_p(table.ctypes.data), ctypes.c_size_t(len(table)), *pointers)
    return {metric.name: (float(value[i]), float(truth[i])) for i, metric in enumerate(metrics)}
