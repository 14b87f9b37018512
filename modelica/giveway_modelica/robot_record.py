"""robots/*.toml -> a Modelica record: the same numbers, with their units, sources and provenance."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from giveway.robot.robot_file import Entry, read_robot

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


def numbers(robot: Path) -> Iterator[tuple[str, Entry]]:
    """Each number of the robot file ``robot`` under the name that it has in the record: ``wheel_radius``."""
    for name, entry in read_robot(robot).entries():
        yield name.replace(".", "_"), entry


def declaration(name: str, entry: Entry) -> str:
    """One line of the record: type, value, and what is known of the value."""
    counted = isinstance(entry.values[0], int) and entry.unit == "1"
    kind = "Integer" if counted else SI_TYPES.get(entry.unit, "Real")
    attributes = f'(unit="{entry.unit}")' if kind == "Real" else ""
    size = f"[{len(entry.values)}]" if entry.is_list else ""
    if size and attributes:
        attributes = f"(each {attributes[1:]}"
    values = [repr(value if counted else float(value)) for value in entry.values]
    text = "{" + ", ".join(values) + "}" if size else values[0]
    note = f"; {entry.note}" if entry.note else ""
    described = f"{entry.provenance}, {entry.confidence} confidence{note}".replace("\\", "\\\\").replace('"', "'")
    return f'  parameter {kind} {name}{size}{attributes}={text} "{described}";\n'


def record(robot: Path) -> str:
    """The text of Parameters/<Name>.mo for the robot file ``robot``."""
    name = read_robot(robot).name
    entries = list(numbers(robot))
    rows = "".join(
        f"<tr><td>{key}</td><td>{entry.unit}</td><td>{entry.provenance}</td><td>{_html(entry.source)}</td></tr>\n"
        for key, entry in entries
    )
    return (
        f'within GiveWay.Parameters;\nrecord {name} "Numbers of {name}, made from robots/{robot.name}"\n'
        "  extends Modelica.Icons.Record;\n  import Modelica.Units.SI;\n"
        + "".join(declaration(key, entry) for key, entry in entries)
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
