"""The C++ plant whose base tips, from Python."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np
from kkt_reference import Inputs, Parameters
from plant_probe import Plant, _array, _pointer, input_row
from tipping_reference import EVENTS, MODES, STATES

OUTPUTS = (
    *("load 0", "load 1", "load 2", "margin", "stored", "force x", "force y", "roll", "pitch"),
    *("felt x", "felt y", "yaw rate"),
)


@dataclass
class TippingRun:
    times: np.ndarray
    states: np.ndarray
    modes: np.ndarray
    events: list[tuple[float, int]]


class TippingPlant(Plant):
    """Modes are rows: gear[3], contact, on_floor[3], overturned, roller[3]."""

    def __init__(self, library: ctypes.CDLL, p: Parameters) -> None:
        super().__init__(library, p)
        self.p = p

    def _out(self, name: str, size: int, x: np.ndarray, u: Inputs, modes: np.ndarray) -> np.ndarray:
        out = np.empty(size)
        arrays = (_array(x), _array(input_row(u)), _array(modes), out)
        getattr(self._library, f"tipping_{name}")(self._handle, *map(_pointer, arrays))
        return out

    def tipping_rhs(self, x: np.ndarray, u: Inputs, modes: np.ndarray) -> np.ndarray:
        return self._out("rhs", STATES, x, u, modes)

    def tipping_indicators(self, x: np.ndarray, u: Inputs, modes: np.ndarray) -> np.ndarray:
        return self._out("indicators", EVENTS, x, u, modes)

    def tipping_outputs(self, x: np.ndarray, u: Inputs, modes: np.ndarray) -> dict[str, float]:
        return dict(zip(OUTPUTS, self._out("outputs", len(OUTPUTS), x, u, modes).tolist(), strict=True))

    def tipping_transition(
        self, x: np.ndarray, u: Inputs, modes: np.ndarray, fired: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        state, mode, inputs, event = (
            np.array(x, dtype=float),
            np.array(modes, dtype=float),
            _array(input_row(u)),
            _array(fired),
        )
        self._library.tipping_transition(self._handle, *map(_pointer, (state, inputs, mode, event)))
        return state, mode

    def start(self, motion: list[float] | None = None) -> tuple[np.ndarray, np.ndarray]:
        """`motion`: x, y, theta, vx, vy, omega, slider speed; at rest without."""
        start, inputs, state, mode = (
            _array(motion or [0.0] * 7),
            _array(input_row(Inputs())),
            np.empty(STATES),
            np.empty(MODES),
        )
        self._library.tipping_initial_state(self._handle, *map(_pointer, (start, inputs, state, mode)))
        return state, mode

    def run(
        self,
        x0: np.ndarray,
        modes: np.ndarray,
        times: np.ndarray,
        inputs: list[tuple[float, Inputs]],
        rtol: float = 1e-9,
    ) -> TippingRun:
        times, state, mode = _array(times), _array(x0), _array(modes)
        starts, rows = _array([t for t, _ in inputs]), _array([input_row(u) for _, u in inputs])
        states, all_modes = np.empty((len(times), STATES)), np.empty((len(times), MODES))
        event_times, event_indices = np.empty(10000), np.empty(10000, dtype=np.int32)
        count = self._library.tipping_simulate(
            self._handle, _pointer(state), _pointer(mode), len(starts), _pointer(starts), _pointer(rows), len(times),
            _pointer(times), ctypes.c_double(rtol), _pointer(states), _pointer(all_modes), 10000, _pointer(event_times),
            _pointer(event_indices),
        )  # fmt: skip
        if count < 0:
            raise RuntimeError(self._library.probe_error(self._handle).decode())
        events = [(float(t), int(i)) for t, i in zip(event_times[:count], event_indices[:count], strict=True)]
        return TippingRun(times, states, all_modes, events)
