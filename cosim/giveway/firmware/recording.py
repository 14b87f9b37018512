"""A robot's own collision, recorded: what its sensors said in their own counts, and every bit of the answer.

The collision is simulated by the testbed with the robot's numbers. Firmware makes the controller's inputs of counts in
float, which may differ in the last bit from what the testbed gave: so the answers are those of the controller to the
very inputs that firmware makes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import FileError, GivewayError
from giveway.firmware.c_text import real
from giveway.firmware.config_source import Scaling
from giveway.firmware.settings import Settings
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import table
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.scenario.scenario import Scenario

__all__ = ["Recording", "record", "to_words"]

SPEEDS_MPS = (0.5, 1.0, 2.0, 4.0)  # of the slider: the first at which the robot notices it
BEFORE_S, AFTER_S = 0.05, 0.25  # of the contact: calm after the tare, the hit and the beginning of the reaction
SIDE = 0  # of the outline: the slider hits the middle between its corners 0 and 1
_IMU = ("sensor.acceleration[0]", "sensor.acceleration[1]", "sensor.yaw_rate")


@dataclass(frozen=True)
class Recording:
    """Rows are ticks.

    Attributes:
        torque_count, encoder_count: shape (n, wheels).
        counter, present: of the sensors, shape (n,).
        imu: specific force along both axes in m/s2 and yaw rate in rad/s, float, shape (n, 3); None: there are none.
        imu_counter, imu_present: likewise.
        outputs: of the controller as words, shape (n, outputs).
        hits: how many the controller noticed.
        speed_mps: of the slider.
    """

    torque_count: NDArray[np.int64]
    encoder_count: NDArray[np.int64]
    counter: NDArray[np.int64]
    present: NDArray[np.bool_]
    imu: NDArray[np.float32] | None
    imu_counter: NDArray[np.int64]
    imu_present: NDArray[np.bool_]
    outputs: NDArray[np.uint32]
    hits: int
    speed_mps: float

    def header(self) -> str:
        """The text of recorded_collision.h."""
        return _HEADER.format(ticks=len(self.counter), speed=self.speed_mps)

    def source(self) -> str:
        """The text of recorded_collision.c."""
        sensors = "".join(f"    {self._row(tick)},\n" for tick in range(len(self.counter)))
        outputs = "".join("    {" + ", ".join(f"0x{word:X}U" for word in row) + "},\n" for row in self.outputs.tolist())
        return (
            '#include "recorded_collision.h"\n\n'
            f"const robot_sensors_t recorded_sensors[RECORDED_TICKS] = {{\n{sensors}}};\n\n"
            f"const uint32_t recorded_outputs[RECORDED_TICKS][CONTROLLER_OUTPUT_WORDS] = {{\n{outputs}}};\n"
        )

    def _row(self, tick: int) -> str:
        torque, encoder = (
            ", ".join(map(str, values[tick].tolist())) for values in (self.torque_count, self.encoder_count)
        )
        present = "true" if self.present[tick] else "false"
        row = f"{{{torque}}}, {{{encoder}}}, {self.counter[tick]}U, {present}"
        if self.imu is None:
            return f"{{{row}, {{0.0F, 0.0F}}, 0.0F, 0U, false}}"
        x, y, yaw_rate = (real(value) for value in self.imu[tick])
        imu_present = "true" if self.imu_present[tick] else "false"
        return f"{{{row}, {{{x}, {y}}}, {yaw_rate}, {self.imu_counter[tick]}U, {imu_present}}}"


_HEADER = """\
/* The robot stands, and a slider of {speed:g} m/s hits the middle of one of its sides: what its sensors say each
 * period, and what the controller's FMU then puts out. Simulated and written by `giveway firmware`. */
#ifndef RECORDED_COLLISION_H
#define RECORDED_COLLISION_H

#include "controller_words.h"
#include "main_step.h"

#define RECORDED_TICKS {ticks}U

extern const robot_sensors_t recorded_sensors[RECORDED_TICKS];
extern const uint32_t recorded_outputs[RECORDED_TICKS][CONTROLLER_OUTPUT_WORDS];

#endif
"""


def record(settings: Settings) -> Recording:
    """Simulate the collision, and play it to the controller as firmware does."""
    from giveway.simulation.native_engine import simulate

    for speed_mps in SPEEDS_MPS:
        traces = simulate(_collision(settings, speed_mps)).traces
        sensed = {name.removeprefix("testbed."): values for name, values in traces.items()}
        found = _recording(settings, sensed, speed_mps)
        if found.hits:
            break
    return found


def _collision(settings: Settings, speed_mps: float) -> Scenario:
    from giveway.scenario.approach import Approach, edge_middle, meet, outline_of
    from giveway.scenario.plan import Rest
    from giveway.scenario.scenario import Scenario

    robot = settings.robot.path
    variables = table("testbed")
    start = {v.name: v.start for v in variables.select("parameter") if v.start is not None}
    testbed = start | variables.robot_values(read_robot(robot)) | {"bumper.kind": 0}
    parameters = settings.parameters()
    period_s = float(parameters["controller.period"])
    tare_s = float(parameters["estimator.tare_ticks"]) * period_s
    try:
        hit_s = tare_s + BEFORE_S
        slider = meet(Approach(edge_middle(outline_of(testbed), SIDE), speed_mps, time_s=hit_s), testbed, Rest())
        return Scenario(
            "recorded collision",
            hit_s + AFTER_S,
            step_s=period_s,
            bumper="none",
            testbed=slider,
            controller=settings.assignments,
            robot=robot,
            preset=settings.preset,
        )
    except GivewayError as error:
        raise FileError(robot, f"no collision can be recorded with this robot ({error})") from None


def _recording(settings: Settings, sensed: dict[str, NDArray[Any]], speed_mps: float) -> Recording:
    scaling = Scaling.of(settings)
    torque, encoder = (
        np.stack([sensed[f"sensor.{name}[{wheel}]"] for wheel in range(WHEELS)], axis=1)
        for name in ("torque", "encoder")
    )
    counts = np.rint(torque / scaling.torque_per_count).astype(np.int64)
    has_imu = bool(settings.parameters()["imu.use"])
    imu = np.stack([sensed[name] for name in _IMU], axis=1).astype(np.float32) if has_imu else None
    inputs = _inputs(scaling, counts, encoder, sensed, imu)
    outputs = _answers(settings, inputs)
    words = np.stack([to_words(values) for values in outputs.values()], axis=1)
    return Recording(
        torque_count=counts,
        encoder_count=encoder.astype(np.int64),
        counter=sensed["sensor.counter"].astype(np.int64),
        present=sensed["sensor.present"].astype(np.bool_),
        imu=imu,
        imu_counter=sensed["sensor.imu_counter"].astype(np.int64),
        imu_present=sensed["sensor.imu_present"].astype(np.bool_),
        outputs=words,
        hits=int(outputs["detection.count"][-1]),
        speed_mps=speed_mps,
    )


def _inputs(
    scaling: Scaling,
    counts: NDArray[np.int64],
    encoder: NDArray[Any],
    sensed: dict[str, NDArray[Any]],
    imu: NDArray[np.float32] | None,
) -> dict[str, NDArray[Any]]:
    """The controller's inputs, with the arithmetic of main_step.c."""
    signal = counts.astype(np.float32) * np.float32(scaling.per_count)
    if scaling.torque_per_ampere is not None:
        signal = signal * np.float32(scaling.torque_per_ampere)
    rows = len(counts)
    inputs: dict[str, NDArray[Any]] = {v.name: np.zeros(rows) for v in table("controller").select("input")}
    for wheel in range(WHEELS):
        inputs[f"sensor.torque[{wheel}]"] = signal[:, wheel].astype(np.float64)
        inputs[f"sensor.encoder[{wheel}]"] = encoder[:, wheel]
    names = ["sensor.counter", "sensor.present"]
    if imu is not None:
        inputs |= {name: imu[:, column].astype(np.float64) for column, name in enumerate(_IMU)}
        names += ["sensor.imu_counter", "sensor.imu_present"]
    return inputs | {name: sensed[name] for name in names}


def _answers(settings: Settings, inputs: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    from giveway.library.replay import ReplayedController

    parameters = settings.parameters()
    names = [variable.name for variable in table("controller").select("output")]
    with ReplayedController(parameters, float(parameters["controller.period"]), names) as controller:
        return controller.play(inputs)


def to_words(values: NDArray[Any]) -> NDArray[np.uint32]:
    """As controller_words.c has them: a real, which was a float, by its bits."""
    if values.dtype.kind == "f":
        return values.astype(np.float32).view(np.uint32)
    return values.astype(np.int64).astype(np.uint32)
