"""The drives of our testbed: servos of c_core at 2 kHz, encoders, torque sensors, accelerometer and bus."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Drives", "compile_drives"]

ROOT = Path(__file__).resolve().parents[2]
SERVO_SOURCES = ("gw_servo.c", "gw_config.c", "gw_math.c", "gw_sum.c")
NUMBERS = (
    "electronics.encoder_counts",
    "electronics.torque_noise",
    "electronics.torque_resolution",
    "electronics.torque_range",
    "servo.kp",
    "servo.kd",
    "drivetrain.torque_limit",
    "drivetrain.sensing",
    "servo.derivative_cutoff",
    "electronics.sensor_delay",
    "electronics.command_delay",
    "imu.present",
    *(f"imu.acceleration_{what}[{axis}]" for axis in range(2) for what in ("bias", "scale")),
    "imu.acceleration_noise",
    "imu.gyro_bias",
    "imu.gyro_scale",
    "imu.gyro_noise",
    "imu.vibration",
    "imu.vibration_growth",
    "imu.vibration_frequency",
    "imu.vibration_damping",
    "imu.bandwidth",
    "imu.range",
    "imu.gyro_range",
    "imu.delay",
    "imu.dropout",
)
"""In the order of drives.cpp."""


def compile_drives(folder: Path) -> Path:
    """The shared library, from the sources of the testbed and c_core and the headers that `make build` generates."""
    folder.mkdir(parents=True, exist_ok=True)
    core, fmu = ROOT / "c_core", ROOT / "fmu"
    generated = ROOT / "build" / "fmu"
    options = ["-O2", "-fPIC", "-ffp-contract=off", f"-I{core / 'include'}"]
    objects = []
    for name in SERVO_SOURCES:
        objects.append(folder / f"{name}.o")
        _run("gcc", *options, "-c", core / "src" / name, "-o", objects[-1])
    includes = (
        fmu / "models" / "testbed",
        fmu / "models",
        fmu / "plant",
        fmu / "math",
        generated / "plant" / "generated",
        generated / "models" / "testbed" / "generated_testbed",
    )
    library = folder / "drives.so"
    sources = (
        Path(__file__).with_name("drives.cpp"),
        generated / "models" / "testbed" / "generated_testbed" / "testbed_variables.cpp",
    )
    _run("g++", "-std=c++20", "-shared", *options, *(f"-I{i}" for i in includes), *sources, *objects, "-o", library)
    return library


def _run(*words: object) -> None:
    subprocess.run([str(word) for word in words], check=True)


class Drives:
    """The drives of one run; angles in rad at the wheel axle, in the order of the wheels."""

    def __init__(self, library: Path, parameters: Mapping[str, Any], seed: int, angle: NDArray[np.float64]) -> None:
        self._library = ctypes.CDLL(str(library))
        pointer = ctypes.c_void_p
        start = self._function("drives", pointer, pointer, ctypes.c_uint32, *[pointer] * 3, ctypes.c_int)
        zero = np.zeros(3)
        numbers = np.array([float(parameters[name]) for name in NUMBERS])
        self._drives = start(numbers.ctypes.data, seed, angle.ctypes.data, zero.ctypes.data, zero.ctypes.data, 1)
        if not self._drives:
            raise ValueError("the servos refuse their parameters")
        self._sample = self._function("sample", None, *[pointer] * 6)
        self._receive = self._function("receive", None, pointer, pointer, ctypes.c_int)
        self._regulate = self._function("regulate", None, *[pointer] * 3)

    def _function(self, name: str, result: Any, *arguments: Any) -> Any:
        function = getattr(self._library, f"second_simulator_{name}")
        function.restype, function.argtypes = result, arguments
        return function

    def sample(self, angle: int, torque: int, felt: int, sensed: int, counts: int) -> None:
        """Addresses, as of second_simulator_sample."""
        self._sample(self._drives, angle, torque, felt, sensed, counts)

    def receive(self, command: int, enable: bool) -> None:
        """Address of three angles and three speeds."""
        self._receive(self._drives, command, int(enable))

    def regulate(self, angle: int, torque: int) -> None:
        """Addresses of three angles, and of three motor torques to fill in."""
        self._regulate(self._drives, angle, torque)

    def close(self) -> None:
        if self._drives:
            self._function("end", None, ctypes.c_void_p)(self._drives)
            self._drives = None
