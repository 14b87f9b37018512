"""Every variable of the FMUs, from the tables that they are made of."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

from giveway.robot.variables import Variable, VariableTable
from giveway.robot.variables import table as variable_table

from docs.markdown import escaped, table

__all__ = ["MODELS", "pages"]

MODELS = {
    "controller": "estimator, detector, reaction and supervisor: what runs on the robot's computer",
    "testbed": "the robot, its drives and sensors, and what hits it",
    "drivetrain": "one motor with gear, torque sensor and servo",
    "bumper": "the bumper alone, between two faces",
}
KINDS = {"input": "Inputs", "output": "Outputs", "parameter": "Parameters"}


def pages(root: Path) -> dict[str, str]:
    """A page per FMU; the tables are those of the installed package, not files below ``root``."""
    return {f"reference/variables/{model}.md": _page(model, variable_table(model)) for model in MODELS}


def _page(model: str, variables: VariableTable) -> str:
    text = f"# Variables of the {model}\n\n`giveway_{model}`: {MODELS[model]}. {len(variables)} variables. "
    text += f"A scenario sets a parameter as `{model}.NAME`, any FMI tool as `NAME`.\n"
    for causality, title in KINDS.items():
        chosen = variables.select(causality)
        if chosen:
            text += f"\n## {title}\n"
        for group, members in groupby(chosen, key=lambda one: one.name.partition(".")[0].partition("[")[0]):
            text += f"\n### {title}: {escaped(group)}\n\n"
            text += table(("name", "unit", "range", "start", ""), (_row(one) for one in members))
    return text


def _row(one: Variable) -> tuple[str, ...]:
    robot = f" Robot file: `{one.robot_path}`." if one.robot_path else ""
    start = "" if one.start is None else _number(one.start)
    paper = "" if one.paper is None else f" Preset `paper`: {_number(one.paper)}."
    return f"`{one.name}`", one.unit, _range(one), start, escaped(one.description) + "." + paper + robot


def _number(value: float | int | bool) -> str:
    return str(value).lower() if isinstance(value, bool) else f"{value:.10g}"


def _range(one: Variable) -> str:
    if one.type == "boolean":
        return "true, false"
    low, high = (f"{limit:.10g}" for limit in (one.minimum, one.maximum))
    if low == "-inf":
        return "" if high == "inf" else f"at most {high}"
    return f"at least {low}" if high == "inf" else f"{low} to {high}"
