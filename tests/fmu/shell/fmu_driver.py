"""Calls an FMU's functions one by one, the same way for both FMI versions, and keeps status and messages.

FMPy hides the status codes behind exceptions and takes care of the call order; these tests want neither.
"""

from __future__ import annotations

import copy
import ctypes
import functools
import math
import os
from collections.abc import Sequence
from pathlib import Path

import fmpy
from fmpy.model_description import ModelDescription

ROOT = Path(__file__).parents[3]
BUILD = Path(os.environ.get("GIVEWAY_BUILD_DIR", ROOT / "build"))
MODELS = ("controller", "testbed", "drivetrain", "bumper")
INTEGRATED = ("testbed", "drivetrain", "bumper")  # with SUNDIALS inside, and Model Exchange

OK, ERROR = 0, 3
BINARY_FOLDERS = {2: "linux64", 3: "x86_64-linux"}

_LOGGERS = {
    # environment, instance name, status, category, message (a printf format)
    2: ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p),
    # environment, status, category, message
    3: ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p),
}
_TYPES = {
    2: {"real": ("Real", ctypes.c_double), "integer": ("Integer", ctypes.c_int), "boolean": ("Boolean", ctypes.c_int)},
    3: {
        "real": ("Float64", ctypes.c_double),
        "integer": ("Int32", ctypes.c_int32),
        "boolean": ("Boolean", ctypes.c_bool),
    },
}
_TYPE_NAMES = {"Real": "real", "Float64": "real", "Integer": "integer", "Int32": "integer", "Boolean": "boolean"}


def fmu_path(model: str, version: int) -> Path:
    """Where the build leaves an FMU."""
    folder = BUILD / ("tests" if model == "lag" else "fmus")
    return folder / f"giveway_{model}_fmi{version}.fmu"


class _Fmi2Callbacks(ctypes.Structure):
    _fields_ = [
        ("logger", _LOGGERS[2]),
        ("allocate", ctypes.c_void_p),
        ("free", ctypes.c_void_p),
        ("step_finished", ctypes.c_void_p),
        ("environment", ctypes.c_void_p),
    ]


class _Fmi2EventInfo(ctypes.Structure):
    _fields_ = [
        ("again", ctypes.c_int),
        ("terminate", ctypes.c_int),
        ("nominals_changed", ctypes.c_int),
        ("states_changed", ctypes.c_int),
        ("has_next_time", ctypes.c_int),
        ("next_time", ctypes.c_double),
    ]


@functools.cache
def _description(path: Path, _changed_ns: int) -> ModelDescription:
    """FMPy checks it against the schema, which takes as long as many a test."""
    return fmpy.read_model_description(str(path))


class Fmu:
    """An unpacked FMU and, after `instantiate`, one instance of it."""

    def __init__(self, path: Path, version: int, folder: Path) -> None:
        self.version = version
        self.path = path
        fmpy.extract(str(path), unzipdir=str(folder))
        self.description = _description(path, path.stat().st_mtime_ns)
        identifier = self.description.coSimulation.modelIdentifier
        self.binary = folder / "binaries" / BINARY_FOLDERS[version] / f"{identifier}.so"
        self.library = ctypes.CDLL(str(self.binary))
        self.token = self.description.guid if version == 2 else self.description.instantiationToken
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages: list[str] = []
        self.instance: int | None = None

    def twin(self) -> Fmu:
        """The same binary, for another instance of it."""
        other = copy.copy(self)
        other.messages, other.instance = [], None
        return other

    def _log(self, *arguments: object) -> None:
        text = arguments[-1]
        assert isinstance(text, bytes)
        self.messages.append(text.decode().replace("%%", "%") if self.version == 2 else text.decode())

    @property
    def last_message(self) -> str:
        return self.messages[-1] if self.messages else ""

    def instantiate(self, token: str | None = None, name: str = "test", **changes: object) -> bool:
        """``changes``: event_mode=True, intermediate=1 (FMI 3), type=0 (FMI 2) for what is refused."""
        token = self.token if token is None else token
        self._logger = _LOGGERS[self.version](self._log)
        if self.version == 2:
            self._callbacks = _Fmi2Callbacks(self._logger, None, None, None, None)
            function = self.library.fmi2Instantiate
            function.restype = ctypes.c_void_p
            kind = changes.get("type", 1)
            self.instance = function(
                name.encode(), kind, token.encode(), b"file:///", ctypes.byref(self._callbacks), 0, 0
            )
        else:
            function = self.library.fmi3InstantiateCoSimulation
            function.restype = ctypes.c_void_p
            self.instance = function(
                name.encode(), token.encode(), b"/", False, False, bool(changes.get("event_mode")), False, None,
                ctypes.c_size_t(int(changes.get("intermediate", 0))), None, self._logger, None,
            )  # fmt: skip
        return self.instance is not None

    def instantiate_exchange(self) -> bool:
        """For Model Exchange instead."""
        if self.version == 2:
            return self.instantiate(type=0)
        self._logger = _LOGGERS[3](self._log)
        function = self.library.fmi3InstantiateModelExchange
        function.restype = ctypes.c_void_p
        self.instance = function(b"test", self.token.encode(), b"/", False, False, None, self._logger)
        return self.instance is not None

    def call(self, name: str, *arguments: object) -> int:
        """Status of ``fmi<version><name>(instance, ...)``."""
        function = getattr(self.library, f"fmi{self.version}{name}")
        return function(ctypes.c_void_p(self.instance), *arguments)

    def free(self) -> None:
        self.call("FreeInstance")
        self.instance = None

    def setup(self, start: float = 0.0, stop: float | None = None) -> int:
        """Into the initialisation mode."""
        times = (False, ctypes.c_double(0.0), ctypes.c_double(start), stop is not None, ctypes.c_double(stop or 0.0))
        if self.version == 3:
            return self.call("EnterInitializationMode", *times)
        status = self.call("SetupExperiment", *times)
        return status if status != OK else self.call("EnterInitializationMode")

    def exit_initialisation(self) -> int:
        return self.call("ExitInitializationMode")

    def start(self) -> None:
        """From nothing to the step mode."""
        assert self.instantiate()
        assert self.setup() == OK, self.last_message
        assert self.exit_initialisation() == OK, self.last_message

    def step(self, time: float, size: float) -> int:
        times = (ctypes.c_double(time), ctypes.c_double(size), False)
        if self.version == 2:
            return self.call("DoStep", *times)
        flags = [ctypes.c_bool() for _ in range(3)]
        self.last_time = ctypes.c_double()
        return self.call("DoStep", *times, *(ctypes.byref(flag) for flag in flags), ctypes.byref(self.last_time))

    def update(self) -> tuple[int, dict[str, float]]:
        """One update of discrete states: status and results."""
        if self.version == 2:
            info = _Fmi2EventInfo(1, 1, 1, 1, 1)  # so that an unwritten value is noticed
            status = self.call("NewDiscreteStates", ctypes.byref(info))
            return status, {name: getattr(info, name) for name, _ in _Fmi2EventInfo._fields_}
        flags = [ctypes.c_bool(True) for _ in range(5)]
        next_time = ctypes.c_double()
        status = self.call("UpdateDiscreteStates", *(ctypes.byref(flag) for flag in flags), ctypes.byref(next_time))
        values = [float(flag.value) for flag in flags] + [next_time.value]
        return status, dict(zip((name for name, _ in _Fmi2EventInfo._fields_), values, strict=True))

    def settle(self) -> dict[str, float]:
        """Updates until no further one is requested; results of the last one."""
        for _ in range(100):
            status, said = self.update()
            assert status == OK, self.last_message
            assert not said["terminate"]
            assert not said["nominals_changed"]
            if not said["again"]:
                return said
        raise AssertionError("updates without end")

    def array(self, name: str, size: int) -> list[float]:
        """The result of a function that fills an array: ``array("GetContinuousStates", 6)``."""
        values = (ctypes.c_double * size)()
        assert self.call(name, values, ctypes.c_size_t(size)) == OK, self.last_message
        return list(values)

    def set_states(self, values: Sequence[float]) -> int:
        return self.call("SetContinuousStates", (ctypes.c_double * len(values))(*values), ctypes.c_size_t(len(values)))

    @property
    def derivatives_function(self) -> str:
        return "GetDerivatives" if self.version == 2 else "GetContinuousStateDerivatives"

    def completed_step(self) -> tuple[int, bool]:
        """Status, and whether an event is needed."""
        kind = ctypes.c_int if self.version == 2 else ctypes.c_bool
        event, terminate = kind(True), kind(True)  # so that an unwritten value is noticed
        status = self.call("CompletedIntegratorStep", True, ctypes.byref(event), ctypes.byref(terminate))
        assert not terminate.value
        return status, bool(event.value)

    def _access(self, verb: str, kind: str, references: Sequence[int], values: ctypes.Array) -> int:
        numbers = (ctypes.c_uint32 * len(references))(*references)
        size = ctypes.c_size_t(len(references))
        sizes = (size,) if self.version == 3 else ()
        return self.call(f"{verb}{_TYPES[self.version][kind][0]}", numbers, size, values, *sizes)

    def set_references(self, kind: str, references: Sequence[int], values: Sequence[float]) -> int:
        array = (_TYPES[self.version][kind][1] * len(references))(*values)
        return self._access("Set", kind, references, array)

    def get_references(self, kind: str, references: Sequence[int]) -> tuple[int, list[float]]:
        array = (_TYPES[self.version][kind][1] * len(references))()
        status = self._access("Get", kind, references, array)
        return status, list(array)

    def kind(self, name: str) -> str:
        return _TYPE_NAMES[self.variables[name].type]

    def nominal(self, name: str) -> float:
        """The variable's own attribute, or else that of its type."""
        variable = self.variables[name]
        return float(variable.nominal or variable.declaredType.nominal)

    def reference(self, name: str) -> int:
        return self.variables[name].valueReference

    def set(self, name: str, value: float) -> int:
        return self.set_references(self.kind(name), [self.reference(name)], [value])

    def get(self, name: str) -> float:
        status, values = self.get_references(self.kind(name), [self.reference(name)])
        assert status == OK, self.last_message
        return values[0]

    def snapshot(self) -> dict[str, float]:
        """Every variable but time, NaN as text so that snapshots compare equal."""
        values = {name: self.get(name) for name in self.variables if name != "time"}
        return {name: "nan" if math.isnan(value) else value for name, value in values.items()}
