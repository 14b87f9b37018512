"""A bumper as its data sheets state it: the table ``[bumper]`` of a scenario file, with a law and its numbers.

    [bumper]
    law = "foam"
    thickness = { value = 60, unit = "mm" }     # or 0.06: without a unit in that of the parameter
    force_25 = 22.0                             # N
    ...

A key is the parameter `bumper.KEY` or `bumper.LAW_KEY`. Beside spring and magnet nothing acts that is not stated:
damping, friction of the guide, preload and what else a law can do without are 0. What is needed is refused if missing.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from giveway.base.checks import finite
from giveway.base.errors import GivewayError
from giveway.base.shapes import Either, Measure, Number, Shape, Table, Text, Variants
from giveway.base.toml_sections import Section
from giveway.base.units import factor
from giveway.robot.variables import table
from giveway.scenario.scenario import BUMPERS, ROBOT_BUMPERS

if TYPE_CHECKING:
    from giveway.robot.variables import Value

__all__ = ["COMMON", "FILE", "LAW", "NUMBERS", "acts", "bumper_shape", "law_of", "stated_bumper"]

LAW, FILE = "law", "file"
COMMON = ("travel", "plate_mass", "damping", "guide_friction", "guide_friction_speed", "stop_stiffness",
           "stop_damping")  # fmt: skip
_FOAM = ("thickness", "force_25", "force_50", "force_75", "hysteresis", "hysteresis_speed", "rate_gain")
_SPRING = ("spring_rate", "preload")
_OF_LAW: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "none": {},
        "spring": {key: key for key in _SPRING},
        "magnetic": {key: key for key in (*_SPRING, "latch_force", "latch_gap")},
        "foam": {key: f"foam_{key}" for key in _FOAM},
        "gas": {key: f"gas_{key}" for key in ("force", "length", "exponent", "ambient_force")},
        "damper": {key: f"damper_{key}" for key in ("rate", "square", "rebound")} | {key: key for key in _SPRING},
        "series": {key: key for key in (*_SPRING, "second_rate", "second_preload", "first_travel")},
        "lever": {"ratio": "lever_ratio", "mass": "lever_mass"} | {key: key for key in _SPRING},
        "table": {},
    }
)
NUMBERS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {law: (*keys.values(), *(COMMON if law != "none" else ())) for law, keys in _OF_LAW.items()}
)
"""Names of the numbers that a law has, without ``bumper.``; a table has its points besides."""
_NEEDED: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "foam": ("travel", "thickness", "force_25", "force_50", "force_75"),
        "gas": ("travel", "force"),
        "damper": ("travel", "rate"),
        "series": ("travel", "spring_rate", "second_rate", "first_travel"),
        "lever": ("travel", "spring_rate", "ratio"),
        "table": (FILE,),
    }
)
_NOT_STATED = {
    "damping": 0.0, "guide_friction": 0.0, "preload": 0.0, "foam_hysteresis": 0.0, "foam_rate_gain": 0.0,
    "damper_square": 0.0, "spring_rate": 1.0,
}  # fmt: skip
# Of a gas spring's data sheet, instead of its length.
_COMPRESSED, _STROKE = "force_compressed", "stroke"


def acts(law: str, parameter: str) -> bool:
    """Whether the testbed's ``parameter`` decides anything with a bumper of this law; true of all but a bumper's."""
    group, _, key = parameter.partition(".")
    if group != "bumper" or key == "kind":
        return True
    if key == "latch_model":
        return law == "magnetic"
    if key.startswith("table_"):
        return law == "table"
    return key in NUMBERS[law] or (key.startswith("mount") and law != "none")


@functools.cache
def bumper_shape() -> Variants:
    """The table ``[bumper]``: the keys of each law."""
    return Variants("a bumper as its data sheets state it", LAW, {law: _law_shape(law) for law in BUMPERS})


def _law_shape(law: str) -> Table:
    parameters = {**_OF_LAW[law], **({key: key for key in COMMON} if law != "none" else {})}
    if law == "gas":
        parameters |= {_COMPRESSED: "gas_force", _STROKE: "gas_length"}
    keys: dict[str, Shape] = {key: _number_shape(f"bumper.{parameter}") for key, parameter in parameters.items()}
    if law == "table":
        keys[FILE] = Text("CSV: travel, speed, force; its path seen from this file")
    return Table("", keys, _NEEDED.get(law, ()))


def _number_shape(parameter: str) -> Shape:
    """A number in the parameter's unit, or with a unit of its own."""
    variable = table("testbed")[parameter]
    plain = Number(variable.description, variable.minimum, variable.maximum, variable.unit)
    return Either(variable.description, (plain, Measure("")))


def law_of(stated: Any) -> str:
    """The law of ``bumper``, a name or a table, as far as it is one."""
    return str(stated.get(LAW, "")) if isinstance(stated, Mapping) else str(stated)


def stated_bumper(values: Any, folder: Path, name: str = "bumper") -> tuple[str, dict[str, Value]]:
    """The law that a table states, and the testbed's parameters; a file's path starts at ``folder``.

    Raises:
        GivewayError: names the key.
        InputFileError: something in a measured table is wrong.
    """
    law = Section(name, values, None).choice(LAW, BUMPERS)
    section = Section(name, values, bumper_shape().table(law))
    for key in _NEEDED.get(law, ()):
        section.required(key, f'{{ value = ..., unit = "..." }}: a bumper with the law {law} has it')
    found: dict[str, Value] = {}
    if law not in ROBOT_BUMPERS:
        found |= {f"bumper.{key}": value for key, value in _NOT_STATED.items() if key in NUMBERS[law]}
    if law == "table":
        from giveway.scenario.force_table import read_force_table

        measured = read_force_table(folder / section.text(FILE))
        found |= measured.parameters()
        found["bumper.travel"] = measured.travels_m[-1]
    for key, parameter in {**_OF_LAW[law], **{key: key for key in COMMON}}.items():
        if key in section.values:
            found[f"bumper.{parameter}"] = _number(section, key, f"bumper.{parameter}")
    if law == "gas":
        _complete_gas(section, found)
    _check(section, law, found)
    return law, found


def _number(section: Section, key: str, parameter: str) -> float:
    """A value in the parameter's unit, checked with its range."""
    variable = table("testbed")[parameter]
    given, scale = section.values[key], 1.0
    if isinstance(given, Mapping):
        stated = Section(section.full(key), given, ("value", "unit"))
        stated.required("unit", f'"{variable.unit}", or another one of its kind')
        given = stated.number("value")
        scale = factor(stated.full("unit"), stated.text("unit"), variable.unit)
    number = finite(section.full(key), given) * scale
    if not variable.minimum <= number <= variable.maximum:
        shown = given if scale == 1.0 else f"{given} (= {number:g})"
        raise GivewayError(section.full(key), shown, variable.allowed)
    return number


def _complete_gas(section: Section, found: dict[str, Value]) -> None:
    """The length of the gas column, of the force after a stroke if that is stated instead."""
    both = [key in section.values for key in (_COMPRESSED, _STROKE)]
    if "length" in section.values:
        if any(both):
            raise GivewayError(section.full("length"), section.values["length"],
                               f"one of both: length, or {_COMPRESSED} and {_STROKE}")  # fmt: skip
        return
    if not all(both):
        key = _STROKE if both[0] else _COMPRESSED if both[1] else "length"
        raise GivewayError(section.full(key), "nothing", f"length, or {_COMPRESSED} and {_STROKE}; it is needed")
    start = {name: table("testbed")[f"bumper.gas_{name}"].start or 0.0 for name in ("exponent", "ambient_force")}
    exponent, ambient = (float(found.get(f"bumper.gas_{name}", value)) for name, value in start.items())
    first = float(found["bumper.gas_force"]) + ambient
    last = _number(section, _COMPRESSED, "bumper.gas_force") + ambient
    if not 0.0 < first < last:
        raise GivewayError(section.full(_COMPRESSED), last - ambient, f"above force, {first - ambient:g} N")
    stroke = _number(section, _STROKE, "bumper.gas_length")
    length = stroke / (1.0 - (first / last) ** (1.0 / exponent))
    found["bumper.gas_length"] = table("testbed").check("bumper.gas_length", length)


def _check(section: Section, law: str, found: Mapping[str, Value]) -> None:
    """What the law asks of several numbers together, in the file's words; the FMUs check it, too."""
    travel = float(found.get("bumper.travel", 0.0))
    for what, column in (("foam", "foam_thickness"), ("gas", "gas_length")):
        if law == what and travel > 0.95 * float(found[f"bumper.{column}"]):
            longest = 0.95 * float(found[f"bumper.{column}"])
            raise GivewayError(section.full("travel"), travel, f"at most 0.95 {column} = {longest:g} m")
    if law == "series":
        solid = float(found["bumper.preload"]) + float(found["bumper.spring_rate"]) * float(
            found["bumper.first_travel"]
        )
        captive = float(found.get("bumper.second_preload", 0.0))
        if captive > solid:
            allowed = f"at most {solid:g} N, at which the first spring is solid"
            raise GivewayError(section.full("second_preload"), captive, allowed)
    if law == "table":
        last = float(found[f"bumper.table_travel[{int(found['bumper.table_rows']) - 1}]"])
        if travel > last:
            raise GivewayError(section.full("travel"), travel, f"at most {last:g} m, where the table ends")
