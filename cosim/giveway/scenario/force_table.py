"""A measured bumper: a CSV of force over travel and speed, checked with file, line and column.

    # Made up.
    travel [mm], speed [mm/s], force [N]
    0,           1,            0
    10,          1,            14
    ...

A line for every travel at every speed; speeds are positive while the bumper is compressed. The force at speed 0 decides
what is stored. If it was not measured, it is between both slowest directions, or that of the slowest compression.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.base.csv_rows import check_widths, head_parts, number_of, read_rows, title_of
from giveway.base.errors import GivewayError, InputFileError
from giveway.base.units import factor
from giveway.robot.variables import table

if TYPE_CHECKING:
    from giveway.robot.variables import Value

__all__ = ["THINNED", "ForceTable", "read_force_table"]

_COLUMNS = {"travel": "m", "speed": "m/s", "force": "N"}
LINES_MAX = 100_000
THINNED = 0.02  # of the greatest force: how far a table with fewer points may be off


@dataclass(frozen=True)
class ForceTable:
    """``forces_n[i][j]`` at ``travels_m[i]`` and ``speeds_mps[j]``; what is left out is at most ``residual_n`` off."""

    travels_m: tuple[float, ...]
    speeds_mps: tuple[float, ...]
    forces_n: tuple[tuple[float, ...], ...]
    residual_n: float

    def parameters(self) -> dict[str, Value]:
        """Of the testbed."""
        rows, columns = _room()
        found: dict[str, Value] = {
            "bumper.table_rows": len(self.travels_m),
            "bumper.table_columns": len(self.speeds_mps),
        }
        found |= {f"bumper.table_travel[{i}]": _at(self.travels_m, i) for i in range(rows)}
        found |= {f"bumper.table_speed[{j}]": _at(self.speeds_mps, j) for j in range(columns)}
        for i, j in itertools.product(range(rows), range(columns)):
            row = self.forces_n[i] if i < len(self.forces_n) else ()
            found[f"bumper.table_force[{columns * i + j}]"] = _at(row, j)
        return table("testbed").check_all(found)


def _at(values: Sequence[float], index: int) -> float:
    return values[index] if index < len(values) else 0.0


def _room() -> tuple[int, int]:
    """The greatest numbers of travels and speeds."""
    variables = table("testbed")
    return int(variables["bumper.table_rows"].maximum), int(variables["bumper.table_columns"].maximum)


@dataclass(frozen=True)
class _Cell:
    line: int
    text: str
    number: float


def read_force_table(path: Path) -> ForceTable:
    """The table in the file ``path``.

    Raises:
        FileError: it cannot be read.
        InputFileError: something in it is wrong, or such a bumper would create energy; names line and column.
    """
    lines = read_rows(path, "a table")
    if not 3 <= len(lines) <= LINES_MAX:
        raise InputFileError(
            path, lines[0][0] if lines else 1, GivewayError("lines", max(0, len(lines) - 1), "2 or more")
        )
    try:
        where, titles, scales = _columns(lines[0][1])
    except GivewayError as error:
        raise InputFileError(path, lines[0][0], error) from None
    check_widths(path, lines)
    forces: dict[tuple[float, float], _Cell] = {}
    for line, row in lines[1:]:
        try:
            travel, speed, force = (number_of(titles[name], row[where[name]]) * scales[name] for name in _COLUMNS)
            if travel < 0.0:
                raise GivewayError(titles["travel"], row[where["travel"]], "0, full extension, or more")
            if force < 0.0:
                raise GivewayError(titles["force"], row[where["force"]], "0 or more: a bumper only pushes")
            if (travel, speed) in forces:
                allowed = f"one line for each travel and speed: line {forces[travel, speed].line} has it, too"
                raise GivewayError(titles["travel"], row[where["travel"]], allowed)
        except GivewayError as error:
            raise InputFileError(path, line, error) from None
        forces[travel, speed] = _Cell(line, row[where["force"]], force)
    return _table(path, lines[0][0], titles, forces)


def _columns(head: Sequence[str]) -> tuple[dict[str, int], dict[str, str], dict[str, float]]:
    """Places, titles and factors to our units of the three columns."""
    where: dict[str, int] = {}
    titles: dict[str, str] = {}
    scales: dict[str, float] = {}
    for position, cell in enumerate(head, 1):
        name, unit = head_parts(cell) or ("", None)
        if unit is None or name not in _COLUMNS or name in where:
            raise GivewayError(
                f"column {position}", cell or "nothing", "travel [mm], speed [mm/s] and force [N], once each"
            )
        where[name], titles[name] = position - 1, title_of(position, name, unit)
        scales[name] = factor(titles[name], unit, _COLUMNS[name])
    for name, unit in _COLUMNS.items():
        if name not in where:
            raise GivewayError("columns", ", ".join(head), f"a column {name} [{unit}], too")
    return where, titles, scales


def _table(path: Path, head: int, titles: Mapping[str, str], forces: Mapping[tuple[float, float], _Cell]) -> ForceTable:
    """The grid of all that was read, checked and made to fit."""
    travels, speeds = (sorted({key[k] for key in forces}) for k in (0, 1))

    def wrong(line: int, column: str, value: object, allowed: str) -> InputFileError:
        return InputFileError(path, line, GivewayError(titles[column], value, allowed))

    first = min((cell.line for (travel, _), cell in forces.items() if travel == travels[0]), default=head)
    if travels[0] > 0.0 or len(travels) < 2:
        raise wrong(first, "travel", travels[0], "0 m, full extension, first, and others")
    for travel, speed in itertools.product(travels, speeds):
        if (travel, speed) not in forces:
            raise wrong(
                head, "force", f"nothing at {travel:g} m and {speed:g} m/s", "a force for each travel and speed"
            )
    for travel in travels:
        for slower, faster in itertools.pairwise(speeds):
            less, more = forces[travel, slower], forces[travel, faster]
            if more.number < less.number:
                allowed = f"at least {less.text}, that of line {less.line} at a lower speed: it would create energy"
                raise wrong(more.line, "force", more.text, allowed)
    if speeds[-1] < 0.0:
        raise wrong(head, "speed", speeds[-1], "0 or more: the force while it is compressed")
    grid = [[forces[travel, speed].number for speed in speeds] for travel in travels]
    if 0.0 not in speeds:
        grid, speeds = _with_rest(grid, speeds)
    rows, columns = _room()
    if len(speeds) > columns:
        raise wrong(head, "speed", f"{len(speeds)} speeds, with 0", f"at most {columns}")
    kept, residual = _thinned(travels, grid, rows)
    greatest = max(map(max, grid))
    if residual > THINNED * greatest:
        allowed = (
            f"at most {rows} travels, or such that {rows} of them are within {THINNED:.0%}: {residual:.3g} N are left"
        )
        raise wrong(head, "travel", f"{len(travels)} travels", allowed)
    return ForceTable(tuple(travels[i] for i in kept), tuple(speeds), tuple(tuple(grid[i]) for i in kept), residual)


def _with_rest(grid: list[list[float]], speeds: list[float]) -> tuple[list[list[float]], list[float]]:
    """The force at speed 0, where it was not measured."""
    after = next(j for j, speed in enumerate(speeds) if speed > 0.0)
    share = 1.0 if after == 0 else speeds[after - 1] / (speeds[after - 1] - speeds[after])
    new = [
        [
            *row[:after],
            row[after] if after == 0 else row[after - 1] + share * (row[after] - row[after - 1]),
            *row[after:],
        ]
        for row in grid
    ]
    return new, [*speeds[:after], 0.0, *speeds[after:]]


def _thinned(travels: Sequence[float], grid: Sequence[Sequence[float]], most: int) -> tuple[list[int], float]:
    """The travels to keep, one after the other where the lines between the others are off most; and by how much."""
    kept = [0, len(travels) - 1]
    while True:
        worst, where = 0.0, -1
        for i, travel in enumerate(travels):
            if i in kept:
                continue
            low = max(k for k in kept if k < i)
            high = min(k for k in kept if k > i)
            share = (travel - travels[low]) / (travels[high] - travels[low])
            off = max(abs(a + share * (b - a) - c) for a, b, c in zip(grid[low], grid[high], grid[i], strict=True))
            if off > worst:
                worst, where = off, i
        if where < 0 or len(kept) == most:
            return kept, worst
        kept = sorted([*kept, where])
