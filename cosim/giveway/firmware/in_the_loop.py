"""The processor in the loop: firmware at the end of a serial line takes the place of the controller's FMU."""

from __future__ import annotations

import ctypes
import hashlib
import shlex
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base import native
from giveway.base.errors import GivewayError, SimulationError
from giveway.firmware.digest import firmware_digest
from giveway.firmware.frames import VERSION, Frame, Kind, LineError, SerialLine, ask
from giveway.firmware.lines import BAUD, DeviceLine, ProgramLine
from giveway.firmware.programs import HOST, QEMU, build, command_of
from giveway.firmware.settings import Settings
from giveway.robot.presets import DEFAULT
from giveway.robot.variables import Value, Variable, VariableTable, table
from giveway.simulation.fmu import dtypes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.scenario.scenario import Scenario
    from giveway.simulation.master import OpenController

__all__ = ["SerialController", "controller_of"]

TIMEOUT_S = 10.0
_FAILED = 3  # FMI: error


@dataclass(frozen=True)
class Program:
    """What stands in a manifest instead of the FMU.

    Attributes:
        path: the program, or the device.
        token: digest of library and configuration.
        sha256: of the program; "" for a device.
    """

    path: Path
    token: str
    sha256: str


class SerialController:
    """Called by the master as an FMU's instance is; each step is a frame there and a frame back.

    Args:
        line: to the firmware.
        program: for the manifest.
        fmi_version: in whose types values are exchanged.
        advice: what to do if the firmware is another one.
    """

    def __init__(self, line: SerialLine, program: Program, fmi_version: int, advice: str = "") -> None:
        self.file = program
        self._line, self._advice = line, advice
        self._dtypes = dtypes(fmi_version)
        variables = table("controller")
        inputs, outputs = variables.select("input"), variables.select("output")
        self._input_at = {variable.reference: index for index, variable in enumerate(inputs)}
        self._output_at = {variable.reference: index for index, variable in enumerate(outputs)}
        self._inputs = np.array([_word_of(variable) for variable in inputs], dtype=np.uint32)
        self._outputs = np.zeros(len(outputs), dtype=np.uint32)
        self._frames = 0
        self._failure = ""

    def initialise(self, _parameters: dict[str, Value], _table: VariableTable, _start_time_s: float = 0.0) -> None:
        """Start the controller; SimulationError if its firmware is another one or refuses its configuration."""
        try:
            answer = self._ask(Kind.START)
        except LineError as error:
            raise SimulationError("controller", str(error), 0.0) from None
        words = np.frombuffer(answer.payload, dtype="<u4").tolist()
        if answer.kind != Kind.STARTED or len(words) != 4 or words[0] != VERSION:
            reason = f"the firmware speaks another version of the protocol than {VERSION}"
            raise SimulationError("controller", reason, 0.0)
        token = f"{words[2]:08x}{words[1]:08x}"
        if token != self.file.token:
            reason = f"the firmware has another configuration or library: digest {token}, not {self.file.token}"
            raise SimulationError("controller", f"{reason}{self._advice}", 0.0)
        if words[3] != 1:
            raise SimulationError("controller", "the firmware refused its configuration", 0.0)

    def dtype(self, kind: str) -> Any:
        """The numpy type in which variables of ``kind`` are exchanged."""
        return self._dtypes[kind]

    def check(self, status: int, time_s: float) -> None:
        """Raise SimulationError if ``status`` is a failure."""
        if status >= _FAILED:
            raise SimulationError("controller", self._failure, time_s)

    def getter(self, kind: str, references: Sequence[int]) -> Callable[[int], int]:
        """A function that writes the outputs ``references`` to an address."""
        chosen = np.array([self._output_at[reference] for reference in references], dtype=np.intp)
        size = len(chosen) * np.dtype(self.dtype(kind)).itemsize

        def get(address: int) -> int:
            ctypes.memmove(address, self._values(kind, self._outputs[chosen]).tobytes(), size)
            return 0

        return get

    def _values(self, kind: str, words: NDArray[np.uint32]) -> NDArray[Any]:
        if kind == "real":
            return words.view(np.float32).astype(np.float64)
        return words.view(np.int32) if kind == "integer" else (words != 0).astype(self.dtype(kind))

    def setter(self, kind: str, references: Sequence[int]) -> Callable[[int], int]:
        """A function that sets the inputs ``references`` from the values at an address."""
        chosen = np.array([self._input_at[reference] for reference in references], dtype=np.intp)
        dtype = np.dtype(self.dtype(kind))

        def set_(address: int) -> int:
            values = np.frombuffer(ctypes.string_at(address, len(chosen) * dtype.itemsize), dtype=dtype)
            if kind == "real":
                with np.errstate(over="ignore"):  # as in the FMU
                    self._inputs[chosen] = values.astype(np.float32).view(np.uint32)
            else:
                self._inputs[chosen] = values.astype(np.int32).view(np.uint32)
            return 0

        return set_

    def stepper(self) -> Callable[[float, float], int]:
        """A function of (time in s, step in s) that makes one tick."""

        def step(_time_s: float, _step_s: float) -> int:
            try:
                answer = self._ask(Kind.TICK, self._inputs.astype("<u4").tobytes())
                if answer.kind != Kind.ANSWER or len(answer.payload) != self._outputs.nbytes:
                    raise LineError(f"frame {answer.counter} is no answer to a tick")
            except LineError as error:
                self._failure = str(error)
                return _FAILED
            self._outputs[:] = np.frombuffer(answer.payload, dtype="<u4")
            return 0

        return step

    def _ask(self, kind: Kind, payload: bytes = b"") -> Frame:
        frame = Frame(kind, self._frames, payload)
        self._frames = (self._frames + 1) & 0xFFFFFFFF
        return ask(self._line, frame, TIMEOUT_S)


def _word_of(variable: Variable) -> int:
    """The start value of an input."""
    value = variable.start or 0
    return int(np.float32(value).view(np.uint32)) if variable.type == "real" else int(value) & 0xFFFFFFFF


def controller_of(scenario: Scenario, text: str) -> OpenController:
    """What opens the controller that ``--controller TEXT`` names: "host", "qemu", or a device as "PATH" or "PATH@BAUD".

    Programs are built at once. GivewayError if that cannot be, or for steps that are not the controller's.
    """
    robot = native.robot() if scenario.robot is None else Path(scenario.robot)
    settings = Settings.of(robot, scenario.preset, scenario.controller)
    period_s = float(settings.parameters()["controller.period"])
    if abs(scenario.step_s - period_s) > 1e-9:
        allowed = f"{period_s:g} s with --controller: a frame is a step, and a step is the controller's period"
        raise GivewayError("step_s", scenario.step_s, allowed)
    digest = firmware_digest(settings)
    if text in (HOST, QEMU):
        program = build(settings, text)
        made = Program(program, digest, hashlib.sha256(program.read_bytes()).hexdigest())
        return lambda: _opened(ProgramLine(command_of(program, text)), made, scenario.fmi_version, "")
    path, at, baud = text.rpartition("@")
    if not at:
        path, baud = text, str(BAUD)
    if "/" not in path or not baud.isdigit():
        allowed = "fmu, host, qemu, or a serial device such as /dev/ttyACM0 or /dev/ttyUSB0@921600"
        raise GivewayError("--controller", text, allowed)
    device = Program(Path(path), digest, "")
    advice = f"; write what this run needs with: {_command(robot, settings)}"
    return lambda: _opened(DeviceLine(device.path, int(baud)), device, scenario.fmi_version, advice)


@contextmanager
def _opened(
    line: ProgramLine | DeviceLine, program: Program, fmi_version: int, advice: str
) -> Iterator[SerialController]:
    with line:
        yield SerialController(line, program, fmi_version, advice)


def _command(robot: Path, settings: Settings) -> str:
    words = ["giveway", "firmware", str(robot), "--out", "DIR"]
    if settings.preset != DEFAULT:
        words += ["--preset", settings.preset]
    for name, value in settings.assignments.items():
        words += ["--set", f"controller.{name}={str(value).lower() if isinstance(value, bool) else value}"]
    return shlex.join(words)
