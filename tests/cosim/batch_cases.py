"""Scenarios that differ in what they ask of the batch library, for every test that compares two ways to run it."""

from __future__ import annotations

import giveway
import numpy as np
from cosim_helpers import short
from giveway.robot.presets import NO_REFLEX
from giveway.scenario.scenario import BUMPERS
from numpy.typing import NDArray


def push(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """60 N towards -x at the corner over wheel 0, from 0.2 to 0.35 s."""
    rows = np.zeros((len(time_s), 4))
    rows[(time_s >= 0.2) & (time_s < 0.35)] = (-60.0, 0.0, 0.35, 0.0)
    return rows


def strong_push(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    rows = np.zeros((len(time_s), 4))
    rows[time_s >= 0.1, 0] = 1e5
    return rows


def drive_left(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """From rest to 0.1 m/s in 0.2 s; the hit comes in between."""
    moving = np.clip(time_s, 0.0, 0.2)
    rows = np.zeros((len(time_s), 9))
    rows[:, 7] = 0.5 * (time_s < 0.2)
    rows[:, 4] = 0.5 * moving
    rows[:, 1] = 0.25 * moving**2 + 0.1 * np.clip(time_s - 0.2, 0.0, None)
    return rows


def drive_too_fast(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """From rest to 0.8 m/s and 2 rad/s at once: the controller's limits are 0.5 m/s and 1.5 rad/s."""
    moving = np.clip(time_s - 0.1, 0.0, None)
    rows = np.zeros((len(time_s), 9))
    rows[:, 3], rows[:, 0] = 0.8 * (moving > 0.0), 0.8 * moving
    rows[:, 5], rows[:, 2] = 2.0 * (moving > 0.0), 2.0 * moving
    return rows


# Thrown across the floor on bristles a thousand times as stiff as real ones: an explicit integrator must give up.
UNSOLVABLE = {
    "solver.method": 0,
    "slider.present": False,
    "roller.coulomb_torque": 0.001,
    **{f"roller.presliding_stiffness[{wheel}]": 1e7 for wheel in range(3)},
}

CASES: dict[str, giveway.Scenario] = {
    **{bumper: short(bumper) for bumper in BUMPERS},
    "seed": short(seed=4711),
    "parameters": short(
        testbed={"slider.mass": 13.62, "drivetrain.stiffness": 400.0, "bumper.mount": 1, "slider.run_up": 0.2},
        controller={"detector.force_threshold": 30.0, "controller.drives_enabled": True, "estimator.average_window": 7},
    ),
    "paper": short(preset="paper"),
    "push": short(push=push, testbed={"slider.present": False}),
    "plan": short(plan=drive_left),
    "rest elsewhere": short(plan=giveway.scenario.plan.Rest(0.3, -0.2, 0.4)),
    "Adams": short(testbed={"solver.method": 1}),
    "BDF": short(testbed={"solver.method": 2}),
    "half a millisecond": short(step_s=0.0005),
    "odd step": short(step_s=0.0007, duration_s=0.35),
}

JUDGED: dict[str, giveway.Scenario] = {
    **CASES,
    "long": short(duration_s=2.0),
    "a person": short(duration_s=1.0, judge_as="lower leg", preset="paper"),
    "no transient contact allowed": short(judge_as="skull"),
    "pressed into its stop": short("spring", testbed={"bumper.travel": 0.01}),
    "thrown back": short(
        "spring", duration_s=1.0, testbed={"rope.attached": False, "slider.speed": 0.5, "slider.run_up": 0.05}
    ),
    "caught again": short(duration_s=1.0, testbed={"rope.attached": False, "slider.speed": 0.7, "slider.run_up": 0.05}),
    "tips": short(testbed={"base.tipping": True}),
    "no contact": short(testbed={"slider.present": False}),
    "contact in the last row": short(duration_s=0.158),
    "hit twice": short("none", duration_s=0.8, preset="paper"),
    "drives into it": giveway.experiment("moving").scenario("none", 0.1),
    "a plan beyond the limits": short(
        plan=drive_too_fast,
        duration_s=0.4,
        testbed={"slider.present": False},
        controller={"detector.impulse_threshold": 1000.0},
    ),
    "sensor at its end": short("none", testbed={"electronics.torque_range": 3.0}),
    "sensor fault": short("none", controller={"sensor_check.torque_limit": 3.0}),
    "motor at its end": short(duration_s=0.4, testbed={"drivetrain.torque_limit": 5.0}, preset="paper"),
    "no detection": short(controller=NO_REFLEX),
}
