"""robots/*.toml -> a Modelica record: the same numbers, with their units, sources and provenance."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

# Types of Modelica.Units.SI; a number whose unit has none there is a Real with that unit.
SI_TYPES = {
    "kg": "SI.Mass",
    "kg.m2": "SI.Inertia",
    "m": "SI.Length",
    "m/s": "SI.Velocity",
    "m/s2": "SI.Acceleration",
    "N": "SI.Force",
    "N.m": "SI.Torque",
    "N.s": "SI.Impulse",
    "N/m": "SI.TranslationalSpringConstant",
    "N.s/m": "SI.TranslationalDampingConstant",
    "N.m/rad": "SI.RotationalSpringConstant",
    "N.m.s/rad": "SI.RotationalDampingConstant",
    "Hz": "SI.Frequency",
}
LINE = 160


def numbers(table: Mapping[str, Any], path: tuple[str, ...] = ()) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Each entry of a robot file that has a value, as ``("wheel_radius", entry)``."""
    for key, entry in table.items():
        if isinstance(entry, dict):
            if "value" in entry:
                yield "_".join((*path, key)), entry
            else:
                yield from numbers(entry, (*path, key))


def declaration(name: str, entry: Mapping[str, Any]) -> str:
    """One line of the record: type, value, and what is known of the value."""
    value, unit = entry["value"], entry["unit"]
    counted = isinstance(value, int) and unit == "1"
    kind = "Integer" if counted else SI_TYPES.get(unit, "Real")
    attributes = f'(unit="{unit}")' if kind == "Real" else ""
    size = f"[{len(value)}]" if isinstance(value, list) else ""
    if size and attributes:
        attributes = f"(each {attributes[1:]}"
    text = "{" + ", ".join(repr(float(v)) for v in value) + "}" if size else repr(value if counted else float(value))
    note = f"; {entry['note']}" if "note" in entry else ""
    described = f"{entry['provenance']}, {entry['confidence']} confidence{note}".replace("\\", "\\\\").replace('"', "'")
    return f'  parameter {kind} {name}{size}{attributes}={text} "{described}";\n'


def record(robot: Path) -> str:
    """The text of Parameters/<Name>.mo for the robot file ``robot``."""
    with robot.open("rb") as file:
        table = tomllib.load(file)
    name = table["robot"]["name"]
    rows = "".join(
        f"<tr><td>{key}</td><td>{entry['unit']}</td><td>{entry['provenance']}</td><td>{_html(entry['source'])}</td></tr>\n"
        for key, entry in numbers(table)
    )
    return (
        f'within GiveWay.Parameters;\nrecord {name} "Numbers of {name}, made from robots/{robot.name}"\n'
        "  extends Modelica.Icons.Record;\n  import Modelica.Units.SI;\n"
        + "".join(declaration(key, entry) for key, entry in numbers(table))
        + '  annotation (\n    Documentation(info="<html>\n'
        f"<p>Made from robots/{robot.name} by <code>python -m giveway_modelica record</code>: not to be edited.\n"
        "Given: printed in the paper; sourced: found elsewhere; fitted: to the paper's results; assumed: estimated."
        "</p>\n"
        '<table border=\\"1\\">\n<tr><th>number</th><th>unit</th><th>provenance</th><th>source</th></tr>\n'
        f"{rows}</table>\n"
        f'</html>"));\nend {name};\n'
    )


def _html(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace("\\", "\\\\").replace('"', "&quot;")
