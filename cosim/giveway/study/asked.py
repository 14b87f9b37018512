"""What a study asked of all its designs, in words: robot, reflex, plan, bumper, body region, contact, objectives."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from giveway.base import native
from giveway.base.units import WrittenUnit
from giveway.robot.presets import PRESETS
from giveway.robot.variables import table
from giveway.scenario.scenario import ROBOT_BUMPERS
from giveway.scenario.scenario_file import scalars
from giveway.scenario.stated_bumper import COMMON, NUMBERS
from giveway.study.distributions import DISTRIBUTIONS
from giveway.study.limits import limit_words
from giveway.study.part_rules import rules_in_words
from giveway.study.parts import choices_of
from giveway.study.quantities import columns
from giveway.study.search_plan import OPTIMISED

if TYPE_CHECKING:
    from giveway.study.distributions import Tolerance, Varied
    from giveway.study.setup import Goal, Setup

__all__ = ["all_asked", "asked", "in_words"]

CONTACT = ("stiffness", "damping", "friction", "nose_radius")
SPRING = ("spring_rate", "preload", "damping", "guide_friction", "travel", "plate_mass")  # of a bumper
LATCH = ("latch_force", "latch_gap")  # of a magnetic one
SOLID = ("damping", "guide_friction", "travel", "plate_mass")  # of one with another law
NOSES = ("round nose", "long edge")  # contact.nose_shape
MOUNTS = ("on the slider", "on the robot")  # bumper.mount
VARIES = "varies"


def asked(setup: Setup) -> list[tuple[str, str]]:
    """Name and text of each; what differs between the designs is said to vary."""
    scenario, document = setup.cases[0].scenario, setup.cases[0].document
    varied = {columns().names[column] for one in setup.varied for column in one.columns}
    variables = table("testbed")
    testbed = {variable.name: variable.start for variable in variables.select("parameter")}
    testbed |= scenario.parameters("testbed")

    def of(name: str) -> str:
        if f"testbed.{name}" in varied:
            return VARIES
        value, unit = testbed[name], variables[name].unit
        return f"{value:g}" + (f" {unit}" if unit not in ("", "1") else "")

    def choice(name: str, words: tuple[str, ...]) -> str:
        return VARIES if f"testbed.{name}" in varied else words[int(testbed[name] or 0)]

    robot = document.get("robot")
    kind = VARIES if "testbed.bumper.kind" in varied else scenario.bumper
    numbers: tuple[str, ...] = () if kind == "none" else SPRING if kind == "spring" else (*SPRING, *LATCH)
    if kind not in (*ROBOT_BUMPERS, VARIES):
        numbers = (*(name for name in NUMBERS[kind] if name not in COMMON), *SOLID)
    bumper = [kind, *([choice("bumper.mount", MOUNTS)] if numbers else [])]
    bumper += [f"{name.replace('_', ' ')} {of(f'bumper.{name}')}" for name in numbers]
    if kind == "table":
        stated = document["bumper"]
        points = f"{of('bumper.table_rows')} travels, {of('bumper.table_columns')} speeds"
        bumper.insert(1, f"{Path(stated['file']).name}: {points}" if isinstance(stated, dict) else points)
    contact = [choice("contact.nose_shape", NOSES)]
    contact += [f"{name.replace('_', ' ')} {of(f'contact.{name}')}" for name in CONTACT]
    rows = [
        ("robot", str(robot) if robot else f"{native.robot().name}, which the FMUs were built with"),
        ("plan", in_words(document["plan"]) if "plan" in document else "rest: the robot stands"),
        ("pushes", "; ".join(in_words(push) for push in document.get("push", []))),
        ("preset", f"{scenario.preset}: {PRESETS[scenario.preset]}"),
        ("bumper", ", ".join(bumper)),
        ("body region", _region(scenario.body_region, scenario.judge_as)),
        ("contact area", "{value:g} {unit}".format(**document["contact_area"]) if "contact_area" in document else ""),
        ("contact", ", ".join(contact) if setup.cases[0].hit is not None else "none"),
        ("testbed", in_words(dict(scalars(document.get("testbed", {}))))),
        ("controller", in_words(dict(scalars(document.get("controller", {}))))),
        ("duration", f"{scenario.duration_s:g} s"),
        ("sensor noise", _noise(setup)),
        ("linear drivetrain", _drivetrain(setup)),
        ("designs", _designs(setup)),
        ("objectives", "; ".join(in_words(one) for one in setup.document.get("objective", [])) or "none"),
    ]
    return [(name, words) for name, words in rows if words]


def _noise(setup: Setup) -> str:
    seed = setup.cases[0].scenario.seed
    words = "the model's own seed" if seed is None else f"seed {seed}"
    return words + (", another one in every tolerance sample" if setup.noise_seeds else "")


def _designs(setup: Setup) -> str:
    stated = dict(setup.document.get("designs", {"kind": setup.plan.kind}))
    if setup.plan.kind == OPTIMISED:
        search, told = setup.search, setup.document.get("optimise", {})
        stated |= {"designs": f"at most {search.designs:,}", "population": search.population}
        stated |= {key: value for key, value in told.items() if key not in stated}
    return in_words(stated)


def _drivetrain(setup: Setup) -> str:
    if not setup.derived:
        return ""
    load = {"base": "base in straight motion", "wheel": "lifted wheel"}[setup.drivetrain.load]
    return f"gear slides, load: {load}, servo delay: {setup.drivetrain.servo_delay} ticks"


def _region(given: str | None, judged: str | None) -> str:
    if given is not None:
        return f"{given}: what is hit, and its limits"
    return "none" if judged is None else f"{judged}: its limits only"


def in_words(values: Mapping[str, Any]) -> str:
    """A table of the study file on one line."""
    return ", ".join(f"{key} = {value}" for key, value in values.items())


def all_asked(setup: Setup) -> list[tuple[str, str]]:
    """The same, and what varies, tolerances, collisions, constraints and method: all that defines the study."""
    rows = asked(setup)
    rows += [(one.quantity.name, _range(one)) for one in setup.varied]
    rows += [(f"{choice.name} does not fit", rules_in_words(choice)) for choice in choices_of(setup.varied)]
    if setup.tolerance_count:
        rows.append(("tolerances", f"{setup.tolerance_count} samples, {setup.tolerance_kind}"))
        rows += [(f"tolerance of {one.quantity.name}", _tolerance(one)) for one in setup.tolerances]
        crowd = "one of its own in every tolerance sample, drawn as for `giveway crowd`; its controller keeps the file"
        rows.append(("robots", crowd if setup.crowd else "the file's in every tolerance sample"))
    hits = [(case.name, case.document.get("collision", {})) for case in setup.cases]
    rows += [(name, in_words(hit)) for name, hit in hits if hit]
    rows += [
        ("constraint", f"{one.goal.metric.name}: {limit_words(setup, index)}{_over(one.goal)}")
        for index, one in enumerate(setup.constraints)
    ]
    if "sure" in setup.document:
        rows.append(("how sure", in_words(setup.document["sure"])))
    step = "" if setup.plant_step_s is None else f", steps of {setup.plant_step_s:g} s"
    return [*rows, ("method, seed", f"{setup.method}{step}, {setup.seed}")]


def _over(goal: Goal) -> str:
    """How a constraint is taken over runs, where it is not the worst of all."""
    words = [f"{name}: {how}" for name, how in (("collisions", goal.collisions), ("tolerances", goal.tolerances))
             if how != "worst"]  # fmt: skip
    return f" ({', '.join(words)})" if words else ""


def _range(one: Varied) -> str:
    unit = f" {one.unit.shown}" if one.unit.shown else ""
    if one.parts is not None:
        many = f", {one.parts.count} of each" if one.parts.count > 1 else ""
        unit = f" ({one.parts.catalogue.path.name}{many})"
    if one.levels and one.spread is None:
        return (
            ", ".join(one.text(value) for value in one.levels[:12]) + (", ..." if len(one.levels) > 12 else "") + unit
        )
    if one.spread is None:
        return "from the file"
    levels = f", {len(one.levels)} levels" if one.levels else ""
    return f"{one.unit.of(one.spread.low):g} to {one.unit.of(one.spread.high):g}{unit}, {one.spread.kind}{levels}"


def _tolerance(one: Tolerance) -> str:
    spread = one.spread
    if not one.replaces and spread.low == -spread.high and not math.isinf(spread.high):
        if one.relative:
            return f"+-{100.0 * spread.high:g} %, {spread.kind}"
        return f"+-{one.unit.of(spread.high):g} {one.unit.name}, {spread.kind}"
    needed, _ = DISTRIBUTIONS[spread.kind]
    unit = WrittenUnit("%", 0.01) if one.relative else one.unit
    numbers = [f"{key} {unit.of(getattr(spread, key)):g}" for key in needed]
    ends = [f"{unit.of(end):g}" for end in (spread.low, spread.high)]
    words = f"{spread.kind}, {', '.join([*numbers, f'from {ends[0]} to {ends[1]}'])}"
    return ("" if one.replaces else "deviation ") + words + (f" {unit.shown}" if unit.shown else "")
