"""A user's own scenario as a TOML file; `giveway schema scenario` lists its keys, `examples/` has files to start from.

Points are on the robot (base frame, m), directions and headings in the world (degrees). Instead of [collision] the
file may state what collides by the testbed's parameters, ``slider.present = true`` and the others, to the last bit. A
wrong file is refused with one message that names file, line and key; ranges are those of the variable tables and of the
plans.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.base.toml_sections import Section, lines_named, read_toml, renamed
from giveway.base.units import factor
from giveway.robot.presets import DEFAULT, PRESETS
from giveway.robot.variables import Value, table
from giveway.scenario.arcs import EVERY_WHEEL, Arcs, wheels_of
from giveway.scenario.plan import Circle, Plan, Pushes, Rest, Straight, TimedPush, start_values
from giveway.scenario.plan_limits import check_plan_of
from giveway.scenario.scenario import BUMPERS, Scenario
from giveway.scenario.scenario_shape import SCHEMA_VERSION, scenario_shape
from giveway.scenario.stated_bumper import law_of, stated_bumper
from giveway.scenario.stated_contact import StatedContact

__all__ = ["PLAN_KEYS", "SET_BY", "read_scenario", "scalars", "scenario_of"]

START_ACCELERATION_MPS2 = 0.2
MEETING_S = 0.5
SWING_RAD, SWING_HZ, SWINGS, STANDING_S = 1.5, 0.1, 2, 1.0  # of arcs
PLAN_KEYS = {  # fields of plans, by the file's keys
    "speed_mps": "speed",
    "acceleration_mps2": "acceleration",
    "frequency_hz": "frequency",
}
# Parameters that a key of the file sets; [testbed] must not set them again.
SET_BY = {
    "bumper.kind": "bumper",
    "electronics.seed": "seed",
    "base.tipping": "collision.height",
    "contact.height": "collision.height",
    "rope.attached": "collision.rope",
    "slider.present": "collision",
    "slider.mass": "collision.mass",
    "slider.direction": "collision.direction",
    "slider.target_x": "collision.point",
    "slider.target_y": "collision.point",
    "slider.run_up": "collision.time",
    "slider.speed": "collision.speed",
    **{f"start.{name}": "plan" for name in ("x", "y", "theta", "vx", "vy", "omega")},
}


def read_scenario(
    path: Path | str, *, bumper: str | None = None, robot: Path | None = None, preset: str | None = None
) -> Scenario:
    """The scenario in the file ``path``, checked; ``bumper``, ``robot`` and ``preset`` replace the file's.

    Raises:
        FileError: the file cannot be read.
        InputFileError: it is not TOML, or contains something unknown, of the wrong type, out of range or contradictory;
            names the line.
    """
    path = Path(path)
    text, document = read_toml(path, "give the path of a scenario file (TOML)")
    with lines_named(path, text):
        scenario = scenario_of(document, path, bumper, robot, preset)
        with renamed("plan", **PLAN_KEYS):
            check_plan_of(scenario)
        return scenario


def scenario_of(
    document: Mapping[str, Any],
    path: Path,
    bumper: str | None = None,
    robot: Path | None = None,
    preset: str | None = None,
) -> Scenario:
    """The scenario of ``document``, as if read from the file ``path``; errors name its keys, without lines."""
    top = Section("", document, scenario_shape())
    top.required("schema_version", str(SCHEMA_VERSION))
    seed = top.values.get("seed")
    if robot is None and "robot" in top.values:
        robot = native.robot_file("robot", top.text("robot"), path.parent)
        if not robot.is_file():
            allowed = "a robot file, its path seen from this file, or the name of a shipped robot"
            raise GivewayError("robot", top.values["robot"], allowed)
    collision, pushes = top.table("collision"), _pushes(top)
    stated = collision is None and _states_slider(top)
    collides = stated or collision is not None
    if not collides and law_of(top.values.get("bumper", "none")) != "none":
        allowed = "none without [collision]: the bumper is on what collides"
        raise GivewayError("bumper", law_of(top.values["bumper"]), allowed)
    for key in ("body_region", "judge_as"):
        if not collides and key in top.values:
            raise GivewayError(key, top.values[key], "nothing without [collision]: it is about a contact")
    plan = _plan(top, robot)
    overrides = {model: _overrides(top, model, stated) for model in ("testbed", "controller")}
    start = {name: value for name, value in start_values(plan).items() if name not in overrides["testbed"]}
    kind, numbers = _bumper(top, path.parent, bumper)
    for name in numbers:
        if name in overrides["testbed"]:
            raise GivewayError(f"testbed.{name}", overrides["testbed"][name], "one place to set it: bumper")
    with renamed("", duration_s="duration", contact_area_m2="contact_area"):
        bare = Scenario(
            name=top.text("name", path.stem),
            duration_s=top.number("duration"),
            bumper=kind,
            testbed={**overrides["testbed"], **numbers, **start, "slider.present": collides},
            controller=overrides["controller"],
            plan=plan,
            push=pushes,
            seed=seed,
            robot=robot,
            body_region=top.text("body_region") if "body_region" in top.values else None,
            judge_as=top.text("judge_as") if "judge_as" in top.values else None,
            contact_area_m2=_area_m2(top),
            preset=preset or top.choice("preset", PRESETS, DEFAULT),
        )
    for index, push in enumerate(pushes.pushes if pushes is not None else ()):
        if push.start_s >= bare.duration_s:
            allowed = f"a start before the end of the run at {bare.duration_s:g} s"
            raise GivewayError(f"push[{index}].start", push.start_s, allowed)
    if collision is None:
        return bare
    met, contact, time_s = _collision(collision, bare)
    if time_s >= bare.duration_s:
        field, found = ("collision.time", time_s) if contact.time_s is not None else ("duration", bare.duration_s)
        allowed = f"before the end of the run at {bare.duration_s:g} s"
        if contact.time_s is None:
            allowed = f"above {time_s:.3g} s, when the weight has pulled the slider to the robot"
        raise GivewayError(field, found, allowed)
    return dataclasses.replace(bare, testbed={**bare.testbed, **met}, contact=contact)


def _bumper(top: Section, folder: Path, instead: str | None) -> tuple[str, dict[str, Value]]:
    """Its law, and the numbers that its table states; ``instead``: another law, without these numbers."""
    if not isinstance(top.values.get("bumper"), Mapping):
        return instead or top.choice("bumper", BUMPERS, "none"), {}
    law, numbers = stated_bumper(top.values["bumper"], folder)
    return (law, numbers) if instead in (None, law) else (str(instead), {})


def _plan(top: Section, robot: Path | None) -> Plan:
    section = top.table("plan") or Section("plan", {"kind": "rest"}, None)
    kind = section.text("kind")
    heading = section.angle("heading", 0.0)
    if kind == "rest":
        with renamed("plan", x_m="x", y_m="y"):
            return Rest(section.number("x", 0.0), section.number("y", 0.0), heading)
    if kind == "arcs":
        return _arcs(section, heading, robot)
    speed, acceleration = section.number("speed"), section.number("acceleration", START_ACCELERATION_MPS2)
    if kind == "straight":
        with renamed("plan", x_m="x", y_m="y", **PLAN_KEYS):
            x, y = section.number("x", 0.0), section.number("y", 0.0)
            return Straight(speed, section.angle("direction", 0.0), x, y, heading, acceleration)
    centre = section.pair("centre", (0.0, 0.0))
    turning = "turning" if section.flag("turning", False) else "fixed"
    with renamed("plan", diameter_m="diameter", centre_x_m="centre", centre_y_m="centre", **PLAN_KEYS):
        start = section.angle("start", 0.0)
        return Circle(section.number("diameter"), speed, *centre, start, turning, heading, acceleration)


def _arcs(section: Section, heading_rad: float, robot: Path | None) -> Arcs:
    """The wheels are those of the robot file."""
    fields = {"swing_rad": "swing", "rest_s": "rest", "x_m": "x", "y_m": "y", "wheels": "wheels"}
    with renamed("plan", **fields, **PLAN_KEYS):
        return Arcs(
            _shares(section),
            section.angle("swing", SWING_RAD),
            section.number("frequency", SWING_HZ),
            section.whole("swings", SWINGS),
            section.number("rest", STANDING_S),
            *wheels_of(robot),
            section.number("x", 0.0),
            section.number("y", 0.0),
            heading_rad,
        )


def _shares(section: Section) -> tuple[tuple[float, float, float], ...]:
    """For each arc the share of the swing of each wheel."""
    if "wheels" not in section.values:
        return EVERY_WHEEL
    return tuple((float(a), float(b), float(c)) for a, b, c in section.values["wheels"])


def _pushes(top: Section) -> Pushes | None:
    if "push" not in top.values:
        return None
    names = {"force_n": "force", "start_s": "start", "duration_s": "duration", "ramp_s": "ramp"}
    pushes: list[TimedPush] = []
    for section in top.rows("push"):
        point = section.pair("point")
        with renamed(section.name, point_x_m="point", point_y_m="point", **names):
            pushes.append(
                TimedPush(
                    section.number("force"),
                    section.angle("direction"),
                    *point,
                    section.number("start"),
                    section.number("duration"),
                    section.number("ramp", 0.0),
                )
            )
            Pushes(tuple(pushes))  # so that an overlap is reported with the later one's line
    return Pushes(tuple(pushes))


def _states_slider(top: Section) -> bool:
    """Whether [testbed] has what collides, parameter by parameter."""
    testbed = top.values.get("testbed", {})
    return isinstance(testbed, Mapping) and dict(scalars(testbed)).get("slider.present") is True


def _overrides(top: Section, model: str, stated: bool) -> dict[str, Value]:
    """Checked parameters of [testbed] or [controller]; dotted names and lists as in the variable tables.

    ``stated``: what collides is stated here; so are seed and start, where no key of the file has them.
    """
    found: dict[str, Value] = {}
    for name, value in scalars(top.values.get(model, {})):
        key = SET_BY.get(name, "") if model == "testbed" else ""
        if key and not (stated and key != "bumper" and key.partition(".")[0] not in top.values):
            raise GivewayError(f"{model}.{name}", value, f"one place to set it: {SET_BY[name]}")
        try:
            found[name] = table(model).check(name, value)
            if isinstance(value, str) or isinstance(value, bool) != isinstance(found[name], bool):
                raise GivewayError(name, value, table(model)[name].allowed)
        except GivewayError as error:
            error.field = f"{model}.{name}"
            raise
    return found


def scalars(values: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Names and values of nested tables: ``slider.friction``; lists as ``x[0]``, ``x[1]``."""
    for key, value in values.items():
        if isinstance(value, Mapping):
            yield from scalars(value, f"{prefix}{key}.")
        elif isinstance(value, list):
            yield from ((f"{prefix}{key}[{index}]", entry) for index, entry in enumerate(value))
        else:
            yield f"{prefix}{key}", value


def _collision(section: Section, bare: Scenario) -> tuple[dict[str, Value], StatedContact, float]:
    """The testbed's parameters for the dummy, the intended contact, and its time, s."""
    from giveway.scenario.approach import Approach, edge_middle, meet_as_stated, outline_of

    set_already = bare.parameters("testbed")
    mass = section.number("mass", float(set_already.get("slider.mass", table("testbed")["slider.mass"].start or 0.0)))
    with renamed("collision", **{"testbed.slider.mass": "mass"}):
        set_already["slider.mass"] = table("testbed").check("slider.mass", mass)
        # refuses a mass that is not the body's
        dataclasses.replace(bare, testbed={**bare.testbed, "slider.mass": mass})
    everything = {v.name: set_already.get(v.name, v.start) for v in table("testbed").select("parameter")}
    testbed = {name: value for name, value in everything.items() if value is not None}
    if "edge" in section.values and "point" in section.values:
        raise GivewayError("collision.edge", section.values["edge"], "one place to choose: edge and offset, or point")
    if "offset" in section.values and "edge" not in section.values:
        raise GivewayError("collision.offset", section.values["offset"], "only with edge: it counts from its middle")
    names = {"point_m": "point", "offset_m": "offset", "speed_mps": "speed", "direction_rad": "direction"}
    with renamed("collision", edge="edge", time_s="time", **names):
        if "edge" in section.values:
            point = edge_middle(outline_of(testbed), section.values["edge"], section.number("offset", 0.0))
        else:
            point = section.pair("point")
        rope = section.flag("rope", False)
        time_s = None if rope and "time" not in section.values else section.number("time", MEETING_S)
        direction = section.angle("direction") if "direction" in section.values else None
        approach = Approach(point, section.number("speed"), direction, time_s, rope)
        slider, contact, meeting_s = meet_as_stated(approach, testbed, bare.plan, _tare_s(bare))
    return {"slider.mass": mass} | slider | _height(section), contact, meeting_s


def _area_m2(top: Section) -> float | None:
    """The area of the contact, stated with its unit."""
    section = top.table("contact_area")
    if section is None:
        return None
    section.required("unit", '"cm2", or another unit of an area')
    return section.number("value") * factor(section.full("unit"), section.text("unit"), "m2")


def _height(section: Section) -> dict[str, Value]:
    """A height above the floor matters to a base that can tip."""
    if "height" not in section.values:
        return {}
    with renamed("collision", **{"testbed.contact.height": "height"}):
        height = table("testbed").check("contact.height", section.number("height"))
    return {"base.tipping": True, "contact.height": height}


def _tare_s(scenario: Scenario) -> float:
    """How long the controller tares before the plan's clock starts, s."""
    values, variables = scenario.parameters("controller"), table("controller")
    ticks, period = (values.get(n, variables[n].start) for n in ("estimator.tare_ticks", "controller.period"))
    return float(ticks or 0) * float(period or 0.0)
