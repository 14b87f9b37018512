"""Situations used by several tests: parameters, start states, start modes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from kkt_reference import (
    KIND_MAGNETIC,
    KIND_NONE,
    KIND_SPRING,
    LATCH_CONTINUOUS,
    LATCH_IDEALISED,
    MOUNT_ROBOT,
    MOUNT_SLIDER,
    NOSE_EDGE,
    ROLLER_BRISTLE,
    ROLLER_TANH,
    STATES,
    Inputs,
    Modes,
    Parameters,
    Reference,
)

# Not what its drawing says, on a floor that is not level.
UNEVEN = {
    "base_com_x": 0.03,
    "base_com_y": -0.02,
    "floor_slope": 0.02,
    "floor_azimuth": 2.5,
    "roller_friction_scale": [0.8, 1.2, 1.1],
    "drivetrain_friction_scale": [1.3, 0.7, 0.9],
}

# name: (bumper kind, mount, latch model, other parameters)
COLLISIONS = {
    "none": (KIND_NONE, MOUNT_SLIDER, LATCH_CONTINUOUS, {}),
    "spring on slider": (KIND_SPRING, MOUNT_SLIDER, LATCH_CONTINUOUS, {}),
    "magnetic continuous on slider": (KIND_MAGNETIC, MOUNT_SLIDER, LATCH_CONTINUOUS, {}),
    "magnetic idealised on slider": (KIND_MAGNETIC, MOUNT_SLIDER, LATCH_IDEALISED, {}),
    "spring on robot": (KIND_SPRING, MOUNT_ROBOT, LATCH_CONTINUOUS, {}),
    "magnetic continuous on robot": (KIND_MAGNETIC, MOUNT_ROBOT, LATCH_CONTINUOUS, {}),
    "magnetic idealised on robot": (KIND_MAGNETIC, MOUNT_ROBOT, LATCH_IDEALISED, {}),
    # A light dummy without rope bounces off: the plate returns and latches again.
    "idealised latch closes again on slider": (
        KIND_MAGNETIC,
        MOUNT_SLIDER,
        LATCH_IDEALISED,
        {"rope_attached": 0, "slider_mass": 4.0, "bumper_latch_force": 10.0},
    ),
    "idealised latch closes again on robot": (
        KIND_MAGNETIC,
        MOUNT_ROBOT,
        LATCH_IDEALISED,
        {"rope_attached": 0, "slider_mass": 4.0, "bumper_latch_force": 10.0},
    ),
    # Hits a corner: the contact point runs around the vertex while the robot turns.
    "vertex, tanh rollers, rubbing": (
        KIND_SPRING,
        MOUNT_SLIDER,
        LATCH_CONTINUOUS,
        {
            "roller_model": ROLLER_TANH,
            "contact_friction": 0.3,
            "slider_target_x": -0.177,
            "slider_target_y": 0.29,
        },
    ),
    # The spring is too soft and the drop too short: bottoming stop and landing weight.
    "bottoming and landing": (
        KIND_SPRING,
        MOUNT_SLIDER,
        LATCH_CONTINUOUS,
        {"bumper_spring_rate": 150.0, "bumper_travel": 0.03, "rope_drop_height": 0.05},
    ),
    # So low that only the wheels can be hit: the nose hits the end of wheel 1 off its middle and slips off.
    "on a wheel, rubbing": (
        KIND_NONE,
        MOUNT_SLIDER,
        LATCH_CONTINUOUS,
        {
            "outline_body": 0,
            "outline_wheels": 1,
            "contact_height": 0.03,
            "contact_friction": 0.3,
            "slider_target_x": -0.183,
            "slider_target_y": 0.25,
        },
    ),
    # Between the wheels, with the body: the nose ends up in the corner of body and wheel.
    "beside a wheel": (
        KIND_SPRING,
        MOUNT_SLIDER,
        LATCH_CONTINUOUS,
        {
            "outline_wheels": 1,
            "contact_height": 0.1016,
            "slider_target_x": -0.176092,
            "slider_target_y": 0.12,
            "slider_run_up": 0.06,
        },
    ),
    # Along a whole side: both corners press, and the robot lays itself against the edge.
    "long edge on a side": (
        KIND_NONE,
        MOUNT_SLIDER,
        LATCH_CONTINUOUS,
        {"contact_nose_shape": NOSE_EDGE, "slider_direction": 0.03, "slider_run_up": 0.02},
    ),
    "long edge on wheels, spring": (
        KIND_SPRING,
        MOUNT_SLIDER,
        LATCH_CONTINUOUS,
        {
            "contact_nose_shape": NOSE_EDGE,
            "outline_wheels": 1,
            "contact_height": 0.12,
            "contact_friction": 0.2,
            "slider_direction": -0.1,
            "slider_run_up": 0.08,
        },
    ),
    "uneven robot, spring on slider": (KIND_SPRING, MOUNT_SLIDER, LATCH_CONTINUOUS, UNEVEN),
    "uneven robot, idealised latch closes again on robot": (
        KIND_MAGNETIC,
        MOUNT_ROBOT,
        LATCH_IDEALISED,
        {"rope_attached": 0, "slider_mass": 4.0, "bumper_latch_force": 10.0, **UNEVEN},
    ),
    # A light dummy bounces off against the wall behind it.
    "against the wall": (
        KIND_NONE,
        MOUNT_SLIDER,
        LATCH_CONTINUOUS,
        {"rope_attached": 0, "slider_mass": 4.0, "wall_present": 1, "wall_distance": 0.004},
    ),
}


def collision(
    case: tuple[int, int, int, dict], **faults: float
) -> tuple[Reference, np.ndarray, Modes, list[tuple[float, Inputs]]]:
    """Slider at 0.5 m/s, 6 mm before the robot, off its centre; the robot stands, unpowered."""
    kind, mount, latch, other = case
    p = Parameters(bumper_kind=kind, bumper_mount=mount, bumper_latch_model=latch, slider_run_up=0.006)
    p = replace(
        p, slider_target_x=-0.25 if mount == MOUNT_ROBOT else -0.176092, slider_target_y=0.05, bumper_mount_y=0.04
    )
    p = replace(
        p,
        bumper_mount_azimuth=math.pi + 0.1,
        roller_presliding_stiffness=[2.2e4, 2.6e4, 3.0e4],
        contact_friction=0.1,
    )
    p = replace(p, **{**other, **faults})
    reference, x, modes = still(p)
    x[19] = 0.5
    if p.rope_attached:
        x[21] = 0.5
        modes.rope_taut = 1
    return reference, x, modes, [(0.0, Inputs())]


def disconnected(p: Parameters) -> Parameters:
    """No drive, no friction, no slider: nothing left but the rolling constraints."""
    return replace(
        p,
        drivetrain_stiffness=0.0,
        drivetrain_damping=0.0,
        roller_coulomb_torque=0.0,
        roller_presliding_stiffness=[0.0] * 3,
        roller_presliding_damping=0.0,
        roller_model=ROLLER_TANH,
        slider_present=0,
    )


def still(p: Parameters) -> tuple[Reference, np.ndarray, Modes]:
    """Everything at rest and unloaded: slider run_up away from the robot, bumper extended against
    its end."""
    reference = Reference(p)
    x = np.zeros(STATES)
    modes = Modes(latched=int(reference.ideal))
    if p.bumper_kind != KIND_NONE and not reference.ideal:
        # preload + latch + k c = end-stop force
        latch = p.bumper_latch_force if p.bumper_kind == KIND_MAGNETIC else 0.0
        x[22] = -(p.bumper_preload + latch) / (p.bumper_spring_rate + p.bumper_stop_stiffness)
        modes.end_stop = 1
    return reference, x, modes


def moving(p: Parameters, vx: float, vy: float, omega: float) -> tuple[Reference, np.ndarray, Modes]:
    """The base in motion, its drivetrains turning along without torque, no slider."""
    reference = Reference(replace(p, slider_present=0))
    x = np.zeros(STATES)
    x[3:6] = vx, vy, omega
    modes = Modes(roller=[round(phase / reference.pitch) for phase in p.roller_phase])
    x[9:12] = reference.rhs(0.0, x, Inputs(), modes)[12:15]
    modes.gear = [int(math.copysign(1.0, w)) for w in x[9:12]]
    return reference, x, modes


def pushed() -> tuple[Reference, np.ndarray, Modes, list[tuple[float, Inputs]]]:
    """An unpowered robot, pushed hard off its centre for 0.3 s, then let go: gears slide and stick
    again."""
    p = Parameters(slider_present=0, roller_presliding_stiffness=[2.2e4, 2.6e4, 3.0e4])
    reference, x, modes = still(p)
    x[2] = 0.3
    push = Inputs(push_force=(70.0, 40.0), push_point=(-0.1, 0.25))
    return reference, x, modes, [(0.0, push), (0.3, Inputs())]


def driven() -> tuple[Reference, np.ndarray, Modes, list[tuple[float, Inputs]]]:
    """Motor torques that step up, reverse and vanish; one beyond the torque limit."""
    p = Parameters(slider_present=0, drivetrain_torque_limit=12.0)
    reference, x, modes = still(p)
    torques = [
        (0.0, (0.0, 0.0, 0.0)),
        (0.05, (6.0, -5.0, 2.5)),
        (0.25, (-15.0, 5.0, 4.0)),
        (0.4, (0.0, 0.0, 0.0)),
    ]
    return reference, x, modes, [(t, Inputs(motor_torque=torque)) for t, torque in torques]


def spinning(roller_model: int) -> tuple[Reference, np.ndarray, Modes, list[tuple[float, Inputs]]]:
    """Coasting to rest from a translation with spin, unpowered."""
    reference, x, modes = moving(Parameters(roller_model=roller_model), 0.3, -0.2, 2.0)
    return reference, x, modes, [(0.0, Inputs())]


def one_by_one(p: Parameters, **other: object) -> Parameters:
    """Rollers that hand the contact over, each wheel on another part of its first one."""
    discrete = {"roller_arrangement": 1, "roller_phase": [0.05, -0.1, 0.16], "roller_friction_scatter": 0.2}
    return replace(p, **{**discrete, **other})


def rolling(**other: object) -> tuple[Reference, np.ndarray, Modes, list[tuple[float, Inputs]]]:
    """Coasting with spin on rollers one by one; a weak gear friction, so that the wheels turn far."""
    p = one_by_one(Parameters(drivetrain_gear_coulomb=0.1, drivetrain_gear_stiction=0.1), **other)
    reference, x, modes = moving(p, 0.3, -0.2, 4.0)
    return reference, x, modes, [(0.0, Inputs())]


def hit_on_rollers() -> tuple[Reference, np.ndarray, Modes, list[tuple[float, Inputs]]]:
    """A bumper on the robot that latches again, the robot turning on rollers one by one with long hand-overs."""
    case = COLLISIONS["idealised latch closes again on robot"]
    wide = {"roller_arrangement": 1, "roller_row_distance": 0.05, "roller_radius_dip": 5.0e-4}
    reference, x, modes, inputs = collision((*case[:3], {**case[3], **wide, "roller_phase": [0.17, -0.17, 0.172]}))
    x[5] = 1.0
    x[9:12] = reference.rhs(0.0, x, Inputs(), modes)[12:15]
    modes.gear = [1, 1, 1]
    return reference, x, modes, inputs


def all_runs() -> dict[str, tuple[Reference, np.ndarray, Modes, list[tuple[float, Inputs]]]]:
    runs = {f"collision, {name}": collision(case) for name, case in COLLISIONS.items()}
    runs |= {"pushed": pushed(), "driven": driven()}
    return runs | {
        "spinning, bristle": spinning(ROLLER_BRISTLE),
        "spinning, tanh": spinning(ROLLER_TANH),
        "rollers one by one, bristle": rolling(),
        "rollers one by one, tanh, three rows": rolling(roller_model=ROLLER_TANH, roller_rows=3, roller_per_row=7),
        "rollers one by one, hit": hit_on_rollers(),
    }
