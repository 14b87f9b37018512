"""The batch library's metrics of any traces, by gwb_evaluate."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from giveway.base import native
from giveway.library import batch_library
from giveway.robot.variables import table
from giveway.scenario.body_regions import BodyRegion

DTYPES = {"real": np.float64, "integer": np.int32, "boolean": np.bool_}


class Column(ctypes.Structure):
    _fields_ = [("model", ctypes.c_uint32), ("reference", ctypes.c_uint32), ("values", ctypes.c_void_p)]


class Setting(ctypes.Structure):
    _fields_ = [("model", ctypes.c_uint32), ("reference", ctypes.c_uint32), ("value", ctypes.c_double)]


class Traces(ctypes.Structure):
    _fields_ = [
        ("time_s", ctypes.c_void_p),
        ("columns", ctypes.c_void_p),
        ("settings", ctypes.c_void_p),
        *((name, ctypes.c_uint32) for name in ("rows", "column_count", "setting_count", "reserved")),
        ("transient_limit_n", ctypes.c_double),
        ("lasting_limit_n", ctypes.c_double),
    ]


@functools.cache
def _library() -> ctypes.CDLL:
    return ctypes.CDLL(str(native.batch_library()))


def evaluate(
    traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]], region: BodyRegion | None = None
) -> dict[str, tuple[float, float]]:
    """Value and truth of every metric by name, NaN for what did not happen; traces that are missing are 0."""
    time_s = np.ascontiguousarray(traces["time"].values, dtype=np.float64)
    arrays, columns, settings = [], [], []
    for model, name in enumerate(native.MODELS):
        for variable in table(name):
            trace = f"{name}.{variable.name}"
            if variable.causality in ("input", "output"):
                values = traces[trace].values if trace in traces else np.zeros(len(time_s))
                arrays.append(np.ascontiguousarray(values, dtype=DTYPES[variable.type]))
                columns.append(Column(model, variable.reference, arrays[-1].ctypes.data))
            elif variable.name in parameters[name]:
                settings.append(Setting(model, variable.reference, float(parameters[name][variable.name])))
    column_array, setting_array = (Column * len(columns))(*columns), (Setting * len(settings))(*settings)
    result = np.zeros(1, dtype=batch_library.library().result)
    one = Traces(
        time_s.ctypes.data,
        ctypes.addressof(column_array),
        ctypes.addressof(setting_array),
        len(time_s),
        len(columns),
        len(settings),
        0,
        0.0 if region is None else region.peak_limit_n,
        0.0 if region is None else region.lasting_limit_n,
    )
    status = _library().gwb_evaluate(ctypes.byref(one), ctypes.c_void_p(result.ctypes.data))
    assert status == batch_library.OK, result["message"][0].decode()
    numbers = zip(result["metric"][0].tolist(), result["truth"][0].tolist(), strict=True)
    return dict(zip((metric.name for metric in batch_library.native_metrics()), numbers, strict=True))
