"""Parquet files are read in the calling thread alone.

pyarrow's own threads may still hold a Python file when the interpreter ends: then the process hangs or aborts
(apache/arrow, issues 33975 and 50482).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import IO, Any

__all__ = ["open_parquet", "read_batches", "read_table"]


def open_parquet(file: IO[bytes]) -> Any:
    """A ``pyarrow.parquet.ParquetFile``; its rows by `read_table` or `read_batches`."""
    import pyarrow.parquet

    return pyarrow.parquet.ParquetFile(file, pre_buffer=False)


def read_table(opened: Any, columns: Sequence[str] | None = None) -> Any:
    """All rows as a ``pyarrow.Table``."""
    return opened.read(columns=None if columns is None else list(columns), use_threads=False)


def read_batches(opened: Any, rows: int, columns: Sequence[str]) -> Iterator[Any]:
    """At most ``rows`` rows at a time, each a ``pyarrow.RecordBatch``."""
    yield from opened.iter_batches(rows, columns=list(columns), use_threads=False)
