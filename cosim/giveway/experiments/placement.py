"""Position of the collider in an experiment: for Trikey as in the paper, for any other robot by its own outline.

Trikey's start is kept to the last bit, since the fit was made with it. It also applies to a robot with Trikey's
outline.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.base.errors import FileError, GivewayError, InputFileError
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import Value, table
from giveway.scenario.plan import Rest, Straight
from giveway.scenario.stated_contact import StatedContact

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from giveway.scenario.approach import Approach
    from giveway.scenario.plan import Plan

__all__ = [
    "before_resting",
    "for_this_robot",
    "has_default_outline",
    "not_above",
    "outline_of_robot",
    "pulled_by_weight",
    "sliding_mass",
    "stated_contact",
    "tare_s",
    "testbed_of",
]

SIDE = 0  # of the outline, between corners 0 and 1: the one that the paper's slider hits
RUN_UP_SHARE = 0.04  # tolerance of a run-up: the speed at its end then differs by 2 %


def testbed_of(robot: Path | None) -> dict[str, Value]:
    """Every parameter of the testbed with the robot file ``robot``; None: the robot the FMUs were built with."""
    variables = table("testbed")
    start = {v.name: v.start for v in variables.select("parameter") if v.start is not None}
    return start if robot is None else start | variables.robot_values(read_robot(robot))


def outline_of_robot(robot: Path | None) -> NDArray[np.float64]:
    """Corners of the robot, base frame, m, anticlockwise, shape (n, 2)."""
    from giveway.scenario.approach import outline_of

    return outline_of(testbed_of(robot))


@contextmanager
def for_this_robot(experiment: str, robot: Path | None) -> Iterator[None]:
    """Errors of an experiment with ``robot`` name both."""
    try:
        yield
    except (FileError, InputFileError):
        raise
    except GivewayError as error:
        if robot is None:
            raise
        raise GivewayError("robot", robot, f"a robot with which {experiment} is possible ({error})") from None


def pulled_by_weight(experiment: str, robot: Path | None, speed_mps: float) -> dict[str, Value]:
    """``slider.*`` of a slider that the weight pulls into the middle of `SIDE` of the resting robot at ``speed_mps``.

    The run-up of the robot file is used if it gives that speed.
    """
    if robot is None:
        return {}
    from giveway.scenario.approach import Approach, edge_middle

    with for_this_robot(experiment, robot):
        testbed = testbed_of(robot)
        approach = Approach(edge_middle(outline_of_robot(robot), SIDE), speed_mps, rope=True)
        found = _meet(approach, testbed, Rest())
    run_up = float(found["slider.run_up"])
    if abs(float(testbed["slider.run_up"]) / run_up - 1.0) <= RUN_UP_SHARE:
        del found["slider.run_up"]
    if has_default_outline(robot):
        found = {name: value for name, value in found.items() if name == "slider.run_up"}
    return found


def before_resting(
    experiment: str, robot: Path | None, speed_mps: float, steady_s: float
) -> tuple[Straight, dict[str, Value]]:
    """The plan of a robot that drives with the middle of `SIDE` ahead, and ``slider.*`` of a slider in its way.

    They meet when the robot has been at ``speed_mps`` for ``steady_s``.
    """
    from giveway.scenario.approach import Approach, edge_middle, outward_normal

    with for_this_robot(experiment, robot):
        testbed = testbed_of(robot)
        if has_default_outline(robot):
            direction, target_x, target_y = (
                float(testbed[f"slider.{name}"]) for name in ("direction", "target_x", "target_y")
            )
            plan = Straight(speed_mps, direction + math.pi)
            travel_m = plan.ramp_m + speed_mps * steady_s
            return plan, {
                "slider.run_up": 0.0,
                "slider.target_x": target_x + travel_m * math.cos(plan.direction_rad),
                "slider.target_y": target_y + travel_m * math.sin(plan.direction_rad),
            }
        outline = outline_of_robot(robot)
        point = edge_middle(outline, SIDE)
        normal = outward_normal(outline, point)
        plan = Straight(speed_mps, math.atan2(normal[1], normal[0]))
        approach = Approach(point, 0.0, time_s=tare_s() + plan.ramp_s + steady_s)
        return plan, _meet(approach, testbed, plan)


def sliding_mass(robot: Path | None, mass_kg: float) -> float:
    """``mass_kg`` of the paper's slider; for a robot file with another slider, as many times that slider's mass."""
    return mass_kg * float(testbed_of(robot)["slider.mass"]) / float(testbed_of(None)["slider.mass"])


def not_above(robot: Path | None, height_m: float) -> float:
    """``height_m``, of a contact with Trikey; with a lower centre of mass in proportion lower."""
    heights = [float(testbed_of(one)["base.com_height"]) for one in (robot, None)]
    return height_m * min(1.0, heights[0] / heights[1])


def stated_contact(robot: Path | None, speed_mps: float, time_s: float | None = None) -> StatedContact:
    """The contact that an experiment asks for: in the middle of `SIDE`, this fast, and when, if that is stated."""
    from giveway.scenario.approach import edge_middle

    return StatedContact(speed_mps, edge_middle(outline_of_robot(robot), SIDE), time_s)


def tare_s() -> float:
    """How long the controller tares before the plan's clock starts, s."""
    controller = table("controller")
    return float(controller["estimator.tare_ticks"].start or 0) * float(controller["controller.period"].start or 0.0)


def _meet(approach: Approach, testbed: Mapping[str, Value], plan: Plan) -> dict[str, Value]:
    from giveway.scenario.approach import meet

    found = meet(approach, {**testbed, "bumper.kind": 0}, plan, tare_s())
    return {name: value for name, value in found.items() if name not in ("slider.present", "rope.attached")}


def has_default_outline(robot: Path | None) -> bool:
    """Whether the robot file ``robot`` has the outline of the robot the FMUs were built with, to the last bit."""
    mine, default = outline_of_robot(robot), outline_of_robot(None)
    return mine.shape == default.shape and bool((mine == default).all())
