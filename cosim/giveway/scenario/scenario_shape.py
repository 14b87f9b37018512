"""What a scenario file may hold: the shapes by which it is read, and its JSON Schema."""

from __future__ import annotations

import functools
import math
import re
from dataclasses import dataclass
from typing import Any

from giveway.base.checks import finite
from giveway.base.errors import GivewayError
from giveway.base.shapes import (
    Angle,
    Choice,
    Either,
    Flag,
    Measure,
    Number,
    Pair,
    Rows,
    Shape,
    Table,
    Text,
    Variants,
    Version,
    Whole,
)
from giveway.library.run_up import LONGEST_RUN_UP_S
from giveway.robot.presets import PRESETS
from giveway.robot.variables import Variable, table
from giveway.robot.wheels import WHEELS
from giveway.scenario.arcs import MAXIMUM_FREQUENCY_HZ, MAXIMUM_SWINGS, MINIMUM_FREQUENCY_HZ, MINIMUM_SWING_RAD
from giveway.scenario.body_regions import body_regions
from giveway.scenario.plan import (
    MAXIMUM_ACCELERATION_MPS2,
    MAXIMUM_ARM_M,
    MAXIMUM_POSITION_M,
    MAXIMUM_PUSH_N,
    MAXIMUM_SPEED_MPS,
    MAXIMUM_TIME_S,
)
from giveway.scenario.scenario import BUMPERS, MAXIMUM_DURATION_S
from giveway.scenario.stated_bumper import bumper_shape

__all__ = ["NAME_MAX", "SCHEMA_VERSION", "collision_shape", "scenario_keys", "scenario_shape"]

SCHEMA_VERSION = 1
NAME_MAX = 80

_POSITION = Number("", -MAXIMUM_POSITION_M, MAXIMUM_POSITION_M, "m")
_HEADING = Angle("of the robot, world frame")
_ACCELERATION = Number("from rest (0.2)", 1e-3, MAXIMUM_ACCELERATION_MPS2, "m/s2")
_POSE: dict[str, Shape] = {"x": _POSITION, "y": _POSITION, "heading": _HEADING}


class _Arcs(Shape):
    """Arcs, each the share of the swing of every wheel."""

    def check(self, field: str, value: Any) -> None:
        if not isinstance(value, list) or not all(isinstance(arc, list) and len(arc) == WHEELS for arc in value):
            allowed = "a list of arcs, each the share of the swing of every wheel: [[1, 0, 0], [1, 1, 0]]"
            raise GivewayError(field, value, allowed)
        for share in (share for arc in value for share in arc):
            finite(field, share, -1.0, 1.0)

    def schema(self) -> dict[str, Any]:
        arc = {"type": "array", "items": Number("", -1.0, 1.0).schema(), "minItems": WHEELS, "maxItems": WHEELS}
        return super().schema() | {"type": "array", "items": arc, "minItems": 1}


_PLAN = Variants(
    "the robot's planned motion; at rest if left out",
    "kind",
    {
        "rest": Table("", _POSE),
        "straight": Table(
            "",
            {
                **_POSE,
                "speed": Number("", 0.0, MAXIMUM_SPEED_MPS, "m/s"),
                "direction": Angle("of travel, world frame"),
                "acceleration": _ACCELERATION,
            },
            ("speed",),
        ),
        "circle": Table(
            "",
            {
                "diameter": Number("", 1e-3, MAXIMUM_POSITION_M, "m"),
                "speed": Number("negative: clockwise", -MAXIMUM_SPEED_MPS, MAXIMUM_SPEED_MPS, "m/s"),
                "centre": Pair("[x, y], m", MAXIMUM_POSITION_M),
                "start": Angle("of the first point, about the centre"),
                "heading": _HEADING,
                "turning": Flag("the heading turns with the path"),
                "acceleration": _ACCELERATION,
            },
            ("diameter", "speed"),
        ),
        "arcs": Table(
            "",
            {
                **_POSE,
                "wheels": _Arcs("one arc after the other; left out: each wheel, each two"),
                "swing": Number("half of a wheel's travel (86)", math.degrees(MINIMUM_SWING_RAD), 360.0, "deg"),
                "frequency": Number("(0.1)", MINIMUM_FREQUENCY_HZ, MAXIMUM_FREQUENCY_HZ, "Hz"),
                "swings": Whole("of each arc (2)", 1, MAXIMUM_SWINGS),
                "rest": Number("before each arc (1)", 0.0, MAXIMUM_TIME_S, "s"),
            },
        ),
    },
)
_PUSH = Table(
    "",
    {
        "force": Number("", 0.0, MAXIMUM_PUSH_N, "N"),
        "direction": Angle("world frame"),
        "point": Pair("on the robot: base frame, [x, y], m", MAXIMUM_ARM_M),
        "start": Number("", 0.0, MAXIMUM_TIME_S, "s"),
        "duration": Number("", 1e-3, MAXIMUM_TIME_S, "s"),
        "ramp": Number("of rise and of fall", 0.0, 0.5 * MAXIMUM_TIME_S, "s"),
    },
    ("force", "direction", "point", "start", "duration"),
)


def _of(variable: Variable, about: str) -> Number:
    return Number(about, variable.minimum, variable.maximum, variable.unit)


@functools.cache
def collision_shape() -> Table:
    """The table ``[collision]``."""
    testbed = table("testbed")
    return Table(
        "what collides with the robot",
        {
            "mass": _of(testbed["slider.mass"], "whole sliding mass"),
            "speed": Number("along the rail at the contact; 0: the robot runs into it", 0.0, 20.0, "m/s"),
            "point": Pair("of the outline: base frame, [x, y], m"),
            "edge": Whole("side of the outline; 0: from corner 0 to corner 1"),
            "offset": Number("from the side's middle towards its next corner", unit="m"),
            "direction": Angle("of travel, world frame; left out: straight into the side"),
            "time": Number("when they touch (0.5)", 0.0, LONGEST_RUN_UP_S, "s"),
            "rope": Flag("a hanging weight pulls the slider from rest"),
            "height": _of(testbed["contact.height"], "of the contact above the floor: the base can tip"),
        },
        ("speed",),
    )


@functools.cache
def scenario_keys() -> dict[str, Shape]:
    """What a scenario file has at its top, less version, name and collision: a study's ``[scenario]`` has the same."""
    return {
        "duration": Number("simulated time", 0.0, MAXIMUM_DURATION_S, "s"),
        "bumper": Either(
            "none, spring or magnetic, with the robot file's numbers, or a table with another law",
            (Choice("", BUMPERS), bumper_shape()),
        ),
        "robot": Text("robot file, its path seen from this file, or the name of a shipped robot"),
        "preset": Choice("the controller's reflex", PRESETS),
        "seed": Whole("of the sensor noise"),
        "body_region": Choice("what is hit: it decides mass and stiffness, and its limits judge", body_regions()),
        "judge_as": Choice("whose limits judge what you state yourself", body_regions()),
        "contact_area": Measure("of the contact, for the mean pressure"),
        "plan": _PLAN,
        "push": Rows("pushes on the robot", _PUSH),
        "testbed": Parameters("parameters of the testbed: `giveway variables testbed`", "testbed"),
        "controller": Parameters("parameters of the controller: `giveway variables controller`", "controller"),
    }


@functools.cache
def scenario_shape() -> Table:
    """The whole file."""
    return Table(
        "a scenario for giveway run",
        {
            "schema_version": Version("of this format", SCHEMA_VERSION),
            "name": Text("what it is called", NAME_MAX),
            "collision": collision_shape(),
            **scenario_keys(),
        },
        ("schema_version", "duration"),
    )


@dataclass(frozen=True)
class Parameters(Shape):
    """Parameters of ``model``, as tables by the dots in their names; lists for those with several values."""

    model: str = ""

    def check(self, field: str, value: Any) -> None:
        if not isinstance(value, dict):
            raise GivewayError(field, value, "a table")

    def schema(self) -> dict[str, Any]:
        top: dict[str, Any] = _object()
        for variable in table(self.model).select("parameter"):
            *parents, last = variable.name.split(".")
            place = top
            for parent in parents:
                place = place["properties"].setdefault(parent, _object())
            name, index = (found[1], True) if (found := re.fullmatch(r"(.+)\[\d+\]", last)) else (last, False)
            if not index:
                place["properties"][name] = _parameter(variable)
                continue
            values = place["properties"].setdefault(
                name, {"type": "array", "items": _parameter(variable), "maxItems": 0}
            )
            values["maxItems"] += 1
        return super().schema() | top


def _object() -> dict[str, Any]:
    # A name in quotes, with its dots, is a key, too.
    return {"type": "object", "properties": {}, "patternProperties": {r"\.": {}}, "additionalProperties": False}


def _parameter(variable: Variable) -> dict[str, Any]:
    if variable.type == "boolean":
        return Flag(variable.description).schema()
    if variable.type == "integer":
        return Whole(variable.description, int(variable.minimum), int(variable.maximum)).schema()
    return _of(variable, variable.description).schema()
