"""The batch library through its C header: layouts of its arrays, what it measures, and how it may be asked to run."""

from __future__ import annotations

import ctypes
import functools
import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from giveway.base import native
from giveway.base.checks import finite
from giveway.base.errors import FileError, GivewayError, UnknownNameError
from giveway.robot.variables import table

__all__ = [
    "COLUMN",
    "LANES",
    "METHODS",
    "SETTING",
    "SPEC",
    "STATUSES",
    "THREADS_MAX",
    "Library",
    "Options",
    "ProgressCounts",
    "library",
    "native_metrics",
    "options",
    "widest_lanes",
]

METHODS = ("event-exact", "fixed-step")
LANES = (1, 4, 8)
PLANT_STEP_RANGE_S = (1e-6, 5e-4)
STATUSES = ("ok", "cancelled", "wrong", "refused", "failed", "no memory")
OK, CANCELLED, WRONG, REFUSED = 0, 1, 2, 3
NONE = 2**32 - 1  # no model, no reference
MESSAGE_SIZE = 512
OF_COLLISION, OF_DESIGN, OF_FREE_RUN = 1, 2, 4  # where a metric is shown
THREADS_MAX = 1024

DTYPES: Mapping[str, Any] = {"real": np.float64, "integer": np.int32, "boolean": np.bool_}
_POINTER = np.uintp
SETTING = np.dtype([("model", "u4"), ("reference", "u4"), ("value", "f8")], align=True)
COLUMN = np.dtype([("model", "u4"), ("reference", "u4"), ("values", _POINTER)], align=True)
SPEC = np.dtype(
    [
        ("step_s", "f8"),
        ("step_count", "u4"),
        ("setting_count", "u4"),
        ("settings", _POINTER),
        ("plan", _POINTER),
        ("push", _POINTER),
        ("plan_rows", "u4"),
        ("push_rows", "u4"),
        ("columns", _POINTER),
        ("column_count", "u4"),
        ("reserved", "u4"),
        ("transient_limit_n", "f8"),
        ("lasting_limit_n", "f8"),
    ],
    align=True,
)


class _MetricInfo(ctypes.Structure):
    _fields_ = [
        ("name", ctypes.c_char_p),
        ("unit", ctypes.c_char_p),
        ("has_truth", ctypes.c_uint32),
        ("decimals", ctypes.c_int32),
        ("shown", ctypes.c_uint32),
        ("line", ctypes.c_uint32),
        ("description", ctypes.c_char_p),
    ]


class _Variable(ctypes.Structure):
    _fields_ = [
        ("model", ctypes.c_uint32),
        ("reference", ctypes.c_uint32),
        ("type", ctypes.c_uint32),
        ("causality", ctypes.c_uint32),
        ("minimum", ctypes.c_double),
        ("maximum", ctypes.c_double),
        ("name", ctypes.c_char_p),
    ]


class Options(ctypes.Structure):
    _fields_ = [
        ("threads", ctypes.c_uint32),
        ("method", ctypes.c_uint32),
        ("lanes", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("plant_step_s", ctypes.c_double),
    ]


class WindowsInHeader(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in ("cause_s", "transient_s", "contact_gap_s", "peak_torque_s")]


class ProgressCounts(ctypes.Structure):
    _fields_ = [(name, ctypes.c_uint64) for name in ("runs_done", "runs", "steps_done", "steps")]


class ReplayCalls(NamedTuple):
    start: Callable[..., int]
    steps: Callable[..., int]
    finish: Callable[..., None]


@dataclass(frozen=True)
class NativeMetric:
    """A line of GWB_METRICS: `shown` is a sum of ``OF_COLLISION``, ``OF_DESIGN`` and ``OF_FREE_RUN``."""

    name: str
    unit: str
    has_truth: bool
    decimals: int | None
    shown: int
    line: int
    description: str


@dataclass(frozen=True)
class _Model:
    """One model inside the library, for the manifest."""

    path: Path
    token: str
    sha256: str


class Library:
    """The loaded library: its functions, its metrics, and the layout of its results."""

    def __init__(self, path: Path) -> None:
        try:
            self._dll = ctypes.CDLL(str(path))
        except OSError as error:
            raise FileError(path, f"cannot be loaded: {error}") from None
        pointer, size, number = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint32
        self._function("gwb_token", ctypes.c_char_p, number)
        self._function("gwb_find_variable", ctypes.c_int, number, ctypes.c_char_p, pointer)
        self._function("gwb_metric_info", ctypes.c_int, number, pointer)
        self._function("gwb_metric_count", number)
        self.start = self._function(
            "gwb_start", ctypes.c_int, pointer, size, pointer, pointer, pointer, ctypes.c_char_p
        )
        self.wait = self._function("gwb_wait", ctypes.c_int, pointer, ctypes.c_double, pointer)
        self.cancel = self._function("gwb_cancel", None, pointer)
        self.widest_lanes = self._function("gwb_widest_lanes", number)
        self.finish = self._function("gwb_finish", None, pointer)
        self.run_up = self._function("gwb_run_up", size, pointer, size)
        self.evaluate = self._function("gwb_evaluate", number, pointer, pointer)
        force = (pointer, pointer, size, ctypes.c_double, pointer)
        self.judge_force = self._function("gwb_judge_force", ctypes.c_int, *force)
        self.windows = self._function("gwb_windows", WindowsInHeader)
        sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
        self.models: dict[str, _Model] = {}
        for number_of_model, model in enumerate(native.MODELS):
            self._check_matches(path, number_of_model, model)
            self.models[model] = _Model(path, self._dll.gwb_token(number_of_model).decode(), sha256)
        self.metrics = [self._metric(index) for index in range(self._dll.gwb_metric_count())]
        metric_count = len(self.metrics)
        self.result = np.dtype(
            [
                ("status", "u4"),
                ("model", "u4"),
                ("reference", "u4"),
                ("rows", "u4"),
                ("method", "u4"),
                ("reserved", "u4"),
                ("time_s", "f8"),
                ("plant_step_s", "f8"),
                ("value", "f8"),
                ("minimum", "f8"),
                ("maximum", "f8"),
                ("metric", "f8", (metric_count,)),
                ("truth", "f8", (metric_count,)),
                ("message", f"S{MESSAGE_SIZE}"),
            ],
            align=True,
        )

    @functools.cached_property
    def replay(self) -> ReplayCalls:
        """gwb_replay_start, gwb_replay_steps and gwb_replay_finish."""
        pointer, number = ctypes.c_void_p, ctypes.c_uint32
        begin = (pointer, number, ctypes.c_double, pointer, ctypes.c_char_p)
        return ReplayCalls(
            self._function("gwb_replay_start", ctypes.c_int, *begin),
            self._function("gwb_replay_steps", number, pointer, pointer, number, number, pointer),
            self._function("gwb_replay_finish", None, pointer),
        )

    def _function(self, name: str, returns: Any, *arguments: Any) -> Callable[..., Any]:
        function = getattr(self._dll, name)
        function.restype, function.argtypes = returns, arguments
        return function  # type: ignore[no-any-return]

    def _check_matches(self, path: Path, number: int, model: str) -> None:
        """Refuse a library that was built from another variable table: its references would have other meanings."""
        for variable in table(model):
            found = _Variable()
            known = self._dll.gwb_find_variable(number, variable.name.encode(), ctypes.byref(found))
            if not known or found.reference != variable.reference:
                reason = f"was built from another variable table: {model}.{variable.name} differs"
                raise FileError(path, reason, "build the library and the tables together")

    def _metric(self, index: int) -> NativeMetric:
        info = _MetricInfo()
        self._dll.gwb_metric_info(index, ctypes.byref(info))
        return NativeMetric(
            name=info.name.decode(),
            unit=info.unit.decode(),
            has_truth=bool(info.has_truth),
            decimals=None if info.decimals < 0 else info.decimals,
            shown=info.shown,
            line=info.line,
            description=info.description.decode(),
        )


def library() -> Library:
    path = native.batch_library()
    return _load(path, path.stat().st_mtime_ns)


@functools.cache
def _load(path: Path, _modified_ns: int) -> Library:
    return Library(path)


def native_metrics() -> list[NativeMetric]:
    """The library's metrics with units, in the order of its results."""
    return library().metrics


def widest_lanes() -> int:
    """Designs that this processor computes side by side: 8 with AVX-512, 4 with AVX2, otherwise 1."""
    return int(library().widest_lanes())


def options(threads: int, method: str, lanes: int | None, plant_step_s: float | None) -> Options:
    if method not in METHODS:
        raise UnknownNameError("method", method, METHODS)
    if method == "event-exact":
        for name, value in (("lanes", lanes), ("plant_step_s", plant_step_s)):
            if value is not None:
                raise GivewayError(name, value, "none with the method event-exact")
        return Options(threads=threads)
    widest = widest_lanes()
    possible = [number for number in LANES if number <= widest]
    if lanes is not None and lanes not in possible:
        raise GivewayError("lanes", lanes, f"one of {', '.join(map(str, possible))} on this processor")
    if plant_step_s is not None:
        finite("plant_step_s", plant_step_s, *PLANT_STEP_RANGE_S, "s")
    return Options(threads, METHODS.index(method), lanes or widest, 0, plant_step_s or 0.0)
