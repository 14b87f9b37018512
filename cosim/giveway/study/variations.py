"""What a study file varies: quantities and values of its tables ``[[vary]]``, ``[designs]`` and ``[[tolerance]]``."""

from __future__ import annotations

import csv
import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from giveway.base.checks import finite
from giveway.base.errors import FileError, GivewayError, InputFileError
from giveway.base.shapes import Choice, Either, Flag, List, Number, Shape, Table, Text, Variants, Whole
from giveway.base.toml_sections import Section
from giveway.base.units import WrittenUnit, factor
from giveway.robot.population import Quantity as RobotQuantity
from giveway.robot.population import group_of_plant, quantities_of
from giveway.robot.variables import table
from giveway.study import designs as design_module
from giveway.study.designs import DesignPlan
from giveway.study.distributions import DISTRIBUTIONS, Spread, Tolerance, Varied, check_spread
from giveway.study.quantities import Quantity, columns, find, value_of
from giveway.study.setup import Case

__all__ = [
    "DESIGNS",
    "ROBOTS",
    "TOLERANCE",
    "VARY",
    "crowd_of",
    "designs_of",
    "refuse_replaced",
    "refuse_twice",
    "tolerance_of",
    "varied_of",
    "written_unit",
]

_SPREAD = ("low", "high", "mode", "mean", "sigma")
SYMMETRIC = ("uniform", "normal", "triangular")  # distributions between two ends alone
LEVELS_MAX = 100_000
ROBOTS = ("file", "crowd")  # whose robot a tolerance sample has
_OPTIONS: dict[str, Shape] = {
    "count": Whole("of designs; of sobol-indices times quantities + 2", 2, design_module.COUNT_MAX),
    "trajectories": Whole("of the Morris method (20)", 2, 10_000),
    "grid": Whole("levels per quantity, even (4)", 2, 100),
    "file": Text("CSV: a line of quantities, name [unit], then one design per line"),
}
_SCALES = ("linear", "log")
_DEVIATIONS = ("none", "relative", "absolute")
_VALUE = Either("", (Number(), Flag(), Text()))
_QUANTITY: dict[str, Shape] = {
    "quantity": Text("a parameter, a number of the robot file (robot. ...), or of the hit (collision. ...)"),
    "also": List("parameters that get the same value", Text(), "a list of quantities"),
    "unit": Text('of the numbers here, such as "N/mm"'),
    "distribution": Choice("", tuple(DISTRIBUTIONS)),
    **{key: Number() for key in _SPREAD},
}
VARY = Table(
    "what varies",
    {
        **_QUANTITY,
        "nominal": Either("while another quantity varies (one-at-a-time)", _VALUE.shapes),
        "values": List("", _VALUE, "a list with at least one value", 1),
        "levels": Whole("values between low and high", 2, LEVELS_MAX),
        "scale": Choice("", _SCALES),
    },
    ("quantity",),
)
TOLERANCE = Table(
    "what deviates",
    {
        **_QUANTITY,
        "relative": Number("0.3: +-30 %"),
        "absolute": Number("+- so much"),
        "deviation": Choice("of what the distribution is: of the quantity itself, or of its deviation", _DEVIATIONS),
    },
    ("quantity",),
)
DESIGNS = Variants(
    "which designs there are",
    "kind",
    {
        kind: Table("", {key: _OPTIONS[key] for key in keys}, tuple(key for key in keys if key in ("count", "file")))
        for kind, keys in design_module.OPTIONS.items()
    },
)


def refuse_twice(table: str, names: Sequence[str]) -> None:
    for index, name in enumerate(names):
        if name in names[:index]:
            raise GivewayError(f"{table}[{index}].quantity", name, "a quantity that is not there already")


def _quantity(section: Section) -> Quantity:
    """The quantity of a table, and those that ``also`` have its value."""
    quantity = find(section.full("quantity"), section.text("quantity", section.values.get("quantity", "")))
    for index, name in enumerate(section.values.get("also", [])):
        field = f"{section.full('also')}[{index}]"
        other = find(field, str(name))
        if not (quantity.columns and other.columns) or (other.kind, other.unit) != (quantity.kind, quantity.unit):
            raise GivewayError(field, name, f"a parameter of the same kind and unit as {quantity.name}")
        quantity = dataclasses.replace(
            quantity,
            minimum=max(quantity.minimum, other.minimum),
            maximum=min(quantity.maximum, other.maximum),
            columns=(*quantity.columns, *other.columns),
        )
    return quantity


def written_unit(section: Section, unit: str) -> WrittenUnit | None:
    """The unit that the table states; None: ours."""
    if "unit" not in section.values:
        return None
    name = section.text("unit")
    if name == unit:
        return WrittenUnit(name)  # a currency has no other one
    return WrittenUnit(name, factor(section.full("unit"), name, unit))


def varied_of(section: Section) -> Varied:
    """The quantity and values of a table ``[[vary]]``."""
    quantity = _quantity(section)
    if "unit" in section.values and quantity.unit == "":
        raise GivewayError(section.full("unit"), section.values["unit"], f"none: {quantity.name} has no unit")
    written = written_unit(section, quantity.unit)
    scale = 1.0 if written is None else written.scale
    nominal = None
    if "nominal" in section.values:
        nominal = value_of(section.full("nominal"), section.values["nominal"], quantity, scale)
    if "values" in section.values:
        for key in ("levels", "scale", "distribution", *_SPREAD):
            if key in section.values:
                raise GivewayError(section.full(key), section.values[key], "nothing: the values are listed")
        values = section.values["values"]
        levels = tuple(value_of(section.full("values"), value, quantity, scale) for value in values)
        return Varied(quantity, nominal, levels, written=written, field=section.name)
    kind = section.text("distribution", "loguniform" if _logarithmic(section) else "uniform")
    given = {key: section.number(key) * scale for key in _SPREAD if key in section.values}
    spread = check_spread(section.name, quantity, kind, given)
    for key, value in (("low", spread.low), ("high", spread.high)):
        where = section.full(key if key in section.values else "sigma")
        value_of(where, value, quantity, 1.0, whole_needed=False)
    levels = ()
    if "levels" in section.values:
        count = section.whole("levels", 0)
        space = np.geomspace if kind == "loguniform" else np.linspace
        found = space(spread.low, spread.high, count)
        found = np.rint(found) if quantity.kind == "integer" else found
        levels = tuple(float(value) for value in dict.fromkeys(found.tolist()))
    return Varied(quantity, nominal, levels, spread, written, section.name)


def _logarithmic(section: Section) -> bool:
    if "scale" in section.values and "distribution" in section.values:
        raise GivewayError(section.full("scale"), section.values["scale"], "nothing beside a distribution")
    return section.choice("scale", _SCALES, "linear") == "log"


def tolerance_of(section: Section) -> Tolerance:
    quantity = _quantity(section)
    if quantity.kind != "real":
        raise GivewayError(section.full("quantity"), quantity.name, "a quantity of real numbers")
    keys = [key for key in ("relative", "absolute") if key in section.values]
    if not keys and any(key in section.values for key in ("deviation", *_SPREAD)):
        return _stated_spread(section, quantity)
    if len(keys) != 1:
        found = "both" if keys else "nothing"
        allowed = "one of relative and absolute, or a distribution with its numbers"
        raise GivewayError(section.full("relative"), found, allowed)
    for key in ("deviation", *_SPREAD):
        if key in section.values:
            raise GivewayError(section.full(key), section.values[key], f"nothing beside {keys[0]}")
    relative = keys[0] == "relative"
    scale, written = _tolerance_unit(section, quantity, relative)
    half = finite(section.full(keys[0]), section.values[keys[0]] * scale if _is_number(section, keys[0]) else None)
    if half <= 0.0 or (relative and half >= 1.0):
        allowed = "above 0 and below 1 (0.3: by 30 %)" if relative else f"above 0 {quantity.unit}"
        raise GivewayError(section.full(keys[0]), section.values[keys[0]], allowed)
    kind = section.choice("distribution", SYMMETRIC, "uniform")
    # Of a normal distribution, the stated ends are three standard deviations away.
    return Tolerance(quantity, relative, Spread(kind, -half, half, 0.0, 0.0, half / 3.0), written)


def _tolerance_unit(section: Section, quantity: Quantity, relative: bool) -> tuple[float, WrittenUnit | None]:
    if "unit" not in section.values:
        return 1.0, None
    unit = section.text("unit")
    scale = factor(section.full("unit"), "degC" if unit == "K" else unit, "1" if relative else quantity.unit)
    return scale, WrittenUnit(unit, scale)


def _stated_spread(section: Section, quantity: Quantity) -> Tolerance:
    """A tolerance whose distribution is stated: of the quantity itself, or of its ``deviation``."""
    of = section.choice("deviation", _DEVIATIONS, "none")
    kind = section.choice("distribution", tuple(DISTRIBUTIONS))
    relative, replaces = of == "relative", of == "none"
    scale, written = _tolerance_unit(section, quantity, relative)
    given = {key: section.number(key) * scale for key in _SPREAD if key in section.values}
    ends = (quantity.minimum, quantity.maximum) if replaces else (-1.0 if relative else -math.inf, math.inf)
    spread = check_spread(section.name, quantity, kind, given, ends)
    if relative and spread.low < -1.0:
        raise GivewayError(section.full("low"), section.values["low"], "a share of the value, -1 or more")
    if replaces:
        for key, value in (("low", spread.low), ("high", spread.high)):
            if key in given:
                value_of(section.full(key), value, quantity)
        middle = {"mean": spread.mean, "mode": spread.mode}
        for key in ("mean", "mode"):
            if key in given:
                value_of(section.full(key), middle[key], quantity)
    return Tolerance(quantity, relative, spread, written, replaces)


def refuse_replaced(field: str, tolerance: Tolerance, varied: Sequence[Varied]) -> None:
    """What designs choose cannot have a distribution of its own: it only deviates."""
    for one in varied:
        for quantity in one.sets:
            same = quantity.name == tolerance.quantity.name or set(quantity.columns) & set(tolerance.quantity.columns)
            if same:
                allowed = f'relative, absolute, or deviation = "relative": {one.field} gives it its value'
                raise GivewayError(f"{field}.distribution", tolerance.spread.kind, allowed)


def crowd_of(
    section: Section, cases: Sequence[Case], varied: Sequence[Varied], tolerances: Sequence[Tolerance], sampled: bool
) -> tuple[RobotQuantity, ...]:
    """In what the robots of the tolerance samples differ: in that of the plant that the scenario has.

    A study says with ``robot`` whose robots they are. If it does not, samples that are ``sampled`` have robots of
    the crowd: no robot is its file. Corners are no draw, and have the file's.
    """
    corners = section.values.get("kind") == "corners"
    if section.choice("robot", ROBOTS, "crowd" if sampled and not corners else "file") == "file":
        return ()
    if corners:
        raise GivewayError(section.full("kind"), "corners", 'sobol, with robot = "crowd"')
    testbed = {variable.name: variable.start for variable in table("testbed").select("parameter")}
    testbed |= cases[0].scenario.parameters("testbed")
    group = group_of_plant(bool(testbed["base.tipping"]), testbed["roller.arrangement"] == 1)
    found = quantities_of(group, cases[0].scenario.robot)
    if testbed["roller.arrangement"] == 1:
        found = (*found, RobotQuantity("rollers of each wheel", ("roller.seed",), 0.0, 2.0**31))
    all_columns = columns()
    drawn = {all_columns.index[f"testbed.{name}"]: one for one in found for name in one.parameters}
    for i, tolerance in enumerate(tolerances):
        if twice := set(tolerance.quantity.columns) & set(drawn):
            what = drawn[twice.pop()].what
            raise GivewayError(f"tolerance[{i}].quantity", tolerance.quantity.name, _not_drawn(what))
    for one in varied:
        for column in set(one.columns) & set(drawn):
            if not drawn[column].scales:
                raise GivewayError(one.field, one.quantity.name, _not_drawn(drawn[column].what))
    return found


def _not_drawn(what: str) -> str:
    return f'what robots of the crowd do not differ in ({what}), or robot = "file" in [tolerances]'


def _is_number(section: Section, key: str) -> bool:
    section.number(key)
    return True


def designs_of(top: Section, varied: tuple[Varied, ...], folder: Path) -> tuple[DesignPlan, tuple[Varied, ...]]:
    """Which designs are made of what varies; a CSV file of designs says itself what varies besides parts."""
    section = top.table("designs") or Section("designs", {"kind": "factorial"}, None)
    kind = section.text("kind")
    if kind == "csv":
        for one in varied:
            if one.parts is None:
                raise GivewayError(
                    f"{one.field}.quantity", one.quantity.name, "no [[vary]] beside a CSV file of designs"
                )
        found, rows = _csv(folder / section.text("file"), section, varied)
        return DesignPlan(kind, rows=rows), found
    if not varied:
        if kind != "factorial":
            raise GivewayError("designs.kind", kind, "at least one [[vary]] or [[parts]]")
        return DesignPlan("factorial"), ()
    if kind in ("factorial", "one-at-a-time"):
        for one in varied:
            if not one.levels:
                raise GivewayError(f"{one.field}.levels", "nothing", f"levels or values: {kind} needs them")
    plan = DesignPlan(
        kind,
        count=int(section.required("count", "a whole number")) if "count" in design_module.OPTIONS[kind] else 0,
        trajectories=section.whole("trajectories", 20),
        grid=section.whole("grid", 4),
    )
    if plan.grid % 2:
        raise GivewayError("designs.grid", plan.grid, "an even number of levels")
    if kind in ("morris", "sobol-indices") and len(varied) < 2:
        raise GivewayError("designs.kind", kind, "at least two [[vary]] or [[parts]]")
    if (size := plan.size(varied)) > design_module.COUNT_MAX:
        key = "designs.count" if "count" in section.values else "designs.kind"
        raise GivewayError(key, f"{size} designs", f"at most {design_module.COUNT_MAX}")
    return plan, varied


def _csv(path: Path, section: Section, parts: Sequence[Varied]) -> tuple[tuple[Varied, ...], Any]:
    """Quantities and designs of a CSV file: a line of names (``testbed.bumper.travel [mm]``), one line per design.

    A column may also be one of the choices of ``parts``, all of which must be there.
    """
    if not path.is_file():
        raise GivewayError(section.full("file"), section.values["file"], "a CSV file, its path seen from this file")
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            rows_read = list(enumerate(csv.reader(stream), 1))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise FileError(path, f"cannot be read: {error}") from None
    lines = [(number, row) for number, row in rows_read if any(cell.strip() for cell in row)]
    if len(lines) < 2:
        raise InputFileError(path, 1, GivewayError("designs", f"{len(lines)} lines", "names, then designs"))
    head_line, head = lines[0]
    found: list[Varied] = []
    scales: list[float] = []
    try:
        for cell in head:
            name, _, unit = cell.strip().partition("[")
            chosen = [one for one in parts if one.quantity.name == name.strip()]
            if chosen and not unit:
                found.append(chosen[0])
                scales.append(1.0)
                continue
            quantity = find(f"column {len(found) + 1}", name.strip())
            label = unit.strip(" ]")
            scales.append(factor(name.strip(), label, quantity.unit) if unit else 1.0)
            found.append(Varied(quantity, written=WrittenUnit(label, scales[-1]) if unit else None))
        refuse_twice("column", [one.quantity.name for one in found])
        for one in parts:
            if one not in found:
                raise GivewayError("columns", ", ".join(head), f"a column {one.quantity.name}, {one.field}")
    except GivewayError as error:
        raise InputFileError(path, head_line, error) from None
    rows = np.empty((len(lines) - 1, len(found)))
    for index, (number, row) in enumerate(lines[1:]):
        try:
            if len(row) != len(found):
                raise GivewayError("columns", len(row), f"{len(found)}, as in the first line")
            rows[index] = [
                value_of(one.quantity.name, _cell(cell.strip(), one.quantity), one.quantity, scale)
                for one, cell, scale in zip(found, row, scales, strict=True)
            ]
        except GivewayError as error:
            raise InputFileError(path, number, error) from None
    return tuple(found), rows


def _cell(text: str, quantity: Quantity) -> Any:
    if quantity.kind == "choice":
        return text
    if quantity.kind == "boolean":
        return {"true": True, "1": True, "false": False, "0": False}.get(text.lower(), text)
    try:
        return float(text)
    except ValueError:
        return text
