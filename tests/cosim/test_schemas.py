"""`giveway schema`: what the schemas refuse, the readers refuse, and the other way round."""

from __future__ import annotations

import copy
import json
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import tomlkit
from cosim_helpers import Cli, folder_content
from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.base.shapes import Either, List, Number, Pair, Rows, Shape, Table, Variants, Whole
from giveway.robot.robot_file import read_robot, robot_shape
from giveway.scenario.scenario_file import scenario_of
from giveway.scenario.scenario_shape import scenario_shape
from giveway.schemas.documents import KINDS, document
from giveway.schemas.variable_table import SHARED_KEYS, variable_table_shape
from giveway.starters import command as starters
from giveway.study import study_file
from giveway_codegen import table as codegen
from giveway_codegen.errors import TableError
from giveway_codegen.table import read_table
from jsonschema import Draft202012Validator

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
FILES = {
    "scenario": [*sorted(EXAMPLES.glob("*.toml")), Path(starters.__file__).parent / "scenario.toml"],
    "study": [*sorted((EXAMPLES / "studies").glob("*.toml")), Path(starters.__file__).parent / "study.toml"],
    "robot": sorted((ROOT / "robots").glob("*.toml")),
    "variables": sorted((ROOT / "fmu" / "models").glob("*/variables.toml")),
}
NOTHING_IS = {"wrong": 1}, [[1]]  # no value may be one of these
UNKNOWN = "unheard_of"

Path_ = tuple[str | int, ...]


@pytest.fixture(scope="module")
def schemas() -> dict[str, Draft202012Validator]:
    found = {kind: document(kind) for kind in KINDS}
    for one in found.values():
        Draft202012Validator.check_schema(one)
    return {kind: Draft202012Validator(json.loads(json.dumps(one))) for kind, one in found.items()}


def toml(path: Path) -> dict[str, Any]:
    return tomllib.loads(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("kind", FILES)
def test_every_file_of_ours_fits(kind: str, schemas: dict[str, Draft202012Validator]) -> None:
    assert len(FILES[kind]) > 3
    for path in FILES[kind]:
        assert [error.message for error in schemas[kind].iter_errors(toml(path))] == [], path


def test_summaries_fit(schemas: dict[str, Draft202012Validator], full_runs: Any) -> None:
    from giveway.simulation.summary import summary

    found = json.loads(json.dumps(summary(full_runs)))
    schemas["summary"].validate(found)
    assert len(found["rows"]) > 30
    for broken in ({**found, UNKNOWN: 1}, {**found, "rows": [{**found["rows"][0], "value": "1"}]}, {"rows": []}):
        assert not schemas["summary"].is_valid(broken)


def places(shape: Shape, value: Any, at: Path_ = ()) -> Iterator[tuple[Path_, Shape]]:
    """Every value of a document with the shape that it should have."""
    yield at, shape
    if isinstance(shape, Either) and isinstance(value, dict):
        yield from places(next(one for one in shape.shapes if isinstance(one, Table | Variants)), value, at)
    if isinstance(shape, Variants):
        shape = shape.table(value[shape.key])
    if isinstance(shape, Table):
        for key, one in value.items():
            yield from places(shape.keys[key], one, (*at, key))
    if isinstance(shape, Rows):
        for index, one in enumerate(value):
            yield from places(shape.row, one, (*at, index))


def changed(whole: dict[str, Any], at: Path_, change: Callable[[Any], Any]) -> dict[str, Any]:
    top = {"": copy.deepcopy(whole)}
    parent: Any = top
    for step in ("", *at)[:-1]:
        parent = parent[step]
    last = at[-1] if at else ""
    parent[last] = change(parent[last])
    return top[""]


def mutations(whole: dict[str, Any], shape: Table) -> Iterator[tuple[str, dict[str, Any]]]:
    """Unknown keys, wrong types, numbers out of range: all of them wrong."""
    for at, one in places(shape, whole):
        name = ".".join(map(str, at))
        if isinstance(one, Table | Variants):
            yield f"{name}: unknown key", changed(whole, at, lambda value: {**value, UNKNOWN: 1})
        if at:
            for wrong in NOTHING_IS:
                yield f"{name}: {wrong}", changed(whole, at, lambda _value, wrong=wrong: wrong)
        for low, high in ends(one):
            for number in (low, high):
                if abs(number) < 1e300:
                    beyond = number + (1 if number == high else -1) * max(1, abs(number))
                    yield f"{name}: {beyond}", changed(whole, at, lambda _value, beyond=beyond: beyond)


def ends(shape: Shape) -> Iterator[tuple[float, float]]:
    if isinstance(shape, Number | Whole):
        yield shape.low, shape.high
    if isinstance(shape, Either):
        yield from (pair for one in shape.shapes for pair in ends(one))


def refused(read: Callable[[dict[str, Any]], object], whole: dict[str, Any]) -> bool:
    try:
        read(whole)
    except GivewayError:
        return True
    return False


SCENARIO = """
schema_version = 1
name = "all"
duration = 1.0
robot = "trikey"
preset = "paper"
seed = 3
judge_as = "lower leg"
contact_area = { value = 30, unit = "cm2" }
[bumper]
law = "gas"
travel = { value = 45, unit = "mm" }
force = 20
force_compressed = 60
stroke = 0.04
[plan]
kind = "straight"
speed = 0.2
direction = 30
[collision]
edge = 0
offset = 0.01
speed = 0.5
mass = 9.0
time = 0.4
rope = false
height = 0.3
[[push]]
force = 5
direction = 20
point = [-0.1, 0.0]
start = 0.8
duration = 0.1
ramp = 0.02
[testbed]
slider.friction = 2.0
[controller.admittance]
tip_margin = 0.1
"""
ARCS = 'kind = "arcs"\nwheels = [[1, 0, 0]]\nswing = 50\nfrequency = 0.2\nswings = 2\nrest = 0.1\ny = 0.1'
PLANS = ('kind = "rest"\nx = 0.1\nheading = 20', 'kind = "circle"\ndiameter = 2.0\nspeed = 0.1\ncentre = [0, 0]', ARCS)


def scenario_text() -> str:
    from giveway.robot.variables import table

    if "admittance.tip_margin" in table("controller"):
        return SCENARIO
    return SCENARIO.replace("[controller.admittance]\ntip_margin = 0.1\n", "")


@pytest.mark.parametrize("plan", range(4))
def test_wrong_scenarios_are_refused_by_both(plan: int, schemas: dict[str, Draft202012Validator]) -> None:
    whole = tomllib.loads(scenario_text())
    if plan:
        whole["plan"] = tomllib.loads(PLANS[plan - 1])

    def read(found: dict[str, Any]) -> object:
        return scenario_of(found, EXAMPLES / "x.toml")

    assert schemas["scenario"].is_valid(whole)
    read(whole)
    tried = [(name, one) for name, one in mutations(whole, scenario_shape()) if not plan or name.startswith("plan")]
    assert len(tried) > (10 if plan else 80)
    for name, one in tried:
        assert not schemas["scenario"].is_valid(one), name
        assert refused(read, one), name


STUDY = """
schema_version = 1
name = "all"
seed = 2
method = "fixed-step"
plant_step = 0.0002
part_runs = 8
[scenario]
duration = 1.0
bumper = "magnetic"
body_region = "lower leg"
[[collision]]
name = "front"
speed = 0.5
edge = 0
[designs]
kind = "morris"
trajectories = 4
grid = 4
[[vary]]
quantity = "testbed.bumper.latch_force"
low = 1
high = 40
unit = "N"
[[parts]]
name = "spring"
catalogue = "../catalogues/springs_made_up.csv"
count = 2
sets = { "testbed.bumper.spring_rate" = "rate * count" }
[tolerances]
kind = "sobol"
samples = 4
noise_seeds = true
robot = "file"
[[tolerance]]
quantity = "temperature"
absolute = 20
distribution = "normal"
[sure]
probability = false
method = "plain"
runs = 2000
designs = 1
indices = 0
[drivetrain]
load = "wheel"
servo_delay = 2
[[objective]]
metric = "detection time"
goal = "minimise"
weight = 2.0
collisions = "mean"
tolerances = "nominal"
[[constraint]]
metric = "peak force of the run"
maximum = "transient limit"
[optimise]
designs = 100
population = 8
patience = 4
growth = 0.01
reference = [100.0]
[report]
metrics = ["bumper compression"]
chosen = 1
"""


def test_wrong_studies_are_refused_by_both(schemas: dict[str, Draft202012Validator]) -> None:
    whole = tomllib.loads(STUDY)

    def read(found: dict[str, Any]) -> object:
        return study_file.check(found, EXAMPLES / "studies")

    assert schemas["study"].is_valid(whole)
    read(whole)
    tried = list(mutations(whole, study_file.study_shape()))
    assert len(tried) > 150
    for name, one in tried:
        assert not schemas["study"].is_valid(one), name
        assert refused(read, one), name


def test_wrong_robots_are_refused_by_both(schemas: dict[str, Draft202012Validator], tmp_path: Path) -> None:
    whole = toml(native.robot())
    whole["controller"] = {"channels": {"fast_rest": {"value": 2.0, "unit": "N"}}}
    path = tmp_path / "mine.toml"

    def read(found: dict[str, Any]) -> object:
        path.write_text(tomlkit.dumps(found), encoding="utf-8")
        return read_robot(path)

    read(whole)
    seen = {"schema_version", "robot", "base", "outline", "drivetrain", "controller"}
    few = {key: value for key, value in whole.items() if key in seen}
    few["base"] = {key: few["base"][key] for key in list(few["base"])[:2]}
    few["drivetrain"] = {key: few["drivetrain"][key] for key in list(few["drivetrain"])[:1]}
    tried = list(mutations(few, robot_shape()))
    assert len(tried) > 40
    for name, one in tried:
        assert not schemas["robot"].is_valid(one), name
        assert refused(read, one), name


VARIABLES = """
schema_version = 1
[model]
name = "lamp"
description = "A lamp"
step_size_s = 0.001
[[variable]]
reference = 1
name = "lamp.power"
count = 2
causality = "input"
type = "real"
unit = "W"
start = 1.0
minimum = 0.0
maximum = 9.0
nominal = 2.0
allow_nonfinite = true
description = "Power"
[[variable]]
reference = 3
name = "lamp.kind"
causality = "parameter"
type = "integer"
start = 0
minimum = 0
maximum = 1
plant = "LampKind"
choices = ["red", "green"]
paper = 1
description = "Kind"
[[variable]]
reference = 4
name = "lamp.on"
causality = "output"
type = "boolean"
dependencies = ["lamp.power"]
description = "On"
[[state]]
reference = 10
name = "heat"
unit = "J"
nominal = 1.0
dependencies = ["lamp.power"]
description = "Heat"
[[indicator]]
reference = 20
name = "melts"
description = "Melts"
"""
CONTRADICTIONS = [  # which entry, keys that are added, keys that are taken away
    (0, {"dependencies": ["heat"]}, ()), (0, {}, ("unit",)), (0, {}, ("start",)), (0, {"paper": 2.0}, ()),
    (0, {"choices": ["a"]}, ()), (1, {"unit": "m"}, ()), (1, {"nominal": 1.0}, ()), (1, {"allow_nonfinite": True}, ()),
    (2, {"start": True}, ()), (2, {"minimum": 0}, ()), (2, {}, ("description",)), (2, {}, ("causality",)),
    (2, {"shared": "lamp.kind"}, ()), (0, {"name": "Lamp"}, ()), (1, {"choices": ["Red", "green"]}, ()),
]  # fmt: skip


def codegen_refuses(found: dict[str, Any], folder: Path) -> bool:
    path = folder / "variables.toml"
    path.write_text(tomlkit.dumps(found), encoding="utf-8")
    try:
        read_table(path, ROOT / "robots" / "trikey.toml")
    except TableError:
        return True
    return False


def test_wrong_variable_tables_are_refused_by_both(schemas: dict[str, Draft202012Validator], tmp_path: Path) -> None:
    whole = tomllib.loads(VARIABLES)
    schemas["variables"].validate(whole)
    assert not codegen_refuses(whole, tmp_path)
    # What is not even a table, or a table with another name, the generator does not look at.
    tried = [
        (name, one)
        for name, one in mutations(whole, variable_table_shape())
        if name.count(".") > 1 or name.startswith(("schema_version", "model.")) or name.endswith("unknown key")
        if not name.startswith(":")
    ]
    for entry, added, taken in CONTRADICTIONS:
        row = {key: value for key, value in (whole["variable"][entry] | added).items() if key not in taken}
        tried.append((f"{entry}: {added} {taken}", changed(whole, ("variable", entry), lambda _, row=row: row)))
    assert len(tried) > 90
    for name, one in tried:
        assert not schemas["variables"].is_valid(one), name
        assert codegen_refuses(one, tmp_path), name


def test_variable_tables_have_the_keys_of_the_code_generator() -> None:
    shape = variable_table_shape()
    rows = {name: one.row.keys for name, one in shape.keys.items() if isinstance(one, Rows)}
    model = shape.keys["model"]
    assert isinstance(model, Table)
    assert set(model.keys) == codegen._MODEL_KEYS
    assert set(rows["variable"]) == codegen._VARIABLE_KEYS | {"shared"}
    assert set(rows["state"]) == codegen._STATE_KEYS
    assert set(rows["indicator"]) == codegen._INDICATOR_KEYS
    assert set(SHARED_KEYS) == codegen._SHARED_KEYS


@pytest.mark.parametrize(("kind", "key"), [("scenario", "duraton"), ("study", "desgins"), ("robot", "whel")])
def test_unknown_keys_suggest_the_nearest(kind: str, key: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(f"schema_version = 1\n{key} = 1\n", encoding="utf-8")
    import giveway

    read: Callable[[Path], object] = {
        "scenario": giveway.read_scenario,
        "study": study_file.read,
        "robot": read_robot,
    }[kind]
    meant = {"duraton": "duration", "desgins": "designs", "whel": "wheel"}[key]
    with pytest.raises(GivewayError, match=rf"mine\.toml:2: {key}.*did you mean {meant}"):
        read(path)


def test_lists_and_points_have_lengths() -> None:
    assert List("", Number(), "x", 1).schema()["minItems"] == 1
    assert Pair("", 2.0).schema()["items"] == {"type": "number", "minimum": -2.0, "maximum": 2.0}


def test_the_command_writes_all(cli: Cli, tmp_path: Path) -> None:
    assert cli("schema", "--out", "schemas").returncode == 0
    assert folder_content(tmp_path / "schemas") == sorted(f"{kind}.schema.json" for kind in KINDS)
    text = (tmp_path / "schemas/robot.schema.json").read_text(encoding="utf-8")
    assert json.loads(text) == json.loads(cli("schema", "robot").stdout)
    assert "did you mean robot?" in cli("schema", "robto").stderr
    assert cli("schema").returncode == 2


@pytest.mark.parametrize("kind", ["scenario", "study", "robot"])
def test_files_to_start_from_name_their_schema(kind: str) -> None:
    for path in FILES[kind]:
        assert path.read_text(encoding="utf-8").startswith(f"#:schema {kind}.schema.json\n"), path


def test_new_robots_name_their_schema(cli: Cli, tmp_path: Path) -> None:
    sizes = ("--mass", "20 kg", "--wheel-radius", "4 in", "--wheel-distance", "0.2", "--outline", "circle 0.5")
    assert cli("robot", "new", "mine.toml", *sizes, "--height", "0.4").returncode == 0
    assert (tmp_path / "mine.toml").read_text(encoding="utf-8").startswith("#:schema robot.schema.json\n")
