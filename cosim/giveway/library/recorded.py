"""Metrics of recorded traces, and the judgement of any force over time, by the batch library."""

from __future__ import annotations

import ctypes
import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.library.batch_library import COLUMN, DTYPES, NONE, OK, SETTING, library
from giveway.robot.variables import Variable, table

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Force", "Windows", "evaluate", "judge_force", "windows"]


class _Traces(ctypes.Structure):
    _fields_ = [
        *((name, ctypes.c_void_p) for name in ("time_s", "columns", "settings")),
        *((name, ctypes.c_uint32) for name in ("rows", "column_count", "setting_count", "reserved")),
        *((name, ctypes.c_double) for name in ("transient_limit_n", "lasting_limit_n")),
    ]


class _Force(ctypes.Structure):
    _fields_ = [
        *((name, ctypes.c_double) for name in ("transient_n", "transient_time_s", "lasting_n", "lasting_time_s")),
        ("longest_contact_s", ctypes.c_double),
        ("lasting_known", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


@dataclass(frozen=True)
class Windows:
    """Windows of the metrics' definitions, s."""

    cause_s: float
    transient_s: float
    contact_gap_s: float
    peak_torque_s: float


@dataclass(frozen=True)
class Force:
    """A contact force over time, as gwb_force_t; a time is None for what was not."""

    transient_n: float
    transient_time_s: float | None
    lasting_n: float
    lasting_time_s: float | None
    longest_contact_s: float
    lasting_known: bool


@functools.cache
def windows() -> Windows:
    """Windows of the metrics' definitions."""
    found = library().windows()
    return Windows(*(getattr(found, field.name) for field in fields(Windows)))


def evaluate(
    time_s: NDArray[np.float64],
    traces: Mapping[str, NDArray[Any]],
    parameters: Mapping[str, Mapping[str, Any]],
    limits_n: tuple[float, float] = (0.0, 0.0),
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Value and truth of every metric of recorded traces, in the order of `native_metrics`; NaN: it did not happen.

    Args:
        time_s: of the rows, s, shape (n,).
        traces: by full name ("testbed.truth.x"), each of shape (n,). What is no input or output is left out.
        parameters: by model; others have their start values.
        limits_n: of the transient and the lasting force of the body region that is hit, N; 0: there is none.
    """
    time_s = np.ascontiguousarray(time_s, dtype=np.float64)
    known = _recordable()
    arrays, columns = [], []
    for name, values in traces.items():
        if name not in known:
            continue
        model, variable = known[name]
        if np.shape(values) != time_s.shape:
            raise GivewayError("traces", f"{name} of shape {np.shape(values)}", f"one value per time, {time_s.shape}")
        arrays.append(np.ascontiguousarray(values, dtype=DTYPES[variable.type]))
        columns.append((model, variable.reference, arrays[-1].ctypes.data))
    settings = [
        (model, variable.reference, float(parameters[name][variable.name]))
        for model, name in enumerate(native.MODELS)
        for variable in table(name).select("parameter")
        if parameters.get(name, {}).get(variable.name) is not None
    ]
    column_array, setting_array = np.array(columns, dtype=COLUMN), np.array(settings, dtype=SETTING)
    data = (time_s.ctypes.data, column_array.ctypes.data, setting_array.ctypes.data)
    recorded = _Traces(*data, len(time_s), len(columns), len(settings), 0, *limits_n)
    result = np.zeros(1, dtype=library().result)
    if library().evaluate(ctypes.byref(recorded), result.ctypes.data) != OK:
        raise _refused(result[0])
    return result["metric"][0], result["truth"][0]


def judge_force(time_s: NDArray[np.float64], force_n: NDArray[np.float64], touch_n: float) -> Force:
    """A contact force over time, N, shape (n,): see `giveway.scenario.body_regions.judge`, which checks its input."""
    time_s, force_n = (np.ascontiguousarray(values, dtype=np.float64) for values in (time_s, force_n))
    found = _Force()
    done = library().judge_force(
        time_s.ctypes.data, force_n.ctypes.data, len(time_s), touch_n, ctypes.byref(found)
    )  # fmt: skip
    assert done
    times = (found.transient_time_s, found.lasting_time_s)
    transient_s, lasting_s = (None if math.isnan(time) else float(time) for time in times)
    forces = (found.transient_n, transient_s, found.lasting_n, lasting_s)
    return Force(*forces, found.longest_contact_s, bool(found.lasting_known))


@functools.cache
def _recordable() -> Mapping[str, tuple[int, Variable]]:
    """Number of the model and variable of every input and output, by full name."""
    return {
        f"{name}.{variable.name}": (model, variable)
        for model, name in enumerate(native.MODELS)
        for variable in table(name)
        if variable.causality in ("input", "output")
    }


def _refused(result: Any) -> GivewayError:
    message = result["message"].decode()
    if result["reference"] == NONE:
        return GivewayError("traces", message, "what a run records")
    model = native.MODELS[result["model"]]
    variable = next(v for v in table(model) if v.reference == result["reference"])
    if variable.causality == "parameter":
        return GivewayError(f"{model}.{variable.name}", float(result["value"]), variable.allowed)
    return GivewayError("traces", f"a run without {model}.{variable.name}", "all that a run records")
