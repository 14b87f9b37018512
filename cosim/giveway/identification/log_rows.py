"""The columns of a log file by their names, as numbers, with the line or row that each number stands in."""

from __future__ import annotations

import csv
import io
import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from giveway.base.errors import FileError
from giveway.base.parquet import open_parquet, read_table

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["CsvRows", "LogRows", "ParquetRows", "read_rows"]

ROWS_MIN = 10  # a shorter file is wrong; the fit decides whether a log is long enough
READ = "a log as CSV or Parquet (`giveway run --log` writes both)"


class LogRows(ABC):
    """What is in a log file.

    Attributes:
        path: of the file.
        header: names of its columns.
    """

    word = "row"
    head = "the columns"

    def __init__(self, path: Path, header: list[str]) -> None:
        self.path, self.header = path, header

    def refuse(self, number: int, reason: str) -> NoReturn:
        """FileError with line or row ``number``."""
        raise FileError(self.path, f"{self.word} {number}: {reason}")

    def values(self, columns: Sequence[int]) -> tuple[NDArray[np.float64], list[int]]:
        """The wanted ``columns``, shape (n, columns), finite, and the number in the file of each of the n rows."""
        values, numbers = self._read(columns)
        if len(values) < ROWS_MIN:
            raise FileError(self.path, f"has {len(values)} {self.word}s of data", f"a log needs at least {ROWS_MIN}")
        return values, numbers

    @abstractmethod
    def _read(self, columns: Sequence[int]) -> tuple[NDArray[np.float64], list[int]]:
        """As `values`, from the file, however few rows it has."""


class CsvRows(LogRows):
    """A CSV file with a header line, and comment lines above it."""

    word = "line"

    def __init__(self, path: Path, content: bytes) -> None:
        try:
            self._lines = content.decode("utf-8-sig").splitlines()
        except UnicodeDecodeError:
            raise FileError(path, "cannot be read: it is no text", f"give {READ}") from None
        comments = sum(1 for _ in itertools.takewhile(lambda line: line.startswith("#"), self._lines))
        self._first = comments + 1
        self.head = f"line {self._first}"
        super().__init__(path, next(csv.reader(self._lines[comments : self._first]), []))

    def _read(self, columns: Sequence[int]) -> tuple[NDArray[np.float64], list[int]]:
        import numpy as np

        table: list[list[float]] = []
        numbers: list[int] = []
        for number, line in enumerate(self._lines[self._first :], self._first + 1):
            if not line.strip():
                continue
            row = next(csv.reader([line]))
            if len(row) <= max(columns):
                needs = f"{self.header[columns[-1]].strip()} and others need {max(columns) + 1}"
                self.refuse(number, f"{len(row)} values, but {needs}")
            for column in columns:
                if not _is_finite(row[column]):
                    text = row[column].strip() or "empty"
                    self.refuse(number, f"{self.header[column].strip()} is {text}, not a finite number")
            table.append([float(row[column]) for column in columns])
            numbers.append(number)
        return np.array(table), numbers


class ParquetRows(LogRows):
    """A Parquet file, such as `giveway run --log` writes."""

    def __init__(self, path: Path, content: bytes) -> None:
        import pyarrow

        try:
            self._table = read_table(open_parquet(io.BytesIO(content)))
        except (OSError, pyarrow.ArrowException) as error:
            raise FileError(path, f"cannot be read: {error}", f"give {READ}") from None
        super().__init__(path, [_head(field) for field in self._table.schema])

    def _read(self, columns: Sequence[int]) -> tuple[NDArray[np.float64], list[int]]:
        import numpy as np
        import pyarrow

        found = []
        for column in columns:
            try:
                values = self._table.column(column).cast(pyarrow.float64()).to_numpy()  # a missing value is nan
            except pyarrow.ArrowException:
                kind = self._table.schema[column].type
                raise FileError(self.path, f"column {self.header[column]} has {kind}", "allowed: numbers") from None
            wrong = np.flatnonzero(~np.isfinite(values))
            if wrong.size:
                text = f"{self.header[column]} is {values[wrong[0]]}, not a finite number"
                self.refuse(int(wrong[0]) + 1, text)
            found.append(values)
        return np.stack(found, axis=1), list(range(1, len(found[0]) + 1))


def read_rows(path: Path, content: bytes) -> LogRows:
    """The rows of ``path``, whose ``content`` was read; by the ending of its name they are Parquet or CSV."""
    return ParquetRows(path, content) if path.suffix in (".parquet", ".pq") else CsvRows(path, content)


def _head(field: Any) -> str:
    """As a CSV file has it; the unit of a Parquet column may stand beside its name."""
    unit = (field.metadata or {}).get(b"units", b"").decode()
    return field.name if unit in ("", "1") else f"{field.name} [{unit}]"


def _is_finite(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
