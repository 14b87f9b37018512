"""The controller alone in the batch library, on inputs that were recorded: the controller's very bits."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from giveway.base import native
from giveway.base.errors import GivewayError, SimulationError
from giveway.library.batch_library import COLUMN, DTYPES, MESSAGE_SIZE, NONE, OK, SETTING, WRONG, library
from giveway.robot.variables import Value, Variable, table

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["ReplayedController", "controller_inputs", "controller_outputs"]

_MODEL = "controller"


@functools.cache
def controller_inputs() -> Mapping[str, Variable]:
    """The controller's inputs by name (``sensor.torque[0]``), in the order of the table."""
    return {variable.name: variable for variable in table(_MODEL).select("input")}


@functools.cache
def controller_outputs() -> Mapping[str, Variable]:
    """The controller's outputs by name, likewise."""
    return {variable.name: variable for variable in table(_MODEL).select("output")}


class ReplayedController:
    """A controller that goes on from call to call; a context manager, which frees it.

    Args:
        parameters: of the controller, checked; others have their start values.
        step_s: of a row, s. A row runs the control ticks that are due in it.
        outputs: names of what `play` returns.
    """

    def __init__(self, parameters: Mapping[str, Value], step_s: float, outputs: Sequence[str]) -> None:
        self._library, self._handle = library(), ctypes.c_void_p()
        self.step_s, self.rows = step_s, 0
        self._outputs = {name: controller_outputs()[name] for name in outputs}
        variables = table(_MODEL)
        number = native.MODELS.index(_MODEL)
        settings = np.array(
            [(number, variables[name].reference, float(value)) for name, value in parameters.items()], dtype=SETTING
        )
        message = ctypes.create_string_buffer(MESSAGE_SIZE)
        if not self._library.replay.start(
            settings.ctypes.data, len(settings), step_s, ctypes.byref(self._handle), message
        ):
            raise SimulationError(_MODEL, message.value.decode().removeprefix(f"{_MODEL}: "), 0.0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._library.replay.finish(self._handle)
        self._handle = ctypes.c_void_p()

    def play(self, inputs: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
        """Go on by the rows of ``inputs``, each of shape (n,); the outputs, each of shape (n,).

        Raises:
            GivewayError: a value is not allowed; its field names input and row since the start.
        """
        rows = len(next(iter(inputs.values())))
        known = controller_inputs()
        arrays = [np.ascontiguousarray(values, dtype=DTYPES[known[name].type]) for name, values in inputs.items()]
        found = {name: np.zeros(rows, dtype=DTYPES[variable.type]) for name, variable in self._outputs.items()}
        variables = [*(known[name] for name in inputs), *self._outputs.values()]
        number = native.MODELS.index(_MODEL)
        columns = np.array(
            [
                (number, variable.reference, values.ctypes.data)
                for variable, values in zip(variables, [*arrays, *found.values()], strict=True)
            ],
            dtype=COLUMN,
        )
        result = np.zeros(1, dtype=self._library.result)
        status = self._library.replay.steps(
            self._handle, columns.ctypes.data, len(columns), rows, result.ctypes.data
        )  # fmt: skip
        done = int(result[0]["rows"])
        self.rows += done
        if status != OK:
            raise self._refused(status, result[0])
        return found

    def _refused(self, status: int, result: Any) -> GivewayError:
        message = result["message"].decode()
        if status == WRONG and result["reference"] != NONE:
            variable = next(v for v in table(_MODEL) if v.reference == result["reference"])
            return GivewayError(f"row {self.rows}: {_MODEL}.{variable.name}", float(result["value"]), variable.allowed)
        return SimulationError(_MODEL, message.removeprefix(f"{_MODEL}: "), float(result["time_s"]))
