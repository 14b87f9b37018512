"""A collision in closed form, with every number known by hand, as traces like those of a run.

The robot rests at the origin, heading 0. From t = 0.1 s a constant force of 40 N along the world direction 210 deg acts
at the base point (0.1, 0.05) for 0.2 s. The controller estimates 30 N along 200 deg and detects 50 ms after contact;
from then on the reference moves 0.5 m and the base 0.48 m along 210 deg.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray

STEP_S = 0.001
CONTACT_S, DETECTED_S, RELEASE_S, END_S = 0.1, 0.15, 0.3, 1.0
FORCE_N, DIRECTION_RAD = 40.0, math.radians(210.0)
ESTIMATE_N, ESTIMATE_RAD = 30.0, math.radians(200.0)
POINT_M, ESTIMATED_POINT_M = (0.1, 0.05), (0.13, 0.09)
SPEED_MPS = 0.5
TORQUE_NM = (1.5, -4.0, 2.5)  # while in contact
REVERSAL_NM = 6.0  # wheel 1 afterwards
AVERAGE_WINDOW = 10

PARAMETERS: dict[str, dict[str, Any]] = {
    "testbed": {
        "wheel.radius": 0.1,
        "wheel.distance": 0.24,
        "electronics.torque_range": 30.0,
        "drivetrain.torque_limit": 20.0,
    },
    "controller": {
        "estimator.average_window": AVERAGE_WINDOW,
        "controller.period": STEP_S,
        "sensor_check.torque_limit": 25.0,
    },
}


def traces(*, hit: bool = True, noticed: bool = True, heading_rad: float = 0.0) -> xarray.Dataset:
    """The traces; without ``hit`` nothing touches, without ``noticed`` nothing is detected.

    ``heading_rad`` turns the robot; world quantities stay, base-frame truth must follow.
    """
    time = np.arange(round(END_S / STEP_S) + 1) * STEP_S
    touching = (time >= CONTACT_S - 1e-9) & (time < RELEASE_S - 1e-9) & hit
    after = (time >= DETECTED_S - 1e-9) & hit & noticed
    toward = np.array([math.cos(DIRECTION_RAD), math.sin(DIRECTION_RAD)])
    impulse = FORCE_N * np.clip(time - CONTACT_S, 0.0, RELEASE_S - CONTACT_S) * hit
    escape = np.where(after, (time - DETECTED_S) / (END_S - DETECTED_S), 0.0)
    cos, sin = math.cos(heading_rad), math.sin(heading_rad)
    nose = SPEED_MPS * (time - CONTACT_S)
    columns: dict[str, Any] = {
        "testbed.truth.theta": np.full_like(time, heading_rad),
        "testbed.truth.contact": touching,
        "testbed.truth.contact_force": FORCE_N * touching,
        "testbed.truth.contact_base_x": (cos * POINT_M[0] + sin * POINT_M[1]) * touching,
        "testbed.truth.contact_base_y": (-sin * POINT_M[0] + cos * POINT_M[1]) * touching,
        "testbed.truth.first_contact_time": np.where((time >= CONTACT_S) & hit, CONTACT_S, -1.0),
        "testbed.truth.bumper_compression": 0.03 * touching,
        "testbed.truth.latched": np.zeros_like(touching),
        "testbed.truth.rope_taut": np.zeros_like(touching),
        "testbed.truth.tip_margin": np.ones_like(time),
        "testbed.events": np.zeros(len(time), dtype=np.int32),
        "testbed.energy.stored": 10.0 - 4.0 * time,
        "testbed.energy.work_in": 2.0 * time,
        "testbed.energy.dissipated": 6.0 * time,
        "testbed.energy.residual": 6e-6 * time,
        "controller.detection.count": after.astype(np.int32),
        "controller.detection.direction": np.where(after, ESTIMATE_RAD - heading_rad, 0.0),
        "controller.detection.point_x": np.where(after, ESTIMATED_POINT_M[0], 0.0),
        "controller.detection.point_y": np.where(after, ESTIMATED_POINT_M[1], 0.0),
        "controller.estimate.force": ESTIMATE_N * touching,
        "controller.mode": 1 + after.astype(np.int32),  # tracking, reacting
        "controller.reference.theta": np.zeros_like(time),
        **{f"controller.plan.{name}": np.zeros_like(time) for name in ("x", "y", "theta")},
    }
    for axis, share in zip("xy", toward, strict=True):
        columns[f"testbed.truth.{axis}"] = 0.48 * escape * share
        columns[f"testbed.truth.v{axis}"] = np.zeros_like(time)
        columns[f"testbed.truth.nose_{axis}"] = nose * share
        columns[f"testbed.truth.contact_force_{axis}"] = FORCE_N * share * touching
        columns[f"testbed.truth.contact_impulse_{axis}"] = impulse * share
        columns[f"controller.reference.{axis}"] = 0.5 * escape * share
    for axis, turn in zip("xy", (math.cos, math.sin), strict=True):
        columns[f"controller.estimate.force_{axis}"] = ESTIMATE_N * turn(ESTIMATE_RAD - heading_rad) * touching
    for wheel, torque in enumerate(TORQUE_NM):
        reversal = REVERSAL_NM * (time > 0.5) * (wheel == 1) * hit
        columns[f"testbed.truth.wheel_torque[{wheel}]"] = torque * touching + reversal
        columns[f"testbed.truth.motor_torque[{wheel}]"] = np.zeros_like(time)
        columns[f"testbed.sensor.torque[{wheel}]"] = torque * touching
    variables = {name: ("time", values) for name, values in columns.items()}
    return xarray.Dataset(variables, coords={"time": ("time", time)})
