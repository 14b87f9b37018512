"""The code generator: a wrong table is refused by file, variable and key; a right one means what it says."""

from __future__ import annotations

import contextlib
import io
import subprocess
import tomllib
from pathlib import Path

import fmpy
import pytest
from fmu_driver import ROOT, fmu_path
from giveway_codegen.__main__ import main
from giveway_codegen.units import base_units

LAG = ROOT / "tests" / "fmu" / "shell" / "lag"


def generate(folder: Path, table: str, robot: str | None = None, name: str = "lag") -> subprocess.CompletedProcess[str]:
    (folder / "variables.toml").write_text(table)
    (folder / "robot.toml").write_text(robot if robot is not None else (LAG / "robot.toml").read_text())
    arguments = ["--table", folder / "variables.toml", "--robot", folder / "robot.toml", "--out", folder / "out"]
    return command_line("sources", "--name", name, "--version", "1.0", *arguments)


def command_line(*words: str | Path) -> subprocess.CompletedProcess[str]:
    """In this process; the build starts it as one of its own."""
    with contextlib.redirect_stderr(io.StringIO()) as error:
        code = main([str(word) for word in words])
    return subprocess.CompletedProcess(words, code, "", error.getvalue())


def table(variable: str) -> str:
    return f"""schema_version = 1
[model]
name = "lag"
description = "test"
step_size_s = 0.01
[[variable]]
reference = 1
name = "first"
causality = "input"
type = "real"
unit = "N"
start = 0.0
description = "A good one"
[[variable]]
{variable}
"""


def variable(**changes: str | None) -> str:
    good = {
        "reference": "5",
        "name": '"group.second"',
        "causality": '"parameter"',
        "type": '"real"',
        "unit": '"m/s"',
        "start": "1.0",
        "minimum": "0.0",
        "maximum": "2.0",
        "description": '"Another"',
    }
    merged = {**good, **changes}
    return "\n".join(f"{key} = {value}" for key, value in merged.items() if value is not None)


def test_a_good_table_is_accepted(tmp_path: Path) -> None:
    result = generate(tmp_path, table(variable()))
    assert (result.returncode, result.stderr) == (0, "")
    header = (tmp_path / "out" / "lag_variables.hpp").read_text()
    assert "double group_second; // Another [m/s]" in header


WRONG = {
    "duplicate reference": (variable(reference="1"), "reference: 1 is taken by first"),
    "reference of time": (variable(reference="0"), "reference: 0, but must be a whole number from 1"),
    "reference as text": (variable(reference='"5"'), "reference: '5', but must be a whole number"),
    "element reference taken": (variable(reference="0x0", count="2"), "reference: 0, but"),
    "duplicate name": (variable(name='"first"'), "name: taken or too like first"),
    "reserved name": (variable(name='"time"'), "name: 'time', but"),
    "bad name": (variable(name='"Group.second"'), "name: 'Group.second', but must be words"),
    "unknown unit": (variable(unit='"furlong"'), "unit: 'furlong': unknown unit symbol 'furlong'"),
    "malformed unit": (variable(unit='"m/"'), "unit: 'm/': not a product of units"),
    "no unit": (variable(unit=None), "unit: missing"),
    "unit of an integer": (variable(type='"integer"', start="1"), "unit: a variable of type integer has no unit"),
    "start below": (variable(start="-0.5"), "start: -0.5 is outside 0.0 to 2.0"),
    "start above": (variable(start="2.0000001"), "start: 2.0000001 is outside 0.0 to 2.0"),
    "start not finite": (variable(start="nan"), "start: nan, but must be a finite number"),
    "start of the wrong type": (variable(start="true"), "start: True, but must be a finite number"),
    "no start": (variable(start=None), "start: missing"),
    "start of an output": (variable(causality='"output"'), "start: an output has no start value"),
    "start list too short": (variable(count="3", start="[1.0, 1.0]"), "start: a list of 2 values for 3 variables"),
    "missing robot key": (variable(start='{ robot = "lag.mass" }'), "robot.toml has no value lag.mass"),
    "robot unit": (
        variable(start='{ robot = "lag.time_constant" }'),
        "robot.toml is in 's', the variable in 'm/s'",
    ),
    "robot list too long": (
        variable(unit='"1"', minimum="-9.0", start='{ robot = "lag.weights" }'),
        "has 2 values for 1 variables",
    ),
    "robot reference malformed": (variable(start='{ file = "x" }'), "start: {'file': 'x'}, but must be a value or"),
    "preset outside": (variable(paper="3.0"), "paper: 3.0 is outside 0.0 to 2.0"),
    "preset of the wrong type": (variable(paper="true"), "paper: True, but must be a finite number"),
    "preset that is the start": (variable(paper="1.0"), "paper: 1.0 is the start value; leave it out"),
    "preset of an input": (
        variable(paper="2.0", causality='"input"'),
        "paper: only a parameter has another value in a preset",
    ),
    "range upside down": (variable(minimum="3.0"), "minimum: 3.0 is above the maximum 2.0"),
    "fraction as integer": (
        variable(type='"integer"', unit=None, start="1.5"),
        "start: 1.5, but must be a whole number of 32 bits",
    ),
    "integer too large": (
        variable(type='"integer"', unit=None, start="1", maximum="2147483648"),
        "maximum: 2147483648, but must be a whole number of 32 bits",
    ),
    "boolean with range": (
        variable(type='"boolean"', unit=None, start="true"),
        "minimum: a boolean has no range",
    ),
    "unknown key": (variable(colour='"red"'), "colour: unknown key"),
    "unknown causality": (variable(causality='"local"'), "causality: 'local', but must be one of"),
    "unknown type": (variable(type='"string"'), "type: 'string', but must be one of"),
    "no description": (variable(description=None), "description: missing"),
    "non-finite parameter": (variable(allow_nonfinite="true"), "allow_nonfinite: True, but"),
    "dependencies of an input": (variable(dependencies='["first"]'), "dependencies: only an output has them"),
    "dependencies as text": (
        variable(causality='"output"', start=None, dependencies='"first"'),
        "dependencies: 'first', but must be a list of inputs and states",
    ),
    "unknown dependency": (
        variable(causality='"output"', start=None, dependencies='["third"]'),
        "dependencies: there is no input or state 'third'",
    ),
    "nominal": (variable(nominal="0.0"), "nominal: 0.0 is not positive"),
    "display unit": (variable(display_unit='"mm"'), "display_unit: 'mm', but must be one of km/h, mm/s for 'm/s'"),
}


@pytest.mark.parametrize(("text", "message"), WRONG.values(), ids=WRONG.keys())
def test_a_wrong_variable_is_refused_by_file_variable_and_key(text: str, message: str, tmp_path: Path) -> None:
    result = generate(tmp_path, table(text))
    assert result.returncode == 1
    assert result.stderr.startswith(f"error: {tmp_path / 'variables.toml'}: variable ")
    assert message in result.stderr
    assert not (tmp_path / "out").exists()


def test_an_element_must_not_take_anothers_reference(tmp_path: Path) -> None:
    text = table(variable(reference="3", count="3")) + "[[variable]]\n" + variable(name='"third"')
    result = generate(tmp_path, text)
    assert "variable third: reference: 5 is taken by group.second[2]" in result.stderr


SHARED = table(variable()).replace("[model]", '[model]\nshares = "theirs.toml"') + "[[variable]]\n"


def shared(folder: Path, entry: str) -> subprocess.CompletedProcess[str]:
    """Generated from a table whose last entry is shared with one that has `group.third`."""
    theirs = table(variable(name='"group.third"', reference="7", description='"Theirs"'))
    (folder / "theirs.toml").write_text(theirs)
    return generate(folder, SHARED + entry)


def test_a_shared_entry_is_the_other_tables_but_for_its_reference_and_what_it_states(tmp_path: Path) -> None:
    assert shared(tmp_path, 'reference = 9\nshared = "group.third"\nmaximum = 1.5').returncode == 0
    own = table(variable()) + "[[variable]]\n"
    own += variable(name='"group.third"', reference="9", description='"Theirs"', maximum="1.5")
    alone = tmp_path / "alone"
    alone.mkdir()
    assert generate(alone, own).returncode == 0
    for name in ("lag_variables.cpp", "fmi3/modelDescription.xml"):  # the token included
        assert (tmp_path / "out" / name).read_text() == (alone / "out" / name).read_text()
    written_out = tomllib.loads((tmp_path / "out" / "lag.variables.toml").read_text())
    assert written_out == tomllib.loads(own)


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ('reference = 9\nshared = "group.fourth"', "group.fourth: shared: 'group.fourth', but must be a variable"),
        ('shared = "group.third"', "group.third: reference: None, but must be a whole number"),
        ('reference = 9\nshared = "group.third"\nunit = "N"', "group.third: unit: not in an entry with `shared`"),
        ('reference = 9\nshared = "group.third"\nmaximum = 0.5', "group.third: start: 1.0 is outside 0.0 to 0.5"),
    ],
)
def test_a_wrong_shared_entry_is_named(tmp_path: Path, entry: str, message: str) -> None:
    result = shared(tmp_path, entry)
    assert result.returncode == 1
    assert f"variables.toml: variable {message}" in result.stderr


def plant_header(folder: Path) -> str:
    options = ["--table", folder / "variables.toml", "--robot", folder / "robot.toml", "--out", folder / "plant.hpp"]
    assert command_line("plant-parameters", *options).returncode == 0
    return (folder / "plant.hpp").read_text()


def test_a_plant_parameter_has_its_variables_name_and_the_type_that_the_table_states(tmp_path: Path) -> None:
    text = table(variable(plant='"divisor"', description='"Speed"')) + "[[variable]]\n"
    text += variable(name='"group.sides"', reference="20", count="3", plant='"wheels"') + "\n[[variable]]\n"
    choice = {"type": '"integer"', "unit": None, "start": "1", "minimum": "0", "maximum": "2"}
    choice["choices"] = '["none", "spring", "foam"]'
    text += variable(name='"group.kind"', reference="30", plant='"BumperKind"', **choice)
    assert generate(tmp_path, text).returncode == 0
    header = plant_header(tmp_path)
    assert "math::Divisor<T> group_second; // Speed [m/s]" in header
    assert "std::array<T, Wheels> group_sides;" in header
    assert "inline constexpr int table_wheels = 3;" in header
    assert "BumperKind group_kind;" in header
    assert "enum class BumperKind : std::uint8_t { none = 0, spring = 1, foam = 2 };" in header
    assert header.count("    visit(") == 3
    reader = (tmp_path / "out" / "lag_plant_parameters.hpp").read_text()
    assert "p.group_second = v.group_second;" in reader
    assert "std::copy_n(v.group_sides, p.group_sides.size(), p.group_sides.begin());" in reader
    assert "p.group_kind = static_cast<plant::BumperKind>(v.group_kind);" in reader


@pytest.mark.parametrize("plant", ['"whole"', '"BumperKind"', "true"])
def test_a_plant_parameters_type_has_to_fit_the_variables(tmp_path: Path, plant: str) -> None:
    result = generate(tmp_path, table(variable(plant=plant)))
    assert "variable group.second: plant: " in result.stderr
    assert "must be number or divisor or wheels, and of a parameter" in result.stderr


def test_another_value_in_a_preset_changes_nothing_for_importers(tmp_path: Path) -> None:
    descriptions = []
    for changes in ({}, {"paper": "0.5"}):
        assert generate(tmp_path, table(variable(**changes))).returncode == 0
        descriptions.append((tmp_path / "out" / "fmi3" / "modelDescription.xml").read_text())
    assert descriptions[0] == descriptions[1]


def test_choices_are_a_word_for_each_value(tmp_path: Path) -> None:
    entry = {"type": '"integer"', "unit": None, "start": "1", "minimum": "0", "maximum": "2", "plant": '"BumperKind"'}
    for choices in (None, '["none", "spring"]', '["none", "spring", 3]', '"none"'):
        result = generate(tmp_path, table(variable(choices=choices, **entry)))
        assert "variable group.second: choices: " in result.stderr
        assert "must be a word for each value from 0 to the maximum 2" in result.stderr
    result = generate(tmp_path, table(variable(choices='["one"]', plant='"number"')))
    assert "variable group.second: choices: only an enumeration of the plant has them" in result.stderr
    result = generate(tmp_path, table(variable(choices='["one"]')))
    assert "variable group.second: choices: only a parameter of type integer has them" in result.stderr
    entry["plant"] = None
    assert generate(tmp_path, table(variable(choices='["none", "spring", "foam"]', **entry))).returncode == 0
    result = generate(tmp_path, table(variable(choices='["none", "spring"]', **entry)))
    assert "must be a word for each value from 0 to the maximum 2" in result.stderr


def test_a_robot_file_states_a_choice_in_words(tmp_path: Path) -> None:
    entry = {"type": '"integer"', "unit": None, "minimum": "0", "maximum": "1", "choices": '["one", "the_other"]'}
    entry["start"] = '{ robot = "base.kind" }'
    for word, start in (("one", 0), ("the other", 1), ("neither", None)):
        robot = f'schema_version = 1\n[base.kind]\nvalue = "{word}"\n'
        result = generate(tmp_path, table(variable(**entry)), robot)
        if start is None:
            assert "base.kind of" in result.stderr
            assert "is 'neither', but may be one or the other" in result.stderr
        else:
            assert result.returncode == 0, result.stderr
            description = (tmp_path / "out" / "fmi3" / "modelDescription.xml").read_text()
            assert f'start="{start}"' in description


def of_c_core(**changes: str | None) -> str:
    """A table whose input and second variable are members of the structs of a module."""
    text = table(variable(**changes)).replace("step_size_s = 0.01", 'step_size_s = 0.01\nc_core = "gw_lag"')
    return text.replace("start = 0.0", 'start = 0.0\nc_core = "push.force_n"', 1)


def test_variables_of_c_core_are_copied_to_and_from_the_members_that_the_table_states(tmp_path: Path) -> None:
    text = of_c_core(count="3", c_core='"group.speed_mps[i]"') + "[[variable]]\n"
    output = {"causality": '"output"', "start": None, "minimum": None, "maximum": None}
    text += variable(name='"tripped"', reference="30", c_core='"detection.tripped"', **output)
    text += "\n[[variable]]\n" + variable(name='"status"', reference="31", c_core='"()"', **output)
    assert generate(tmp_path, text).stderr == ""
    header = (tmp_path / "out" / "lag_members.hpp").read_text()
    assert '#include "giveway/gw_lag.h"' in header
    configuration, inputs, outputs = header.split("\ninline ")[1:]
    assert configuration.startswith("gw_lag_config_t")
    assert "i < 3; ++i) {\n        assign(c.group.speed_mps[i], v.group_second[i]);" in configuration
    assert "    assign(c.push.force_n, v.first);" in inputs
    assert "    assign(v.tripped, c.detection.tripped);" in outputs
    assert header.count("assign(") == 4  # the function itself, and no status


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({}, "c_core: missing"),
        ({"c_core": '"()"'}, "c_core: '()', but must be a member, with [i] if the variable has a count"),
        ({"c_core": '"speed[i]"'}, "c_core: 'speed[i]', but must be a member"),
        ({"c_core": '"speed"', "count": "3"}, "c_core: 'speed', but must be a member"),
        ({"c_core": '"speed; x"'}, "c_core: 'speed; x', but must be a member"),
    ],
)
def test_a_wrong_member_of_c_core_is_named(tmp_path: Path, changes: dict[str, str], message: str) -> None:
    assert f"variable group.second: {message}" in generate(tmp_path, of_c_core(**changes)).stderr


def test_a_member_of_c_core_needs_a_module(tmp_path: Path) -> None:
    result = generate(tmp_path, table(variable(c_core='"speed"')))
    assert "variable group.second: c_core: only if [model] names a module with `c_core`" in result.stderr
    result = generate(tmp_path, of_c_core(c_core='"speed"').replace('"gw_lag"', '"Lag"'))
    assert "model: c_core: 'Lag', but must be the name of a header without .h" in result.stderr


def test_wrong_files_and_models_are_named(tmp_path: Path) -> None:
    good = table(variable())
    cases = [
        (good.replace("schema_version = 1", "schema_version = 2"), "schema_version: 2, but this version reads 1"),
        (good.replace("0.01", "0.0"), "model: step_size_s: 0.0, but must be a positive number"),
        (good.replace('name = "lag"', 'name = "Lag 1"'), "model: name: 'Lag 1', but"),
        (good.replace('description = "test"', ""), "model: description: missing"),
        (good.replace("[model]", "[model]\nauthor = 1"), "model: author: unknown key"),
        (good.replace('name = "lag"', 'name = "lead"'), "model: name: 'lead', but the build calls it 'lag'"),
        (good + "]", "not valid TOML"),
    ]
    for text, message in cases:
        result = generate(tmp_path, text)
        assert result.returncode == 1
        assert f"{tmp_path / 'variables.toml'}: {message}" in result.stderr
    result = generate(tmp_path, good, robot="")
    assert f"{tmp_path / 'robot.toml'}: schema_version: None, but this version reads 1" in result.stderr


def test_the_token_follows_every_value(tmp_path: Path) -> None:
    tokens = set()
    for text in (variable(), variable(start="1.5"), variable(maximum="3.0"), variable(reference="6")):
        assert generate(tmp_path, table(text)).returncode == 0
        description = (tmp_path / "out" / "fmi3" / "modelDescription.xml").read_text()
        tokens.add(description.split('instantiationToken="')[1].split('"')[0])
    assert len(tokens) == 4


STATE = """
[[state]]
reference = 20
name = "state.angle"
unit = "rad"
nominal = 0.5
dependencies = ["first"]
description = "An angle"
[[indicator]]
reference = 4000
name = "indicator.stop"
count = 2
description = "Travel to the stops"
"""


def test_states_make_a_table_one_for_model_exchange(tmp_path: Path) -> None:
    result = generate(tmp_path, table(variable(causality='"output"', start=None)) + STATE)
    assert (result.returncode, result.stderr) == (0, "")
    for version in (2, 3):
        description = fmpy.read_model_description(str(_as_folder(tmp_path, version)))
        assert description.modelExchange is not None
        assert description.coSimulation is not None
        assert (description.numberOfContinuousStates, description.numberOfEventIndicators) == (2, 2)
        derivative, counter = description.derivatives
        assert (counter.variable.name, counter.dependencies) == ("der(state.discontinuities)", [])
        assert derivative.variable.name == "der(state.angle)"
        assert derivative.variable.valueReference == 1020
        assert derivative.variable.declaredType.unit == "rad/s"
        assert derivative.variable.derivative.name == "state.angle"
        assert [d.name for d in derivative.dependencies] == ["first"]
        # An output that declares nothing follows the states that the model integrates.
        assert [[d.name for d in unknown.dependencies] for unknown in description.outputs] == [["state.angle"]]
        initial = {u.variable.name: [d.name for d in u.dependencies] for u in description.initialUnknowns}
        added = {"state.discontinuities": [], "der(state.discontinuities)": []}
        assert initial == {"group.second": [], "state.angle": [], "der(state.angle)": ["first"], **added}
    header = (tmp_path / "out" / "lag_variables.hpp").read_text()
    assert "double states[2];" in header
    assert "double indicators[2];" in header


def _as_folder(tmp_path: Path, version: int) -> Path:
    folder = tmp_path / f"fmi{version}"
    folder.mkdir()
    text = (tmp_path / "out" / f"fmi{version}" / "modelDescription.xml").read_text()
    (folder / "modelDescription.xml").write_text(text)
    return folder


WRONG_LOCALS = {
    "state without dependencies": (
        STATE.replace('dependencies = ["first"]', ""),
        "dependencies: None, but must be a list",
    ),
    "state without unit": (STATE.replace('unit = "rad"', ""), "unit: missing"),
    "state without nominal": (STATE.replace("nominal = 0.5", ""), "nominal: None, but must be a finite number"),
    "reference of a state beyond the last": (
        STATE.replace("reference = 20\n", "reference = 3100\n"),
        "reference: states must have references below 2999",
    ),
    "nominal zero": (STATE.replace("nominal = 0.5", "nominal = 0"), "nominal: 0.0 is not positive"),
    "unknown dependency": (STATE.replace('["first"]', '["last"]'), "dependencies: there is no input or state 'last'"),
    "reference of an indicator taken": (
        STATE.replace("= 4000", "= 1019"),
        "reference: 1020 is taken by der(state.angle)",
    ),
    "start of a state": (STATE.replace("nominal", "start = 1.0\nnominal"), "start: unknown key"),
    "unit of an indicator": (STATE + 'unit = "m"', "unit: unknown key"),
    "indicator without description": (STATE.replace('"Travel to the stops"', '""'), "description: missing"),
}


@pytest.mark.parametrize(("text", "message"), WRONG_LOCALS.values(), ids=WRONG_LOCALS.keys())
def test_wrong_states_and_indicators_are_refused(text: str, message: str, tmp_path: Path) -> None:
    result = generate(tmp_path, table(variable()) + text)
    assert result.returncode == 1
    assert message in result.stderr


@pytest.mark.parametrize("version", [2, 3])
def test_descriptions_say_what_the_table_says(version: int) -> None:
    description = fmpy.read_model_description(str(fmu_path("lag", version)))
    variables = {v.name: v for v in description.modelVariables}
    u = variables["input.u"]
    assert (float(u.min), float(u.max), float(u.nominal), float(u.start)) == (-5.0, 5.0, 2.0, 1.0)
    assert (u.unit, u.displayUnit, u.declaredType.unit) == (None, None, "N.m")  # once
    assert (u.causality, u.variability) == ("input", "continuous")
    assert variables["input.hold"].variability == "discrete"
    assert variables["lag.time_constant"].variability == "fixed"
    assert float(variables["lag.time_constant"].start) == 0.25
    assert variables["output.y"].start is None
    units = {unit.name: unit.baseUnit for unit in description.unitDefinitions}
    torque = units["N.m"]
    assert (torque.kg, torque.m, torque.s, torque.rad, torque.factor) == (1, 2, -2, 0, 1.0)
    # Named "none", not left out: an importer would take that for all inputs.
    assert [unknown.dependencies for unknown in description.outputs] == [[]] * 5
    parameters = {v.name for v in description.modelVariables if v.causality == "parameter"}
    assert all({d.name for d in unknown.dependencies} == parameters for unknown in description.initialUnknowns)


@pytest.mark.parametrize(
    ("unit", "exponents"),
    [
        ("1", {}),
        ("N", {"kg": 1, "m": 1, "s": -2}),
        ("N.m.s/rad", {"kg": 1, "m": 2, "s": -1, "rad": -1}),
        ("kg.m2", {"kg": 1, "m": 2}),
        ("m/s2", {"m": 1, "s": -2}),
        ("s/m", {"s": 1, "m": -1}),
        ("m.s-1", {"m": 1, "s": -1}),
        ("J/m2/s", {"kg": 1, "s": -3}),
        ("Hz.s", {}),
    ],
)
def test_units(unit: str, exponents: dict[str, int]) -> None:
    assert base_units(unit) == exponents
