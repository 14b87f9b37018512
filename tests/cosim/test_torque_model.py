"""The base-frame torques of (27) against the paper's world-frame equations, differentiated numerically."""

from __future__ import annotations

import math

import numpy as np
import pytest
from arc_logs import world_torques
from giveway.base import native
from giveway.identification.torque_model import TorqueModel
from giveway.robot.robot_file import read_robot

STEP_S = 1e-3


@pytest.fixture(scope="module")
def model() -> TorqueModel:
    return TorqueModel.of(read_robot(native.robot()))


def test_rigid_torques_and_roller_rates(model: TorqueModel) -> None:
    """A motion in which every wheel differs and the base turns, so that the frame's own rotation counts."""
    time = np.arange(0.0, 3.0, STEP_S)
    angle = np.stack([2.0 * np.sin(1.3 * time), 1.5 * time**2, 3.0 * np.cos(2.1 * time)], axis=1)
    wanted, wanted_rate = world_torques(angle, STEP_S, np.zeros_like)
    rate = np.gradient(angle, STEP_S, axis=0)
    found_rate, found = model.motion(rate, np.gradient(rate, STEP_S, axis=0))
    inner = slice(5, -5)  # one-sided differences at the ends
    assert np.abs(found_rate - wanted_rate)[inner].max() < 1e-9 * np.abs(wanted_rate).max()
    # Central differences of order two on both sides, of motions at up to 10 rad/s: (10 x 1e-3)^2 = 1e-4.
    assert np.abs(found - wanted)[inner].max() < 1e-4 * np.abs(wanted).max()
    assert np.abs(wanted).max() > 1.0


def test_friction_of_the_papers_first_arc(model: TorqueModel) -> None:
    """Wheel 0 moving: rollers 1 and 2 turn against each other, and the torques are as 2 : -1 : -1."""
    rate, _ = model.motion(np.array([[1.0, 0.0, 0.0]]), np.zeros((1, 3)))
    assert rate[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert rate[0, 1] == pytest.approx(-rate[0, 2])
    torque = model.friction_gain @ np.sign(np.round(rate[0], 9))
    # By hand: sqrt(3) B_r/r_r of drag across the base, two thirds of it on wheel 0.
    assert torque[0] == pytest.approx(2.0 / math.sqrt(3.0) * model.wheel_radius_m / model.roller_radius_m)
    assert torque / torque[0] == pytest.approx([1.0, -0.5, -0.5])
