"""Results as tables on a terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import typer

from giveway.base.terminal import print_columns, print_warnings

if TYPE_CHECKING:
    from giveway.simulation.result import Result

__all__ = ["print_results"]


def print_results(name: str, results: Mapping[str, Result]) -> None:
    """The metrics of ``results``, a column for each bumper, with pushes above and warnings below."""
    from giveway.simulation.summary import false_detection_line, preset_line, push_rows, table_rows, warning_lines

    for result in results.values():
        pushes = push_rows(result)
        if pushes:
            print_columns(f"{name}: how each push was felt (true)", pushes[0], pushes[1:])
            line = false_detection_line(result)
            if line:
                typer.echo(f"{line}\n")
    header = ("", *("no bumper" if bumper == "none" else bumper for bumper in results))
    print_columns(f"{name}: estimated or measured (true)", header, table_rows(results))
    if line := preset_line(results):
        typer.echo(line)
    print_warnings(warning_lines(results))
