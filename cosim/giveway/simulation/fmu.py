"""FMUs through FMPy: unpacked once per process, called through preallocated buffers.

FMPy loads the library, creates and initialises the instance. For the calls of every step its generic wrappers cost
more than the FMUs themselves, so `Instance` makes its own prototypes of the same functions, which take plain addresses.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import itertools
import logging
import weakref
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import FileError, SimulationError, WriteError
from giveway.base.temporary import temporary_folder
from giveway.simulation.fmi2_callbacks import fmi2_callbacks
from giveway.simulation.fmi2_library import fmi2_library

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription

    from giveway.robot.variables import Value, VariableTable

__all__ = ["FmuFile", "Instance", "dtypes", "open_fmu"]

_log = logging.getLogger(__name__)

# FMI status values: 0 OK, 1 warning, 2 discard, 3 error, 4 fatal.
WORST_USABLE_STATUS = 1
FATAL_STATUS = 4

_FUNCTIONS = {
    3: {"real": "Float64", "integer": "Int32", "boolean": "Boolean"},
    2: {"real": "Real", "integer": "Integer", "boolean": "Boolean"},
}
# FMI 3 booleans are one byte, FMI 2 booleans are a C int.
_DTYPES: dict[int, dict[str, Any]] = {
    3: {"real": np.float64, "integer": np.int32, "boolean": np.bool_},
    2: {"real": np.float64, "integer": np.int32, "boolean": np.int32},
}


def dtypes(fmi_version: int) -> Mapping[str, Any]:
    """By kind, the numpy type in which this FMI version exchanges variables."""
    return _DTYPES[fmi_version]


@dataclass(frozen=True)
class FmuFile:
    """An FMU that has been unpacked.

    Attributes:
        token: instantiation token (FMI 2: GUID), the hash of the variable table it was built from.
        sha256: hash of the FMU file.
        references: value reference by variable name.
    """

    path: Path
    folder: Path
    fmi_version: int
    identifier: str
    token: str
    sha256: str
    references: Mapping[str, int]

    def check_matches(self, table: VariableTable) -> None:
        """Refuse an FMU that was built from another variable table: its references would have other meanings."""
        for variable in table:
            found = self.references.get(variable.name)
            if found != variable.reference:
                wanted = f"{variable.name} has reference {found}, not {variable.reference}"
                reason = f"was built from another variable table: {wanted}"
                raise FileError(self.path, reason, "build the FMUs and the tables together")


def open_fmu(path: Path) -> FmuFile:
    """Unpack ``path`` and read its model description; the same file is unpacked once per process."""
    try:
        return _unpack(path, path.stat().st_mtime_ns)
    except OSError as error:
        raise FileError(path, f"cannot be read: {error.strerror}") from None


@functools.cache
def _unpack(path: Path, _modified_ns: int) -> FmuFile:
    import fmpy

    folder = temporary_folder()
    try:
        fmpy.extract(str(path), unzipdir=str(folder))
        # Our build validates the description; a validation in every process would take longer than a run.
        description: ModelDescription = fmpy.read_model_description(str(folder), validate=False)
    except OSError as error:
        raise WriteError(folder, error) from error
    except Exception as error:  # FMPy raises plain Exception for anything wrong with a file
        raise FileError(path, f"is not a usable FMU: {error}") from None
    version = int(str(description.fmiVersion)[0])
    return FmuFile(
        path=path,
        folder=folder,
        fmi_version=version,
        identifier=description.coSimulation.modelIdentifier,
        token=description.instantiationToken if version == 3 else description.guid,
        sha256=hashlib.sha256(path.read_bytes()).hexdigest(),
        references={variable.name: variable.valueReference for variable in description.modelVariables},
    )


# FMI 2 log messages come with printf arguments, which Python callbacks cannot receive. FMPy's native proxy formats
# them, but knows only the callback that was registered last: so one callback serves every instance of the process.
_environments = itertools.count(1)
_listeners: weakref.WeakValueDictionary[int, Instance] = weakref.WeakValueDictionary()


@functools.cache
def _shared_fmi2_callbacks() -> Any:
    from fmpy import fmi2

    def dispatch(environment: int | None, name: bytes, status: int, category: bytes, text: bytes) -> None:
        listener = _listeners.get(environment or 0)
        if listener is None:  # an instance made elsewhere with FMPy
            fmi2.printLogMessage(environment, name, status, category, text)
        else:
            listener._logged(status, text)

    return fmi2_callbacks(dispatch)


class Instance:
    """One co-simulation instance; a context manager that always terminates and frees it."""

    def __init__(self, file: FmuFile, name: str) -> None:
        self.name = name
        self.file = file
        self._version = file.fmi_version
        self._messages: list[str] = []
        self._initialised = False
        self._worst = 0
        self._kept: list[object] = []  # buffers whose addresses the FMU or a port uses
        self._prefix = f"fmi{self._version}"
        self._fmu = self._create()

    def _create(self) -> Any:
        from fmpy import fmi2, fmi3

        arguments = {
            "guid": self.file.token,
            "modelIdentifier": self.file.identifier,
            "unzipDirectory": str(self.file.folder),
            "instanceName": self.name,
        }
        try:
            if self._version == 3:
                slave3 = fmi3.FMU3Slave(**arguments)
                slave3.instantiate(logMessage=lambda _env, status, _category, text: self._logged(status, text))
                return slave3
            library = fmi2_library(self.file.folder, self.file.identifier)
            slave2 = fmi2.FMU2Slave(**arguments, libraryPath=library)
            slave2.instantiate(callbacks=self._fmi2_callbacks())
            return slave2
        except Exception as error:  # FMPy raises plain Exception
            raise SimulationError(self.name, " ".join([str(error), *self._messages]), 0.0) from None

    def _fmi2_callbacks(self) -> Any:
        """FMI 2 callbacks of this instance: the shared logger, distinguished by the component environment."""
        from fmpy import fmi2

        shared = _shared_fmi2_callbacks()
        callbacks = fmi2.fmi2CallbackFunctions(shared.logger, shared.allocateMemory, shared.freeMemory)
        callbacks.componentEnvironment = next(_environments)
        _listeners[callbacks.componentEnvironment] = self
        return callbacks

    def _logged(self, status: int, text: bytes) -> None:
        message = text.decode("utf-8", "replace")
        _log.log(logging.DEBUG if status == 0 else logging.WARNING, "%s: %s", self.name, message)
        if status > WORST_USABLE_STATUS:
            self._messages.append(message)

    def __enter__(self) -> Instance:
        return self

    def __exit__(self, *_exception: object) -> None:
        if self._worst >= FATAL_STATUS:
            return  # no call is allowed on the instance any more
        if self._initialised and self._worst <= WORST_USABLE_STATUS:
            self._fmu.terminate()
        self._fmu.freeInstance()

    def check(self, status: int, time_s: float) -> None:
        """Raise SimulationError with the FMU's message if ``status`` (one or several or-ed) is a failure."""
        if status <= WORST_USABLE_STATUS:
            return
        self._worst = max(self._worst, status)
        reason = "; ".join(self._messages) or f"FMI status {status} without a message"
        raise SimulationError(self.name, reason, time_s)

    def initialise(self, parameters: dict[str, Value], table: VariableTable, start_time_s: float = 0.0) -> None:
        """Set ``parameters`` and pass through initialisation mode."""
        for kind in ("real", "integer", "boolean"):
            chosen = [table[name] for name in parameters if table[name].type == kind]
            if chosen:
                values = np.array([parameters[v.name] for v in chosen], dtype=self.dtype(kind))
                self.check(self.setter(kind, [v.reference for v in chosen])(values.ctypes.data), start_time_s)
        try:
            if self._version == 2:
                self._fmu.setupExperiment(startTime=start_time_s)
                self._fmu.enterInitializationMode()
            else:
                self._fmu.enterInitializationMode(startTime=start_time_s)
            self._fmu.exitInitializationMode()
        except Exception as error:  # FMPy raises its own exception on any status above "warning"
            self._worst = 3
            raise SimulationError(self.name, "; ".join(self._messages) or str(error), start_time_s) from None
        self._initialised = True

    def dtype(self, kind: str) -> Any:
        """The numpy type in which this FMI version exchanges variables of ``kind``."""
        return _DTYPES[self._version][kind]

    def getter(self, kind: str, references: Sequence[int]) -> Callable[[int], int]:
        """A function that writes the values of ``references`` to an address and returns the FMI status."""
        return self._port("Get", kind, references)

    def setter(self, kind: str, references: Sequence[int]) -> Callable[[int], int]:
        """A function that sets ``references`` from the values at an address and returns the FMI status."""
        return self._port("Set", kind, references)

    def _port(self, verb: str, kind: str, references: Sequence[int]) -> Callable[[int], int]:
        count = len(references)
        if count == 0:
            return lambda _address: 0
        array = (ctypes.c_uint32 * count)(*references)
        self._kept.append(array)
        where, instance = ctypes.addressof(array), self._component
        pointer, size = ctypes.c_void_p, ctypes.c_size_t
        name = f"{self._prefix}{verb}{_FUNCTIONS[self._version][kind]}"
        if self._version == 3:
            call3 = self._function(name, pointer, pointer, size, pointer, size)
            return lambda address: call3(instance, where, count, address, count)
        call2 = self._function(name, pointer, pointer, size, pointer)
        return lambda address: call2(instance, where, count, address)

    def stepper(self) -> Callable[[float, float], int]:
        """A function of (time in s, step in s) that makes one step and returns the FMI status."""
        pointer, double, instance = ctypes.c_void_p, ctypes.c_double, self._component
        name = f"{self._prefix}DoStep"
        if self._version == 2:
            call2 = self._function(name, pointer, double, double, ctypes.c_int)
            return lambda time_s, step_s: call2(instance, time_s, step_s, 1)
        flags = (ctypes.c_bool * 3)()  # event encountered, terminate simulation, early return
        reached = ctypes.c_double()
        self._kept += [flags, reached]
        event = ctypes.addressof(flags)
        terminate, early, last = event + 1, event + 2, ctypes.addressof(reached)
        call3 = self._function(name, pointer, double, double, ctypes.c_bool, pointer, pointer, pointer, pointer)
        return lambda time_s, step_s: call3(instance, time_s, step_s, True, event, terminate, early, last)

    @property
    def _component(self) -> int:
        component = self._fmu.component
        return int(getattr(component, "value", component))

    def _function(self, name: str, *argument_types: Any) -> Callable[..., int]:
        address = ctypes.cast(getattr(self._fmu.dll, name), ctypes.c_void_p).value
        assert address is not None
        return ctypes.CFUNCTYPE(ctypes.c_int, *argument_types)(address)
