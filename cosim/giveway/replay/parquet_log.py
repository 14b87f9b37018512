"""Logs as Parquet: columns named as in CSV, or with their unit in the field's metadata (``units``)."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from giveway.base.csv_rows import head_parts
from giveway.base.errors import FileError
from giveway.base.parquet import open_parquet, read_batches
from giveway.replay.arrow_columns import numbers_of
from giveway.replay.source import Block, Head, Origin, parameters_of

__all__ = ["ORIGIN_KEY", "ParquetLog"]

BATCH_ROWS = 1 << 16
ORIGIN_KEY = b"giveway_log"
"""In the file's metadata: JSON with ``step_s`` and ``controller``, the parameters."""


class ParquetLog:
    """A Parquet file."""

    kind = "Parquet"

    def __init__(self, path: Path) -> None:
        import pyarrow

        self.path, self.said = path, list[str]()
        try:
            self._file = open_parquet(path.open("rb"))
        except FileNotFoundError:
            raise FileError(path, "no such file", "give the path of a log") from None
        except (OSError, pyarrow.ArrowException) as error:
            raise FileError(path, f"cannot be read: {error}") from None
        schema = self._file.schema_arrow
        self.heads = [_head(field) for field in schema]
        self._types = list(schema.types)
        self.origin = _origin(path, schema.metadata or {})

    def place(self, row: int) -> str:
        return f"row {row + 1}"

    def blocks(self, wanted: Sequence[int]) -> Iterator[Block]:
        import pyarrow

        for column in wanted:
            kind = self._types[column]
            numeric = pyarrow.types.is_floating(kind) or pyarrow.types.is_integer(kind)
            if not numeric and not pyarrow.types.is_boolean(kind):
                raise FileError(self.path, f"column {self.heads[column].name} is of type {kind}", "allowed: numbers")
        names = [self._file.schema_arrow.names[column] for column in wanted]
        row = 0
        try:
            for batch in read_batches(self._file, BATCH_ROWS, names):
                columns = [batch.column(batch.schema.get_field_index(name)) for name in names]
                values = np.stack([numbers_of(column.cast(pyarrow.float64())) for column in columns], axis=1)
                yield Block(values, row)
                row += len(values)
        except (OSError, pyarrow.ArrowException) as error:
            raise FileError(self.path, f"cannot be read: {error}") from None


def _head(field: Any) -> Head:
    unit = (field.metadata or {}).get(b"units")
    if unit is not None:
        return Head(field.name, unit.decode())
    parts = head_parts(field.name)
    return Head(field.name, None) if parts is None else Head(*parts)


def _origin(path: Path, metadata: dict[bytes, bytes]) -> Origin:
    if ORIGIN_KEY not in metadata:
        return Origin()
    try:
        stated = json.loads(metadata[ORIGIN_KEY])
        return Origin(parameters_of(path, stated["controller"]), float(stated["step_s"]))
    except (ValueError, KeyError, TypeError) as error:
        raise FileError(path, f"its metadata giveway_log cannot be read: {error}") from None
