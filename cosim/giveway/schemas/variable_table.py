"""The shape of the FMUs' variable tables, `fmu/models/*/variables.toml`, which `fmu/codegen` reads and checks.

It stands here because the code generator runs before this package can; a test holds both against each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from giveway.base.shapes import Choice, Either, Flag, List, Number, Rows, Schema, Shape, Table, Text, Version, Whole

__all__ = ["SHARED_KEYS", "variable_table_shape"]

WORD = r"[a-z][a-z0-9_]*"
NAME = rf"^{WORD}(\.{WORD})*$"
MEMBER = r"^(\(\)|[a-z]\w*(\[i\])?(\.[a-z]\w*(\[i\])?)*)$"
LAST = 2**31 - 2
SHARED_KEYS = ("reference", "shared", "description", "minimum", "maximum", "dependencies")
"""What an entry with `shared` may have; the rest comes from the other table's entry."""


@dataclass(frozen=True)
class Word(Shape):
    """A text that the regular expression ``pattern`` finds something in."""

    pattern: str = ""

    def schema(self) -> Schema:
        return super().schema() | {"type": "string", "pattern": self.pattern}


@dataclass(frozen=True)
class VariableEntry(Table):
    """A [[variable]], whose keys depend on each other."""

    def schema(self) -> Schema:
        own = [key for key in self.keys if key != "shared"]
        return super().schema() | {
            "if": {"required": ["shared"]},
            "then": {"propertyNames": {"enum": list(SHARED_KEYS)}},
            "else": {"required": ["name", "causality", "type", "description"], "propertyNames": {"enum": own}},
            "allOf": [
                _rule("type", ["real"], needed=["unit"]),
                _rule("type", ["integer", "boolean"], without=["unit", "nominal", "allow_nonfinite"]),
                _rule("type", ["boolean"], without=["minimum", "maximum"]),
                _rule("type", ["real", "boolean"], without=["choices"]),
                _rule("causality", ["parameter", "input"], needed=["start"], without=["dependencies"]),
                _rule("causality", ["input", "output"], without=["paper", "plant", "choices"]),
                _rule("causality", ["output"], without=["start"]),
            ],
        }


def _rule(key: str, words: list[str], needed: Sequence[str] = (), without: Sequence[str] = ()) -> dict[str, Any]:
    """With one of these words at ``key``: keys that have to be there, and keys that must not be."""
    then = {"required": list(needed), "properties": dict.fromkeys(without, False)}
    return {"if": {"properties": {key: {"enum": words}}, "required": [key]}, "then": then}


def variable_table_shape() -> Table:
    """A variable table: the model, its variables, and the states and event indicators of Model Exchange."""
    reference = Whole("value reference of the first scalar; append-only", 1, LAST)
    name = Word("words joined by dots", NAME)
    count = Whole("so many scalars, name[0], name[1], ...", 1, 1024)
    description = Word("what it is, for users", r"\S")
    dependencies = List("inputs and states that it depends on within the same instant", Word("", NAME))
    display_unit = Text("unit that an importer may show instead")
    one = (Number(), Flag(), Table("", {"robot": Text("path in the robot file")}, ("robot",)))
    start = Either(
        "a value, or where the robot file has it; or a list of them, one for each scalar",
        (*one, List("", Either("", one))),
    )
    variable = {
        "reference": reference,
        "name": name,
        "shared": Word("variable of the table that `shares` names: the rest is its entry's", NAME),
        "count": count,
        "causality": Choice("", ("parameter", "input", "output")),
        "type": Choice("", ("real", "integer", "boolean")),
        "unit": Text('SI, such as "N.m/rad"; "1" without one; only and always of a real'),
        "start": start,
        "minimum": Number("smallest allowed value"),
        "maximum": Number("largest allowed value"),
        "nominal": Number("usual size, above 0", 0.0),
        "allow_nonfinite": Flag("an input that may be NaN or infinite"),
        "dependencies": dependencies,
        "description": description,
        "display_unit": display_unit,
        "plant": Word(
            "type of the plant's parameter: number, divisor, wheels, whole, or an enumeration", r"^[A-Za-z]+$"
        ),
        "choices": List("names of the values 0, 1, ...", Word("", NAME)),
        "c_core": Word("member of the module's configuration, input or output; () is what a step returns", MEMBER),
        "paper": Either("value in the preset paper, where that is not the start value", (Number(), Flag())),
    }
    state = {
        "reference": reference,
        "name": name,
        "count": count,
        "unit": variable["unit"],
        "display_unit": display_unit,
        "nominal": variable["nominal"],
        "dependencies": dependencies,
        "description": description,
    }
    indicator = {"reference": reference, "name": name, "count": count, "description": description}
    model = {
        "name": Word("of the FMU, after giveway_", rf"^{WORD}$"),
        "description": description,
        "step_size_s": Number("of communication, s; above 0", 0.0),
        "shares": Text("path of the table whose variables entries with `shared` take"),
        "c_core": Word("module of c_core that the variables are of: a header without .h", r"^gw_[a-z_]+$"),
    }
    keys = {
        "schema_version": Version("of this format"),
        "model": Table("what it is the table of", model, ("name", "description", "step_size_s")),
        "variable": Rows("inputs, outputs and parameters", VariableEntry("", variable, ("reference",))),
        "state": Rows(
            "continuous states, each with its derivative",
            Table("", state, ("reference", "name", "unit", "nominal", "dependencies", "description")),
        ),
        "indicator": Rows("event indicators", Table("", indicator, ("reference", "name", "description"))),
    }
    return Table("", keys, ("schema_version", "model", "variable"))
