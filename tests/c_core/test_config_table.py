"""One table of configuration fields: what headers, checks and the controller's FMU say of them is what it says; and
both presets of the library are those of the FMU's table.

That each member is checked as the row's kind and field say, at both ends of the range, unit/config_test.c tests.
"""

from __future__ import annotations

import os
import re
import tomllib
from pathlib import Path

import pytest
from giveway.robot.variables import Variable, table

from verify.context import Context
from verify.targets import HOST, core_sources

ROOT = Path(__file__).parents[2]
CORE = ROOT / "c_core"
HEADERS = CORE / "include" / "giveway"
# Kind, field, name, member, minimum, maximum.
ROW = re.compile(r'ROW\([A-Z_]+, (GW_FIELD_\w+), "([^"]+)", OF ([\w.\[\]]+), ([^,]+), (.+?)\)$', re.MULTILINE)
TABLE = re.compile(r"^#define (GW_\w+_FIELDS)\(ROW, OF\)\n((?: .*\n)+)", re.MULTILINE)
CHECK = re.compile(
    r"gw_config_check_(?:real|count|element)\(\s*&?error, (GW_FIELD_\w+),(?: \w+,)?\s*(?:\(gw_real_t\))?config->(\w+)"
)
# A comment and the members below it.
DESCRIBED = re.compile(
    r"/\*((?:[^*]|\*(?!/))*)\*/\n((?:    (?:gw_real_t|uint32_t|gw_force_floors_t) \w+(?:\[\w+\])?;\n)+)"
)
RANGE = re.compile(r"\[(-?[\d.]+), (-?[\d.]+)\]")
CHOICE = re.compile(r"GW_\w+ \((\d)\)")  # a value that has a name
# Parameters of the FMU that are not numbers of the configuration.
OTHER_PARAMETERS = {"controller.drives_enabled"}


def text(name: str) -> str:
    return (HEADERS / name).read_text(encoding="utf-8")


def number(expression: str) -> float:
    """Of the table's cells: numbers, and the constants of gw_types.h."""
    known = dict(re.findall(r"#define (GW_\w+) (\d+)U$", text("gw_types.h"), re.MULTILINE))
    if expression == "GW_WHEELS - (gw_real_t)1":
        return float(known["GW_WHEEL_COUNT"]) - 1.0
    return float(known.get(expression, expression))


def lines() -> str:
    """gw_config.h with one line per row."""
    return re.sub(r",\s*\\\n\s+", ", ", text("gw_config.h")).replace(" \\\n", "\n")


def rows() -> dict[str, tuple[str, float, float]]:
    """Field to name, minimum, maximum."""
    return {field: (name, number(low), number(high)) for field, name, _, low, high in ROW.findall(lines())}


def members() -> dict[str, str]:
    """Name of a field of the controller to the member of gw_controller_config_t."""
    tables = dict(TABLE.findall(lines()))
    places = re.findall(r"(GW_\w+)\(ROW, OF ?([\w.]*)\)", tables["GW_CONTROLLER_CONFIG_FIELDS"])
    return {name: place + member for table, place in places for _, name, member, *_ in ROW.findall(tables[table])}


def described() -> dict[tuple[str, str], tuple[float, float]]:
    """(Module, member) to the range in the comment above it; a comment with one range applies to all members below."""
    ranges: dict[tuple[str, str], tuple[float, float]] = {}
    for header in sorted(HEADERS.glob("gw_*.h")):
        for structure in re.findall(r"typedef struct \{\n(.*?)\} gw_\w+_config_t;", header.read_text(), re.DOTALL):
            for comment, members in DESCRIBED.findall(structure):
                names = re.findall(r"(\w+)(?:\[\w+\])?;", members)
                found = [(float(low), float(high)) for low, high in RANGE.findall(comment)]
                if choices := [float(value) for value in CHOICE.findall(comment)]:
                    found = [(min(choices), max(choices))]
                if len(found) == 1:
                    found *= len(names)
                assert not found or len(found) == len(names), f"{header.name}: {comment}"
                module = header.stem.removesuffix("_config")  # whose configuration has a header of its own
                ranges |= {(module, name): bounds for name, bounds in zip(names, found, strict=False)}
    return ranges


def checked() -> dict[str, tuple[str, str]]:
    """Field to the module that checks it and its member."""
    return {
        field: (source.stem, member)
        for source in sorted((CORE / "src").glob("*.c"))
        for field, member in CHECK.findall(source.read_text(encoding="utf-8"))
        if source.stem != "gw_rate_filter"  # uses some of the estimator's fields again
    }


def test_every_row_is_read() -> None:
    assert len(rows()) == text("gw_config.h").count("    ROW(") - 1  # that of no field


# The convexity of the outline has no number; coordinates are checked member by member of a vertex.
@pytest.mark.parametrize("field", sorted(set(rows()) - {"GW_FIELD_OUTLINE_CONVEX"}))
def test_every_field_is_checked_and_described_as_in_the_table(field: str) -> None:
    name, low, high = rows()[field]
    assert field in checked(), f"{name} is checked nowhere"
    module, member = checked()[field]
    if (module, member) in {("gw_kinematics", "wheel_slot"), ("gw_contact", "vertex_m")}:
        return  # stated in words: "each of 0, 1, 2 once", "each in [-10, 10]" for both coordinates
    bounds = described().get((module, member))
    assert bounds is not None, f"{module}.h gives no range for {member}"
    assert bounds == (low, high)


def test_parameters_of_the_fmu_are_the_fields() -> None:
    table = tomllib.loads((ROOT / "fmu/models/controller/variables.toml").read_text(encoding="utf-8"))
    parameters = {entry["name"]: entry for entry in table["variable"] if entry["causality"] == "parameter"}
    fields = {name: bounds for name, *bounds in rows().values()}
    own = {name for name in fields if not name.startswith(("servo.", "outline ("))}  # the servo is in the testbed
    assert set(parameters) - own == OTHER_PARAMETERS
    assert own - set(parameters) == set()
    for name in own:
        assert [parameters[name]["minimum"], parameters[name]["maximum"]] == fields[name], name
        assert parameters[name]["c_core"] == members()[name]


# What a build without the channels, or without the escape, does not have.
CHANNELS = ("channels.", "follower.", "imu.", "motor.")
ESCAPE = tuple(f"admittance.{name}" for name in ("smoothing", "brake_limit", "lead", "push_", "ahead", "tip_"))


def printed(folder: Path, *flags: str) -> dict[str, dict[str, tuple[float, ...]]]:
    """Values of every field in both presets, by preset and name, as the library built with ``flags`` sets them."""
    context = Context(ROOT, folder, os.environ["PATH"])
    sources = [*core_sources(CORE), Path(__file__).parent / "presets" / "print_presets.c"]
    program = HOST.build(context, sources, folder / "print_presets", "-O1", *flags)
    presets: dict[str, dict[str, tuple[float, ...]]] = {"default": {}, "paper": {}}
    for line in HOST.run(context, program).stdout.splitlines():
        preset, name, *values = line.split()
        presets[preset][name] = tuple(map(float.fromhex, values))
    return presets


def stated(preset: str) -> dict[str, tuple[float, ...]]:
    """The same of the FMU's table."""
    values: dict[str, tuple[float, ...]] = {}
    for variable in table("controller").select("parameter"):
        if variable.name not in OTHER_PARAMETERS:
            name = variable.name.partition("[")[0]
            values[name] = (*values.get(name, ()), in_preset(variable, preset))
    return values


def in_preset(variable: Variable, preset: str) -> float:
    value = variable.start if preset == "default" or variable.paper is None else variable.paper
    assert value is not None
    return float(value)


@pytest.mark.parametrize(
    ("flags", "left_out"),
    [
        ((), ()),
        (("-DGW_WITH_CHANNELS=0",), CHANNELS),
        (("-DGW_WITH_ESCAPE=0",), ESCAPE),
        (("-DGW_WITH_CHANNELS=0", "-DGW_WITH_ESCAPE=0"), CHANNELS + ESCAPE),
    ],
    ids=["everything", "no channels", "no escape", "neither"],
)
def test_presets_of_the_library_are_those_of_the_table(
    tmp_path: Path, flags: tuple[str, ...], left_out: tuple[str, ...]
) -> None:
    """What is not linked has the paper's values; the program refuses to print a configuration that is not valid."""
    presets = printed(tmp_path, "-DGW_REAL_DOUBLE=1", *flags)
    paper, best = stated("paper"), stated("default")
    differ = {name for name in best if best[name] != paper[name]}
    of_escape = {name for name in differ if name.startswith("admittance.")}
    assert len(of_escape) > 3
    assert len(differ - of_escape) > 3
    for name in (of_escape if ESCAPE[0] in left_out else set()) | (
        differ - of_escape if CHANNELS[0] in left_out else set()
    ):
        best[name] = paper[name]
    for preset, values in (("default", best), ("paper", paper)):
        linked = {name: value for name, value in values.items() if not name.startswith(left_out or ("no such",))}
        assert presets[preset] == linked, preset
