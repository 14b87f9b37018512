"""Parts as tables: what a run had, what became of it, and what was measured."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import FileError
from giveway.base.parquet import open_parquet, read_table
from giveway.library.batch_library import STATUSES
from giveway.library.work import result_columns
from giveway.simulation.metric_names import former_name
from giveway.simulation.run_warnings import codes_of
from giveway.study.parts import part_sums

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.library.work import Done
    from giveway.simulation.run_warnings import Stated
    from giveway.study.runs import RunTable

__all__ = ["Outcomes", "column_of", "part_table", "read_part", "read_runs"]

NOT_CACHED = ("no memory", "cancelled")


class Outcomes:
    """What became of some runs: ``status`` and ``message`` (lists of n), ``numbers`` (n, `result_columns`)."""

    def __init__(self, count: int) -> None:
        self.status = ["cancelled"] * count
        self.message = [""] * count
        self.numbers = np.full((count, len(result_columns())), np.nan)

    def warnings(self, stated: Stated) -> list[str]:
        """What happened otherwise than ``stated``, the codes of each run as text; empty if a run failed."""
        columns = {name: self.numbers[:, j] for j, (name, _) in enumerate(result_columns())}
        found = codes_of(stated, columns)
        return [codes if status == "ok" else "" for codes, status in zip(found, self.status, strict=True)]

    def refuse(self, index: int, message: str) -> None:
        """Run ``index`` is refused."""
        self.status[index], self.message[index] = "refused", message
        self.numbers[index, :2] = 0.0

    def take(self, where: NDArray[np.int64], done: Done) -> None:
        """Enter what the library made of the runs ``where``."""
        self.numbers[where] = done.numbers
        for at, (index, status) in enumerate(zip(where.tolist(), done.status.tolist(), strict=True)):
            self.status[index], self.message[index] = STATUSES[status], done.messages.get(at, "")

    def take_stored(self, where: NDArray[np.int64], path: Path, rows: NDArray[np.int64]) -> None:
        """Enter the rows of a stored part for the runs ``where``."""
        names = [name for name, _ in result_columns()]
        table = read_part(path, ["status", "message", *names]).take(rows)
        self.numbers[where] = np.stack([column_of(table, name) for name in names], axis=1)
        statuses, messages = table["status"].to_pylist(), table["message"].to_pylist()
        for index, status, message in zip(where, statuses, messages, strict=True):
            self.status[index], self.message[index] = status, message

    def copy(self, where: NDArray[np.int64], source: NDArray[np.int64]) -> None:
        """Copy the outcomes of the runs ``source`` to the equal runs ``where``."""
        self.numbers[where] = self.numbers[source]
        for index, other in zip(where, source, strict=True):
            self.status[index], self.message[index] = self.status[other], self.message[other]


def part_table(
    table: RunTable,
    first: int,
    keys: list[bytes],
    outcomes: Outcomes,
    stated: Stated,
    derived: Mapping[str, tuple[NDArray[np.float64], str]],
) -> Any:
    """The pyarrow table of the runs from ``first`` on, which were asked to do what is ``stated``."""
    import pyarrow

    run = np.arange(first, first + len(keys))
    design, sample, case = table.split(run)
    names = [one.case.name for one in table.cases]
    columns: dict[str, tuple[Any, str]] = {
        "run": (run, ""),
        "design": (design, ""),
        "tolerance sample": (sample.astype(np.int32), ""),
        "collision": (pyarrow.array(np.array(names)[case]).dictionary_encode(), ""),
        "key": (pyarrow.array(keys, type=pyarrow.binary(len(keys[0]))), ""),
        "status": (pyarrow.array(outcomes.status).dictionary_encode(), ""),
        "message": (pyarrow.array(outcomes.message), ""),
        "warnings": (pyarrow.array(outcomes.warnings(stated)).dictionary_encode(), ""),
    }
    for j, one in enumerate(table.varied):
        values = table.designs[design, j]
        text = [one.quantity.text(value) for value in values] if one.quantity.kind == "choice" else values
        columns[one.quantity.name] = (text, one.quantity.unit)
    for name, (totals, unit) in part_sums(table.varied, table.designs[design]).items():
        columns[name] = (totals, unit)
    for j, tolerance in enumerate(table.tolerances):
        unit = "1" if tolerance.relative else tolerance.quantity.unit
        name = tolerance.quantity.name if tolerance.replaces else f"deviation of {tolerance.quantity.name}"
        columns[name] = (table.deviations[sample, j], unit)
    for name, j in table.robot_draws():
        columns[f"robot: {name}"] = (table.deviations[sample, j], "1")
    columns |= derived
    for j, (name, unit) in enumerate(result_columns()):
        columns[name] = (np.ascontiguousarray(outcomes.numbers[:, j]), unit)
    arrays = [pyarrow.array(values) for values, _ in columns.values()]
    fields = [
        pyarrow.field(name, array.type, metadata={"units": unit})
        for (name, (_, unit)), array in zip(columns.items(), arrays, strict=True)
    ]
    return pyarrow.table(arrays, schema=pyarrow.schema(fields, metadata={"schema_version": "1"}))


def read_runs(folder: Path, names: list[str]) -> dict[str, NDArray[np.float64]]:
    """Numbers of all stored runs of the study in ``folder``, in their order, by column."""
    from giveway.study.store import PARTS, list_parts, read_manifest

    parts = list_parts(folder / PARTS / read_manifest(folder)["fingerprint"][:16])
    tables = [read_part(path, names) for _, _, path in parts]
    return {name: np.concatenate([column_of(table, name) for table in tables]) for name in names}


def column_of(table: Any, name: str) -> NDArray[Any]:
    """Numbers of a pyarrow table, whose own way to them imports pandas: that takes longer than reading them."""
    chunks = table[name].chunks
    if not chunks or table[name].null_count:
        return np.asarray(table[name].to_numpy())
    return np.concatenate([np.from_dlpack(chunk) for chunk in chunks])


def read_part(path: Path, columns: list[str]) -> Any:
    """Some columns of a part as a pyarrow table; FileError if it cannot be read.

    A part may be older than the name of a metric: then its column is taken by the name that it had.
    """
    import pyarrow

    try:
        with path.open("rb") as file, open_parquet(file) as part:
            there = set(part.schema_arrow.names)
            stored = [name if name in there else former_name(name) or name for name in columns]
            return read_table(part, stored).select(stored).rename_columns(columns)
    except (OSError, KeyError, pyarrow.ArrowException) as error:
        raise FileError(path, f"cannot be read: {error}", "delete it; the same command makes it again") from None
