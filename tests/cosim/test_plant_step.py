"""The step of the fixed-step method follows the stiffest element, whichever it is: each in turn is the only stiff one.

A vibration w may turn by 0.2 rad in a step, a decay 1/s by 0.6 (docs/site/explanation/fixed_steps.md); w^2 is
stiffness over reduced mass, worked out here from the equations in fmu/plant/README.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from cosim_helpers import short
from giveway import batch
from giveway.robot.variables import Value

TICK_S = 5e-4
BRISTLE, TANH = 0, 1  # roller.model
CONTINUOUS, IDEAL = 0, 1  # bumper.latch_model

ANGLE_RAD, EXPONENT = 0.2, 0.6
BASE_KG, SLIDER_KG, PLATE_KG, WEIGHT_KG = 30.0, 5.0, 0.5, 4.0
CARRIAGE_KG, SHARE_KG = SLIDER_KG - PLATE_KG, BASE_KG / 3.0
MOTOR_KGM2, WHEEL_KGM2, RADIUS_M, ROLLER_M = 0.05, 0.003, 0.1, 0.01
SPEED_MPS, RUN_UP_M = 0.5, 0.1  # of the slider

SOFT: dict[str, Value] = {
    "base.mass": BASE_KG, "wheel.radius": RADIUS_M, "wheel.inertia": WHEEL_KGM2, "roller.radius": ROLLER_M,
    "roller.model": TANH, "roller.coulomb_torque": 0.0, "roller.presliding_damping": 0.0,
    "drivetrain.motor_inertia": MOTOR_KGM2, "drivetrain.stiffness": 100.0, "drivetrain.damping": 0.0,
    "drivetrain.gear_viscous": 0.0, **{f"roller.presliding_stiffness[{i}]": 10.0 for i in range(3)},
    "slider.mass": SLIDER_KG, "slider.friction": 0.0, "slider.damping": 0.0, "slider.friction_speed": 0.01,
    "slider.speed": SPEED_MPS, "rope.attached": False, "rope.hanging_mass": WEIGHT_KG, "rope.stiffness": 10.0,
    "rope.damping": 0.0, "rope.floor_stiffness": 100.0, "rope.floor_damping": 0.0, "rope.drop_height": 0.2,
    "slider.run_up": RUN_UP_M, "bumper.plate_mass": PLATE_KG, "bumper.spring_rate": 1.0, "bumper.damping": 0.0,
    "bumper.guide_friction": 0.0, "bumper.guide_friction_speed": 0.01, "bumper.stop_stiffness": 1000.0,
    "bumper.stop_damping": 0.0, "bumper.latch_model": IDEAL, "contact.stiffness": 100.0, "contact.damping": 0.0,
    "contact.friction": 0.0, "contact.friction_speed": 0.005, "wall.stiffness": 100.0, "wall.damping": 0.0,
}  # fmt: skip


def together(a: float, b: float) -> float:
    return a * b / (a + b)


def hunt_crossley(stiffness: float, mass: float) -> float:
    """Decay per unit of damping, 1/s: k d x/m, at the depth v sqrt(m/k) that the impact reaches."""
    return stiffness * SPEED_MPS * math.sqrt(mass / stiffness) / mass


GUIDED_KG, HIT_KG = together(PLATE_KG, CARRIAGE_KG), together(PLATE_KG, BASE_KG)
TURNED_KGM2 = together(MOTOR_KGM2, WHEEL_KGM2 + SHARE_KG * RADIUS_M**2)
PULLED_KG, BARE_KG = together(CARRIAGE_KG, WEIGHT_KG), together(SLIDER_KG, BASE_KG)
Element = Callable[[float], dict[str, Value]]
# The parameter that makes w rad/s of it.
VIBRATIONS: dict[str, Element] = {
    "contact": lambda w: {"contact.stiffness": w**2 * HIT_KG},
    "contact without a bumper": lambda w: {"contact.stiffness": w**2 * BARE_KG, "bumper": "none"},
    "spring": lambda w: {"bumper.spring_rate": w**2 * GUIDED_KG},
    "spring on the robot": lambda w: {
        "bumper.spring_rate": w**2 * together(PLATE_KG, BASE_KG), "bumper.mount": 1,
        "slider.target_x": 0.153046, "slider.target_y": 0.265083,  # where the bumper is
    },
    "stop": lambda w: {"bumper.stop_stiffness": w**2 * GUIDED_KG},
    "continuous latch": lambda w: {
        # Its force is F/(1 + c/gap)^2, steepest at c = 0.
        "bumper.latch_model": CONTINUOUS, "bumper.latch_gap": 1e-4, "bumper.latch_force": 0.5e-4 * w**2 * GUIDED_KG,
    },
    "rope": lambda w: {"rope.stiffness": w**2 * PULLED_KG, "rope.attached": True},
    "floor under the weight": lambda w: {"rope.floor_stiffness": w**2 * WEIGHT_KG, "rope.attached": True},
    "wall": lambda w: {"wall.stiffness": w**2 * CARRIAGE_KG, "wall.present": True},
    "drivetrain": lambda w: {"drivetrain.stiffness": w**2 * TURNED_KGM2},
    "bristle of one wheel": lambda w: {
        "roller.model": BRISTLE, "roller.coulomb_torque": 10.0, "roller.presliding_stiffness[1]": w**2 * SHARE_KG,
    },
}  # fmt: skip
# The parameter that makes it decay with r per second.
DECAYS: dict[str, Element] = {
    "contact damping": lambda r: {"contact.stiffness": 400.0, "contact.damping": r / hunt_crossley(400.0, HIT_KG)},
    "contact damping at the speed that the weight gives": lambda r: {
        "contact.stiffness": 400.0, "rope.attached": True,
        "contact.damping": r / hunt_crossley(400.0, HIT_KG) * SPEED_MPS / math.hypot(
            SPEED_MPS, math.sqrt(2.0 * 9.81 * RUN_UP_M * WEIGHT_KG / (WEIGHT_KG + SLIDER_KG))
        ),
    },
    "contact friction": lambda r: {
        "contact.friction": r * 0.005 * together(SLIDER_KG, SHARE_KG) / (SPEED_MPS * math.sqrt(100.0 * HIT_KG)),
    },
    "rail friction": lambda r: {"slider.friction": r * 0.01 * CARRIAGE_KG},
    "rail damping": lambda r: {"slider.damping": r * CARRIAGE_KG},
    "bumper damping": lambda r: {"bumper.damping": r * GUIDED_KG},
    "guide friction": lambda r: {"bumper.guide_friction": r * 0.01 * GUIDED_KG},
    "stop damping": lambda r: {"bumper.stop_damping": r / hunt_crossley(1000.0, GUIDED_KG)},
    "rope damping": lambda r: {"rope.damping": r * PULLED_KG, "rope.attached": True},
    "wall damping": lambda r: {
        "wall.stiffness": 1e4, "wall.damping": r / hunt_crossley(1e4, CARRIAGE_KG), "wall.present": True,
    },
    "drivetrain damping": lambda r: {"drivetrain.damping": r * TURNED_KGM2},
    "gear": lambda r: {"drivetrain.gear_viscous": r * MOTOR_KGM2},
    "rollers": lambda r: {
        "roller.coulomb_torque": r * SHARE_KG * ROLLER_M**2 / 2.0, "roller.tanh_slope": 2.0,
    },
    "bristles at the speed of the impact": lambda r: {
        "roller.model": BRISTLE, "roller.coulomb_torque": 0.01,
        **{f"roller.presliding_stiffness[{i}]": r * 0.01 / ROLLER_M / SPEED_MPS for i in range(3)},
    },
    "bristle damping": lambda r: {
        "roller.model": BRISTLE, "roller.coulomb_torque": 10.0, "roller.presliding_damping": r * SHARE_KG,
    },
}  # fmt: skip
ELEMENTS = {**{name: (element, ANGLE_RAD) for name, element in VIBRATIONS.items()},
            **{name: (element, EXPONENT) for name, element in DECAYS.items()}}  # fmt: skip


def steps_per_tick(changes: dict[str, Value]) -> float:
    values = {**SOFT, **changes}
    scenario = short(str(values.pop("bumper", "magnetic")), testbed=values, duration_s=0.002)
    table = batch.run_many([scenario], method="fixed-step", threads=1)
    assert table["method"].values[0] == "fixed-step"
    return TICK_S / float(table["plant step"].values[0])


def test_nothing_is_stiff_to_begin_with() -> None:
    assert steps_per_tick({}) == 1.0


@pytest.mark.parametrize("name", ELEMENTS)
def test_the_stiffest_element_decides(name: str) -> None:
    element, bound = ELEMENTS[name]
    rate = bound / TICK_S  # where a step of a tick is just short enough
    # 1 % on either side: rounding is far less.
    assert steps_per_tick(element(0.99 * rate)) == 1.0
    assert steps_per_tick(element(1.01 * rate)) == 2.0
