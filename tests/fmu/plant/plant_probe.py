"""The C++ plant from Python: parameters by name, its functions, and giveway's own solver."""

from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from kkt_reference import INDICATORS, STATES, Inputs, Modes, Parameters

MODE_COUNT = 13
# Fields of the reference that are not parameters of the plant under the same name.
NOT_SHARED = {"outline", "fault_velocity_term", "fault_contact_moment", "fault_external_sign"}
OUTPUTS = (
    *(f"{name}[{i}]" for name in ("wheel_speed", "wheel_torque", "roller_force") for i in range(3)),
    *("contact_force", "contact_force_x", "contact_force_y", "contact_point_x", "contact_point_y"),
    *("contact_base_x", "contact_base_y", "nose_x", "nose_y", "bumper_force", "rope_tension", "wall_force"),
    *("stored_energy", "specific_force_x", "specific_force_y", "yaw_rate"),
)


def library_path() -> Path:
    default = Path(__file__).resolve().parents[3] / "build" / "tests"
    return Path(os.environ.get("GIVEWAY_TEST_DIR", default)) / "libgiveway_plant_probe.so"


def load() -> ctypes.CDLL:
    path = library_path()
    if not path.exists():
        raise FileNotFoundError(f"{path}: build the target giveway_plant_probe, or set GIVEWAY_TEST_DIR to where it is")
    library = ctypes.CDLL(str(path))
    library.probe_new.restype = ctypes.c_void_p
    library.probe_error.restype = ctypes.c_char_p
    return library


def _array(values: object) -> np.ndarray:
    return np.ascontiguousarray(values, dtype=np.float64)


def _pointer(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def input_row(u: Inputs) -> list[float]:
    return [*u.motor_torque, *u.push_force, *u.push_point]


@dataclass
class Run:
    times: np.ndarray
    states: np.ndarray
    modes: list[Modes]
    events: list[tuple[float, int]]
    steps: int
    rhs_calls: int


class Plant:
    """One C++ plant."""

    def __init__(self, library: ctypes.CDLL, p: Parameters) -> None:
        self._library = library
        self._handle = ctypes.c_void_p(library.probe_new())
        for f in fields(p):
            if f.name not in NOT_SHARED:
                self._set(f.name, getattr(p, f.name))
        self._set("outline_x", [v[0] for v in p.outline])
        self._set("outline_y", [v[1] for v in p.outline])
        library.probe_derive(self._handle)

    def __del__(self) -> None:
        self._library.probe_delete(self._handle)

    def _set(self, name: str, value: object) -> None:
        values = _array(np.atleast_1d(value))
        if self._library.probe_set(self._handle, name.encode(), _pointer(values), len(values)):
            raise KeyError(f"the C++ plant has no parameter {name} of {len(values)} values")

    def _call(self, name: str, x: np.ndarray, u: Inputs, modes: Modes, count: int) -> np.ndarray:
        state, inputs, mode, out = (
            _array(x),
            _array(input_row(u)),
            _array(modes.as_list()),
            np.empty(count),
        )
        function = getattr(self._library, f"probe_{name}")
        function(self._handle, _pointer(state), _pointer(inputs), _pointer(mode), _pointer(out))
        return out

    def rhs(self, x: np.ndarray, u: Inputs, modes: Modes) -> np.ndarray:
        return self._call("rhs", x, u, modes, STATES)

    def indicators(self, x: np.ndarray, u: Inputs, modes: Modes) -> np.ndarray:
        return self._call("indicators", x, u, modes, INDICATORS)

    def outputs(self, x: np.ndarray, u: Inputs, modes: Modes) -> dict[str, float]:
        return dict(zip(OUTPUTS, self._call("outputs", x, u, modes, len(OUTPUTS)).tolist(), strict=True))

    def transition(self, x: np.ndarray, u: Inputs, modes: Modes, fired: np.ndarray) -> tuple[np.ndarray, Modes]:
        state, inputs, mode, fired = (
            np.array(x, dtype=float),
            _array(input_row(u)),
            _array(modes.as_list()),
            _array(fired),
        )
        self._library.probe_transition(self._handle, _pointer(state), _pointer(inputs), _pointer(mode), _pointer(fired))
        return state, modes_from(mode)

    def accept_inputs(self, x: np.ndarray, u: Inputs, modes: Modes) -> Modes:
        state, inputs, mode = _array(x), _array(input_row(u)), _array(modes.as_list())
        self._library.probe_accept_inputs(self._handle, _pointer(state), _pointer(inputs), _pointer(mode))
        return modes_from(mode)

    def initial_state(self, motion: list[float], u: Inputs) -> tuple[np.ndarray, Modes]:
        """`motion`: x, y, theta, vx, vy, omega, slider speed, bristle offsets[3]."""
        start, inputs, state, mode = (
            _array(motion),
            _array(input_row(u)),
            np.empty(STATES),
            np.empty(MODE_COUNT),
        )
        self._library.probe_initial_state(
            self._handle, _pointer(start), _pointer(inputs), _pointer(state), _pointer(mode)
        )
        return state, modes_from(mode)

    def simulate(
        self,
        x0: np.ndarray,
        modes: Modes,
        times: np.ndarray,
        inputs: list[tuple[float, Inputs]],
        rtol: float = 1e-9,
        atol: float = 1e-11,
    ) -> Run:
        """The C++ solver, at `times`, with piecewise constant inputs: (from time, value)."""
        times, state, mode = _array(times), _array(x0), _array(modes.as_list())
        starts, rows = _array([t for t, _ in inputs]), _array([input_row(u) for _, u in inputs])
        states, all_modes = np.empty((len(times), STATES)), np.empty((len(times), MODE_COUNT))
        capacity = 10000
        event_times, event_indices = np.empty(capacity), np.empty(capacity, dtype=np.int32)
        statistics = np.zeros(3, dtype=np.int64)
        count = self._library.probe_simulate(
            self._handle,
            _pointer(state),
            _pointer(mode),
            len(starts),
            _pointer(starts),
            _pointer(rows),
            len(times),
            _pointer(times),
            ctypes.c_double(rtol),
            ctypes.c_double(atol),
            _pointer(states),
            _pointer(all_modes),
            capacity,
            _pointer(event_times),
            _pointer(event_indices),
            _pointer(statistics),
        )
        if count < 0:
            raise RuntimeError(self._library.probe_error(self._handle).decode())
        events = [(float(t), int(i)) for t, i in zip(event_times[:count], event_indices[:count], strict=True)]
        return Run(
            times,
            states,
            [modes_from(m) for m in all_modes],
            events,
            int(statistics[0]),
            int(statistics[1]),
        )


def modes_from(row: np.ndarray) -> Modes:
    values = [int(v) for v in row]
    return Modes(values[0:3], *values[3:10], values[10:13])
