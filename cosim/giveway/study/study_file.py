"""Study files: TOML, checked so that a wrong one is refused with file, line and key before anything runs.

`giveway schema study` lists the keys. What a scenario file says at its top is the table ``[scenario]`` here, and its
``[collision]`` is one of several ``[[collision]]``; ranges and names are checked where scenarios are.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from giveway.base.errors import GivewayError
from giveway.base.shapes import Choice, Either, Flag, List, Number, Rows, Shape, Table, Text, Version, Whole
from giveway.base.toml_sections import Section, lines_named, read_toml, renamed
from giveway.library.batch_library import METHODS, PLANT_STEP_RANGE_S
from giveway.scenario.plan_limits import LIMIT_NAMES, check_plan_of
from giveway.scenario.scenario import BUMPERS, Scenario
from giveway.scenario.scenario_file import PLAN_KEYS, scenario_of
from giveway.scenario.scenario_shape import NAME_MAX, collision_shape, scenario_keys
from giveway.scenario.stated_bumper import NUMBERS, acts
from giveway.simulation.run_warnings import plan_speed
from giveway.study.distributions import Varied
from giveway.study.drivetrain_metrics import DRIVETRAIN_TABLE, drivetrain_plan_of, metrics_shown, wanted
from giveway.study.influences import INFLUENCES
from giveway.study.metrics import Metric, find_metric, usual_sense
from giveway.study.part_rules import part_rules
from giveway.study.parts import PARTS, SUMS, PartChoice, choices_of, known_sums, part_metric, parts_of
from giveway.study.quantities import Quantity, columns
from giveway.study.runs import COVER
from giveway.study.search_plan import OPTIMISE, OPTIMISED, search_plan_of
from giveway.study.setup import Case, Constraint, Goal, Hit, Setup
from giveway.study.sure_plan import SURE, sure_plan_of
from giveway.study.variations import (
    DESIGNS,
    ROBOTS,
    TOLERANCE,
    VARY,
    crowd_of,
    designs_of,
    refuse_replaced,
    refuse_twice,
    tolerance_of,
    varied_of,
    written_unit,
)

__all__ = ["check", "read", "study_shape"]

SCHEMA_VERSION = 1
COLLISION_NAME_MAX = 40
OVER_COLLISIONS, OVER_TOLERANCES = ("worst", "mean"), ("worst", "mean", "nominal")
TOLERANCE_KINDS = ("sobol", "latin-hypercube", "corners")
SAMPLES_MAX, PART_MAX, CHOSEN_MAX, CORNERS_MAX = 1_000_000, 65_536, 20, 12
LIMITS = ("transient limit", "lasting limit")
SENSES = ("minimise", "maximise")

_GOAL: dict[str, Shape] = {
    "metric": Text("what is judged, such as peak force of the run"),
    "collisions": Choice("over all collisions (worst)", OVER_COLLISIONS),
    "tolerances": Choice("over the tolerances' samples (worst)", OVER_TOLERANCES),
}
_OBJECTIVE = Table(
    "what is wanted",
    {**_GOAL, "goal": Choice("(minimise)", SENSES), "weight": Number("in the ranking (1)", 0.0, 1e6)},
    ("metric",),
)
_LIMIT = Either("in unit, or a limit of the scenario's body region", (Number(), Choice("", LIMITS)))
_CONSTRAINT = Table(
    "what must be kept", {**_GOAL, "minimum": _LIMIT, "maximum": _LIMIT, "unit": Text("of the limit")}, ("metric",)
)
_TOLERANCES = Table(
    "how designs are tried within their tolerances",
    {
        "kind": Choice("of samples", TOLERANCE_KINDS),
        "samples": Whole("of each design (16)", 1, SAMPLES_MAX),
        "noise_seeds": Flag("sensor noise of its own for every sample"),
        "robot": Choice("whose robot a sample has", ROBOTS),
    },
)
_REPORT = Table(
    "what the report shows besides",
    {
        "metrics": List("", Text(), "a list of metrics"),
        "chosen": Whole("how many of the best designs get traces (3)", 0, CHOSEN_MAX),
    },
)


@functools.cache
def study_shape() -> Table:
    """The whole file."""
    collision = collision_shape()
    named = {"name": Text("a name of its own", COLLISION_NAME_MAX), **collision.keys}
    keys: dict[str, Shape] = {
        "schema_version": Version("of this format", SCHEMA_VERSION),
        "name": Text("what it is called", NAME_MAX),
        "seed": Whole("of the samplers (1)"),
        "method": Choice("of integration", METHODS),
        "plant_step": Number("with fixed steps; left out: as each run needs", *PLANT_STEP_RANGE_S, "s"),
        "part_runs": Whole("runs per stored part; 0: 5 s of work", 0, PART_MAX),
        "scenario": Table("what all designs share", scenario_keys(), ("duration",)),
        "collision": Rows("every design goes through all of them", Table("", named, collision.needed)),
        "designs": DESIGNS,
        "vary": Rows("", VARY),
        "parts": Rows("parts chosen from catalogues", PARTS),
        "tolerances": _TOLERANCES,
        "tolerance": Rows("", TOLERANCE),
        "sure": SURE,
        "drivetrain": DRIVETRAIN_TABLE,
        "objective": Rows("", _OBJECTIVE),
        "constraint": Rows("", _CONSTRAINT),
        "optimise": OPTIMISE,
        "report": _REPORT,
    }
    return Table("a study for giveway sweep and giveway optimise", keys, ("schema_version", "scenario"))


def read(path: Path | str, search: bool = False) -> Setup:
    """The study in the file ``path``, checked; ``search``: its designs are searched, whatever it says of them.

    Raises:
        FileError: it, or a file it names, cannot be read.
        InputFileError: it is no TOML, or something in it is wrong; names the line.
    """
    path = Path(path)
    text, document = read_toml(path, "give the path of a study file (TOML)")
    if search:
        document = {**document, "designs": {"kind": OPTIMISED}}
    with lines_named(path, text):
        return check(document, path.parent, path.stem, text, path)


def check(
    document: Mapping[str, Any], folder: Path, name: str = "study", text: str | None = None, path: Path | None = None
) -> Setup:
    """The study that ``document`` describes; relative paths in it start at ``folder``. Errors name its keys."""
    top = Section("", dict(document), study_shape())
    top.required("schema_version", str(SCHEMA_VERSION))
    method = top.choice("method", METHODS, METHODS[0])
    cases = _cases(top, folder)
    varied = tuple(varied_of(section) for section in top.rows("vary"))
    refuse_twice("vary", [one.quantity.name for one in varied])
    varied = (*parts_of(top.rows("parts"), folder), *varied)
    tolerances = tuple(tolerance_of(section) for section in top.rows("tolerance"))
    refuse_twice("tolerance", [one.quantity.name for one in tolerances])
    objectives = tuple(_objective(section, choices_of(varied)) for section in top.rows("objective"))
    search = search_plan_of(top, objectives)
    plan, varied = designs_of(top, varied, folder)
    if plan.kind == OPTIMISED:
        plan = dataclasses.replace(plan, count=search.designs)
    choices = choices_of(varied)
    for choice in choices:
        part_rules(choice)  # refuses half a rule
    _refuse_set_twice(varied)
    set_by_design = [quantity.name for one in varied for quantity in one.sets]
    for one in varied:
        for quantity in one.sets:
            field = f"{one.field}.quantity" if one.parts is None else f"{one.field}.sets.{quantity.name}"
            _fits_cases(field, quantity, cases, set_by_design)
    for choice in choices:
        for limit in choice.limits:
            if not limit.quantity.columns:
                key = "at_most" if limit.sense > 0 else "at_least"
                _fits_cases(f"{choice.field}.{key}.{limit.quantity.name}", limit.quantity, cases, set_by_design)
    laws = _laws(varied, cases[0].scenario.bumper)
    for one in varied:
        if one.parts is None:
            _fits_bumper(f"{one.field}.quantity", one.quantity, laws)
    for i, tolerance in enumerate(tolerances):
        _fits_bumper(f"tolerance[{i}].quantity", tolerance.quantity, laws)
        _fits_cases(f"tolerance[{i}].quantity", tolerance.quantity, cases, set_by_design)
        if tolerance.replaces:
            refuse_replaced(f"tolerance[{i}]", tolerance, varied)
    quantities = [quantity for one in varied for quantity in one.sets]
    _check_plans(cases, [*quantities, *(one.quantity for one in tolerances)])
    if plan.kind == "one-at-a-time":
        varied = tuple(_with_nominal(one, cases) for one in varied)
    drawn = top.table("tolerances") or Section("tolerances", {}, None)
    kind = drawn.choice("kind", TOLERANCE_KINDS, "sobol")
    noise = drawn.flag("noise_seeds", False)
    if kind == "corners" and len(tolerances) > CORNERS_MAX:
        raise GivewayError("tolerances.kind", kind, f"at most {CORNERS_MAX} tolerances with corners, or sobol")
    if kind == "corners":
        for tolerance in tolerances:
            if not tolerance.spread.bounded:
                raise GivewayError("tolerances.kind", kind, f"sobol: {tolerance.quantity.name} has no ends")
    crowd = crowd_of(drawn, cases, varied, tolerances, bool(tolerances or noise))
    spread = bool(tolerances or noise or crowd)
    if "samples" in drawn.values and not spread:
        allowed = 'with a [[tolerance]], noise_seeds = true or robot = "crowd": the samples would all be the same'
        raise GivewayError("tolerances.samples", drawn.values["samples"], allowed)
    count = drawn.whole("samples", 16) if spread else 0
    report = top.table("report") or Section("report", {}, None)
    judged = cases[0].scenario
    title = top.text("name", name)
    if not 1 <= len(title) <= NAME_MAX:  # of a file without a name: that of the file
        raise GivewayError("name", title, f"1 to {NAME_MAX} characters")
    constraints = tuple(_constraint(section, judged, choices) for section in top.rows("constraint"))
    drivetrain = drivetrain_plan_of(top)
    asked_for = _shown(report, choices)
    about_drivetrain = metrics_shown(drivetrain, cases)
    derived = wanted(
        {"objective": objectives, "constraint": [one.goal for one in constraints], "report.metrics": asked_for,
         "drivetrain": about_drivetrain},
        cases,
    )  # fmt: skip
    return Setup(
        name=title,
        document=dict(document),
        folder=folder,
        method=method,
        plant_step_s=_plant_step(top, method),
        seed=top.whole("seed", 1),
        cases=cases,
        varied=varied,
        plan=plan,
        tolerances=tolerances,
        tolerance_kind=kind,
        tolerance_count=count,
        noise_seeds=noise,
        crowd=crowd,
        sure=sure_plan_of(top),
        objectives=objectives,
        constraints=constraints,
        shown=(
            *(Goal(metric, 1) for metric in known_sums(choices)),
            *about_drivetrain,
            *_speeds(cases),
            *asked_for,
        ),
        chosen=report.whole("chosen", 3),
        part_runs=top.whole("part_runs", 0),
        search=search,
        drivetrain=drivetrain,
        derived=derived,
        text=text,
        path=path,
    )


def _check_plans(cases: Sequence[Case], quantities: Sequence[Quantity]) -> None:
    """Refuse a study whose plan no design can follow; where the controller's limits vary, each run is judged."""
    limits = {columns().index[f"controller.{name}"] for name in LIMIT_NAMES}
    if not any(limits & set(quantity.columns) for quantity in quantities):
        with renamed("scenario.plan", **PLAN_KEYS):
            for case in cases:
                check_plan_of(case.scenario)


def _refuse_set_twice(varied: Sequence[Varied]) -> None:
    """Two quantities that decide the same would hide each other where a part is one of them."""
    owner: dict[object, Varied] = {}
    for one in sorted(varied, key=lambda each: each.parts is not None):
        for quantity in one.sets:
            for target in quantity.columns or (quantity.name,):
                other = owner.setdefault(target, one)
                if other is not one and one.parts is not None:
                    allowed = f"what {other.field} ({other.quantity.name}) does not set, too"
                    raise GivewayError(f"{one.field}.sets.{quantity.name}", quantity.name, allowed)


def _plant_step(top: Section, method: str) -> float | None:
    if "plant_step" not in top.values:
        return None
    if method == METHODS[0]:
        raise GivewayError("plant_step", top.values["plant_step"], f"none with the method {method}")
    return top.number("plant_step")


def _cases(top: Section, folder: Path) -> tuple[Case, ...]:
    top.required("scenario", "a table")
    shared = top.table("scenario")
    assert shared is not None
    collisions = top.rows("collision")
    if not collisions:
        return (_case("", dict(shared.values), None, folder),)
    cases: list[Case] = []
    for index, section in enumerate(collisions):
        name = section.text("name", f"collision {index + 1}")
        if name in [case.name for case in cases]:
            raise GivewayError(f"{section.name}.name", name, "a name of its own")
        hit = {key: value for key, value in section.values.items() if key != "name"}
        cases.append(_case(name, dict(shared.values), hit, folder, section.name))
    return tuple(cases)


def _case(name: str, shared: dict[str, Any], hit: dict[str, Any] | None, folder: Path, field: str = "") -> Case:
    """One collision; errors in the names of the study file: ``scenario.duration``, ``collision[0].speed``."""
    document = {"schema_version": 1, "name": name or "study", **shared}
    if hit is not None:
        document["collision"] = hit
    try:
        scenario = scenario_of(document, folder / "study.toml")
    except GivewayError as error:
        if error.field.startswith("collision.") or error.field == "collision":
            error.field = error.field.replace("collision", field, 1)
        elif error.field.split(".")[0].split("[")[0] in scenario_keys():
            error.field = f"scenario.{error.field}"
        raise
    if hit is None:
        return Case("run", scenario, None, document)
    section = Section(field, hit, None)
    rope = section.flag("rope", False) and "time" not in hit
    return Case(
        name,
        scenario,
        Hit(
            speed_mps=section.number("speed"),
            time_s=None if rope else section.number("time", 0.5),
            edge=hit.get("edge"),
            offset_m=section.number("offset", 0.0),
            point_m=None if "point" not in hit else section.pair("point"),
            direction_deg=None if "direction" not in hit else section.number("direction"),
        ),
        document,
    )


def _fits_cases(field: str, quantity: Quantity, cases: Sequence[Case], varied: Sequence[str]) -> None:
    """Refuse what the collisions have no use for."""
    name = quantity.name
    for case in cases:
        hit, body = case.hit, case.scenario.body_region
        weighed = columns().index["testbed.slider.mass"] in quantity.columns
        if body is not None and not field.startswith("tolerance") and (name == COVER or weighed):
            allowed = f'what body_region = "{body}" does not decide, such as robot.contact.stiffness; or write judge_as'
            raise GivewayError(field, name, allowed)
        if name.startswith("collision.") and hit is None:
            raise GivewayError(field, name, "nothing of a collision without [[collision]]")
        if hit is None:
            continue
        if name == "collision.offset" and (hit.edge is None or "collision.around" in varied):
            raise GivewayError(field, name, f"an edge in every collision: {case.name} has none")
        if name == "collision.time" and hit.time_s is None:
            raise GivewayError(field, name, f"no rope: in {case.name}, the weight decides how long the run-up takes")
        if name == "collision.height" and "height" not in case.document["collision"]:
            raise GivewayError(field, name, f"a height in every collision: {case.name} has none, so it cannot tip")
        if field.startswith("tolerance") and name == "collision.direction" and hit.direction_deg is None:
            raise GivewayError(field, name, f"collision.angle: {case.name} states no direction")
        if name == "collision.angle" and (hit.direction_deg is not None or "collision.direction" in varied):
            raise GivewayError(field, name, f"no direction: {case.name} has one, and an angle is from straight ahead")
        if name == "collision.around" and "collision.direction" not in varied and hit.direction_deg is not None:
            raise GivewayError(field, name, f"no direction in {case.name}: it does not fit every side")


def _laws(varied: Sequence[Varied], stated: str) -> tuple[str, ...]:
    """Laws of the bumper that designs may have."""
    kind = columns().index["testbed.bumper.kind"]
    chosen = next((one for one in varied if kind in one.columns), None)
    if chosen is None:
        return (stated,)
    # Parts have any; and of one value, as the evidence of a design has it, the other numbers are those of all designs.
    several = chosen.parts is None and len(chosen.levels) > 1
    return tuple(chosen.text(level) for level in chosen.levels) if several else tuple(BUMPERS)


def _fits_bumper(field: str, quantity: Quantity, laws: tuple[str, ...]) -> None:
    """Refuse a number that no bumper of these laws has: all designs would be the same."""
    names = [columns().names[column].removeprefix("testbed.") for column in quantity.columns]
    if names and not any(acts(law, name) for law in laws for name in names):
        numbers = dict.fromkeys(f"testbed.bumper.{key}" for law in laws for key in NUMBERS[law])
        allowed = f"what decides something with the bumper {' or '.join(laws)}" + (
            f": {', '.join(numbers)}" if numbers else ", which has no numbers"
        )
        raise GivewayError(field, quantity.name, allowed)


def _with_nominal(one: Varied, cases: Sequence[Case]) -> Varied:
    """What a quantity has in the scenario while another one varies."""
    if one.nominal is not None:
        return one
    found = {None if one.parts is not None else _nominal(one.quantity, case) for case in cases}
    if len(found) != 1 or None in found:
        raise GivewayError(f"{one.field}.nominal", "nothing", "its value while another quantity varies")
    return dataclasses.replace(one, nominal=found.pop())


def _nominal(quantity: Quantity, case: Case) -> float | None:
    if quantity.name in INFLUENCES:
        return INFLUENCES[quantity.name].nominal
    if quantity.columns:
        name = columns().names[quantity.columns[0]]
        model, _, variable = name.partition(".")
        value = case.scenario.parameters(model).get(variable)
        return float(columns().start[quantity.columns[0]] if value is None else value)
    assert case.hit is not None
    return {
        "collision.speed": case.hit.speed_mps,
        "collision.time": case.hit.time_s,
        "collision.offset": case.hit.offset_m,
        "collision.direction": case.hit.direction_deg,
        "collision.angle": 0.0,
    }.get(quantity.name)


def _objective(section: Section, choices: Sequence[PartChoice]) -> Goal:
    sense = 1 if section.choice("goal", SENSES, SENSES[0]) == SENSES[0] else -1
    return _goal(section, choices, sense, section.number("weight", 1.0))


def _metric(field: str, name: str, choices: Sequence[PartChoice]) -> Metric:
    """Something that comes out of a run, or of the parts of a design."""
    return part_metric(field, name, choices) if name in SUMS else find_metric(field, name)


def _goal(section: Section, choices: Sequence[PartChoice], sense: int, weight: float = 1.0) -> Goal:
    metric = _metric(section.full("metric"), section.text("metric", section.values.get("metric", "")), choices)
    return Goal(
        metric,
        sense,
        section.choice("collisions", OVER_COLLISIONS, "worst"),
        section.choice("tolerances", OVER_TOLERANCES, "worst"),
        weight,
    )


def _constraint(section: Section, judged: Scenario, choices: Sequence[PartChoice]) -> Constraint:
    if ("minimum" in section.values) == ("maximum" in section.values):
        raise GivewayError(section.full("maximum"), "nothing or both", "one of minimum and maximum")
    goal = _goal(section, choices, 1 if "maximum" in section.values else -1)
    key = "maximum" if "maximum" in section.values else "minimum"
    value = section.values[key]
    written = written_unit(section, goal.metric.unit)
    if isinstance(value, str):
        if judged.judged is None:
            raise GivewayError(section.full(key), value, "a number, or a body_region in [scenario]")
        number = judged.judged.force_limits(judged.contact_area_m2)[LIMITS.index(value)]
    else:
        number = section.number(key) * (1.0 if written is None else written.scale)
    low, high = (-math.inf, number) if key == "maximum" else (number, math.inf)
    return Constraint(goal, low, high, written)


def _speeds(cases: Sequence[Case]) -> Iterator[Goal]:
    """How fast slider and robot were when they met: shown always, so that nobody judges another hit than was asked."""
    if cases[0].hit is not None:
        yield Goal(find_metric("report.metrics", "contact speed"), 1)
        if any(plan_speed(case.scenario) is not None for case in cases):
            yield Goal(find_metric("report.metrics", "robot speed at contact"), 1)


def _shown(report: Section, choices: Sequence[PartChoice]) -> tuple[Goal, ...]:
    names = report.values.get("metrics", [])
    found = [_metric(f"report.metrics[{i}]", name, choices) for i, name in enumerate(names)]
    return tuple(Goal(metric, usual_sense(metric)) for metric in found)
