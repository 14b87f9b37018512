"""Runs an FMU with made-up inputs, from its start or from a saved state; also as a program, for another process.

    python state_runner.py MODEL VERSION STATE_FILE FIRST_STEP LAST_STEP FOLDER

prints the outputs' bits after each step.
"""

from __future__ import annotations

import ctypes
import math
import struct
import sys
from pathlib import Path

from fmu_driver import OK, Fmu, fmu_path

STEP_S = 1e-3
# Small enough for the models, large enough to have an effect.
AMPLITUDES = {"controller": 0.5, "testbed": 0.02, "drivetrain": 6.0, "bumper": 0.02, "lag": 0.5}
_TWO_NAMES = {2: ("FMUstate", "DeSerializeFMUstate"), 3: ("FMUState", "DeserializeFMUState")}


class StatefulFmu(Fmu):
    """An FMU with a state that can be saved."""

    def __init__(self, model: str, version: int, folder: Path) -> None:
        super().__init__(fmu_path(model, version), version, folder)
        self.model = model
        self._noun, self._deserialise = _TWO_NAMES[version]

    def get_state(self) -> ctypes.c_void_p:
        state = ctypes.c_void_p()
        assert self.call(f"Get{self._noun}", ctypes.byref(state)) == OK, self.last_message
        return state

    def set_state(self, state: ctypes.c_void_p) -> int:
        return self.call(f"Set{self._noun}", state)

    def free_state(self, state: ctypes.c_void_p) -> None:
        assert self.call(f"Free{self._noun}", ctypes.byref(state)) == OK
        assert not state

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        size = ctypes.c_size_t()
        noun = self._noun
        assert self.call(f"Serialized{noun}Size", state, ctypes.byref(size)) == OK, self.last_message
        room = (ctypes.c_ubyte * size.value)()
        assert self.call(f"Serialize{noun}", state, room, size) == OK, self.last_message
        return bytes(room)

    def deserialise(self, data: bytes) -> tuple[int, ctypes.c_void_p]:
        state = ctypes.c_void_p()
        room = (ctypes.c_ubyte * max(len(data), 1)).from_buffer_copy(data or b"\0")
        return self.call(self._deserialise, room, ctypes.c_size_t(len(data)), ctypes.byref(state)), state

    def names(self, causality: str, kind: str) -> list[str]:
        chosen = [v for v in self.variables.values() if v.causality == causality and v.name != "time"]
        return [v.name for v in chosen if self.kind(v.name) == kind]

    def run(self, first: int, last: int) -> list[bytes]:
        """Bits of all outputs after each of the steps first .. last - 1; the inputs depend on the step alone."""
        rows = []
        for k in range(first, last):
            for index, name in enumerate(self.names("input", "real")):
                value = AMPLITUDES[self.model] * math.sin(0.05 * k + index)
                assert self.set(name, value) == OK, self.last_message
            if self.model == "controller":
                assert self.set("sensor.counter", k) == OK
                assert self.set("sensor.present", True) == OK
            assert self.step(k * STEP_S, STEP_S) == OK, self.last_message
            row = b""
            for kind, code in (("real", "d"), ("integer", "i"), ("boolean", "?")):
                row += b"".join(struct.pack(code, self.get(name)) for name in self.names("output", kind))
            rows.append(row)
        return rows


def main() -> None:
    model, version, file, first, last, folder = sys.argv[1:]
    fmu = StatefulFmu(model, int(version), Path(folder))
    assert fmu.instantiate()
    status, state = fmu.deserialise(Path(file).read_bytes())
    assert status == OK, fmu.last_message
    assert fmu.set_state(state) == OK, fmu.last_message
    for row in fmu.run(int(first), int(last)):
        print(row.hex())


if __name__ == "__main__":
    main()
