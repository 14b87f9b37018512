"""Reads a user's TOML file key by key: every error names the key, the value found and the allowed values."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from giveway.base.checks import finite
from giveway.base.errors import FileError, GivewayError, InputFileError, UnknownNameError
from giveway.base.shapes import Rows, Table, Variants
from giveway.base.toml_lines import line_of

__all__ = ["Section", "lines_named", "read_toml", "renamed"]


def read_toml(path: Path, hint: str) -> tuple[str, dict[str, Any]]:
    """Text and document of the file ``path``; ``hint``: what to give if there is no such file.

    A byte order mark, which some editors of Windows write, is left out.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise FileError(path, "no such file", hint) from None
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(path, f"cannot be read: {error}") from None
    try:
        return text, tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputFileError(path, *_syntax(text, str(error))) from None


@contextmanager
def lines_named(path: Path, text: str) -> Iterator[None]:
    """Adds the line to errors about a key of the file ``path``."""
    try:
        yield
    except (FileError, InputFileError):
        raise  # about another file, which it names
    except GivewayError as error:
        raise InputFileError(path, line_of(text, error.field), error) from None


def _syntax(text: str, message: str) -> tuple[int, GivewayError]:
    """Line and cause of tomllib's error."""
    found = re.search(r" \(at (?:line (\d+), column \d+|end of document)\)", message)
    if found is None:
        return 1, FileError("not TOML", message)
    line = int(found[1]) if found[1] else max(1, len(text.splitlines()))
    return line, FileError("not TOML", message[: found.start()])


@contextmanager
def renamed(section: str, **names: str) -> Iterator[None]:
    """Renames errors of functions that get the file's values, with the names of the file."""
    try:
        yield
    except GivewayError as error:
        key = error.field.rpartition(".")[2] if error.field not in names else error.field
        if key in names:
            error.field = f"{section}.{names[key]}" if section else names[key]
        raise


class Section:
    """One table of the file; errors of every reader name the key, the value found and the allowed values."""

    def __init__(self, name: str, values: Any, known: Sequence[str] | Table | None) -> None:
        """``known``: the keys it may have; with their shapes, by which the values are checked; None: any."""
        if not isinstance(values, dict):
            raise GivewayError(name, values, "a table")
        self.name, self.values = name, values
        self._shapes = known.keys if isinstance(known, Table) else {}
        keys = known.keys if isinstance(known, Table) else known
        if keys is not None:
            for key in values:
                if key not in keys:
                    raise UnknownNameError(self.full(key), key, keys)
        for key, shape in self._shapes.items():
            if key in values:
                shape.check(self.full(key), values[key])

    def full(self, key: str) -> str:
        return f"{self.name}.{key}" if self.name else key

    def table(self, key: str, known: Sequence[str] | None = None) -> Section | None:
        """The table at ``key``, None if it is not there; ``known``: its keys, where no shape has them."""
        if key not in self.values:
            return None
        name, values, shape = self.full(key), self.values[key], self._shapes.get(key)
        if isinstance(shape, Variants):
            word = Section(name, values, None).choice(shape.key, shape.tables)
            return Section(name, values, shape.table(word))
        return Section(name, values, shape if isinstance(shape, Table) else known)

    def rows(self, key: str) -> list[Section]:
        """The tables ``[[key]]``."""
        shape, entries = self._shapes[key], self.values.get(key, [])
        assert isinstance(shape, Rows)
        if not isinstance(entries, list):
            raise GivewayError(self.full(key), entries, f"one or more [[{key}]]")
        return [Section(f"{self.full(key)}[{index}]", entry, shape.row) for index, entry in enumerate(entries)]

    def whole(self, key: str, default: int) -> int:
        """A whole number, whose shape has its range."""
        return int(self.values.get(key, default))

    def required(self, key: str, allowed: str) -> Any:
        if key not in self.values:
            raise GivewayError(self.full(key), "nothing", f"{allowed}; it is needed")
        return self.values[key]

    def number(self, key: str, default: float | None = None) -> float:
        if key not in self.values and default is not None:
            return default
        return finite(self.full(key), self.required(key, "a finite number"))

    def angle(self, key: str, default_rad: float | None = None) -> float:
        """Degrees in the file, rad here."""
        if key not in self.values and default_rad is not None:
            return default_rad
        found = self.required(key, "a number from -360 to 360 deg")
        return math.radians(finite(self.full(key), found, -360.0, 360.0, "deg"))

    def pair(self, key: str, default: tuple[float, float] | None = None) -> tuple[float, float]:
        if key not in self.values and default is not None:
            return default
        found = self.required(key, "two numbers, [x, y] in m")
        if not isinstance(found, list) or len(found) != 2:
            raise GivewayError(self.full(key), found, "two numbers, [x, y] in m")
        x, y = (finite(self.full(key), value) for value in found)
        return x, y

    def flag(self, key: str, default: bool) -> bool:
        found = self.values.get(key, default)
        if not isinstance(found, bool):
            raise GivewayError(self.full(key), found, "true or false")
        return found

    def text(self, key: str, default: str | None = None) -> str:
        found = self.values.get(key, default)
        if not isinstance(found, str):
            raise GivewayError(self.full(key), found, "a text in quotes")
        return found

    def choice(self, key: str, known: Sequence[str] | Mapping[str, Any], default: str | None = None) -> str:
        if key not in self.values and default is None:
            self.required(key, ", ".join(known))
        found = self.text(key, default)
        if found not in known:
            raise UnknownNameError(self.full(key), found, known)
        return found
