"""What `giveway crowd curves` writes: the figure, a table of every point, and the tables for the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from giveway.base.files import replace_files
from giveway.crowd.curves.curve import TABLE_HEADER, Curve, curves, table_rows, write_csv
from giveway.crowd.curves.figure import write_figure
from giveway.crowd.curves.situations import SITUATIONS
from giveway.crowd.parts import Record

__all__ = ["write"]

Table = tuple[str, tuple[str, ...], list[tuple[str, ...]]]

OF_ALL, OF_STATED = "all", "free, 0.5 m/s"


def write(folder: Path, about: str, hits: Sequence[Record], quiet: Sequence[Record]) -> tuple[list[Table], list[Path]]:
    """Write curves.png and curves.csv into ``folder``, both or none; the tables, and the paths."""
    found: dict[str, Sequence[Curve]] = {
        OF_ALL: list(curves(hits, quiet)),
        OF_STATED: list(curves(hits, quiet, stated=True)),
    }
    paths = [folder / f"curves.{ending}" for ending in ("png", "csv")]
    with replace_files(*paths) as (picture, table):
        write_figure(picture, f"Delay of hits against false alarms: {about}", found[OF_ALL])
        write_csv(table, found)
    return [table for of, mine in found.items() for table in _tables(of, mine)], paths


def _tables(of: str, found: Sequence[Curve]) -> list[Table]:
    tables = []
    for situation in SITUATIONS:
        mine = [curve for curve in found if curve.situation == situation]
        point = mine[0].points[-1]
        title = (
            f"Hits {situation} ({of}): delay, median / 95 % in ms at threshold, by false alarms; "
            f"{point.hits} hits, {point.hours:.2f} h"
        )
        tables.append((title, TABLE_HEADER, table_rows(mine)))
    return tables
