"""The command `giveway variables`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from giveway.base.table_document import Shown
from giveway.base.terminal import print_columns

if TYPE_CHECKING:
    from collections.abc import Mapping

    from giveway.robot.variables import Value, Variable

__all__ = ["variables"]


def variables(
    model: Annotated[str, typer.Argument(help="controller, testbed, drivetrain or bumper.")],
    grep: Annotated[str, typer.Option("--grep", metavar="TEXT", help="Only names or descriptions with TEXT.")] = "",
    preset: Annotated[str, typer.Option("--preset", help="Start values of this preset: default or paper.")] = "default",
) -> None:
    """List the variables of an FMU: what can be set, its range and unit, and what comes out."""
    from giveway.base.words import counted
    from giveway.robot.presets import DEFAULT, check_preset, preset_values
    from giveway.robot.variables import table

    check_preset(preset, "--preset")
    other = preset_values(preset, model)
    wanted = grep.lower()
    chosen = [v for v in table(model) if wanted in v.name.lower() or wanted in v.description.lower()]
    rows = [(v.name, v.causality, _start(v, other), Shown(v.allowed, v.range), v.description) for v in chosen]
    title = f"{counted(len(chosen), 'variable')} of {model}" + ("" if preset == DEFAULT else f", preset {preset}")
    print_columns(title, ("name", "kind", "start", "allowed", "meaning"), rows)


def _start(variable: Variable, preset: Mapping[str, Value]) -> Shown:
    start = preset.get(variable.name, variable.start)
    return Shown("" if start is None else f"{start}", start)
