"""Errors a user can act on: each names the field, the value found and what is allowed, in one line."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable
from pathlib import Path

__all__ = [
    "ClusterError",
    "FileError",
    "GivewayError",
    "InputFileError",
    "NativeMissingError",
    "SimulationError",
    "UnknownNameError",
    "WriteError",
    "one_line",
    "system_words",
]

_MAX_LISTED = 12


class GivewayError(Exception):
    """An input of giveway is not usable.

    Attributes:
        field: what is wrong, as the user wrote it (``testbed.slider.mass``, ``--bumper``).
        value: the value found.
        allowed: the accepted values, in words.
    """

    def __init__(self, field: str, value: object, allowed: str) -> None:
        super().__init__(field, value, allowed)
        self.field = field
        self.value = value
        self.allowed = allowed

    def __str__(self) -> str:
        return one_line(f"{self.field}: {self.value} is not allowed; allowed: {self.allowed}")


class UnknownNameError(GivewayError):
    """A name that does not exist; the message offers the nearest ones that do."""

    def __init__(self, field: str, value: str, known: Iterable[str]) -> None:
        names = sorted(known)
        nearest = nearest_names(value, names)
        allowed = ", ".join(names) if len(names) <= _MAX_LISTED else f"one of {len(names)} names"
        super().__init__(field, value, allowed)
        self.nearest = nearest

    def __str__(self) -> str:
        hint = f"; did you mean {' or '.join(self.nearest)}?" if self.nearest else ""
        return one_line(f"{self.field}: {self.value} is unknown; allowed: {self.allowed}{hint}")


class FileError(GivewayError):
    """A file or folder that cannot be read, written or understood."""

    def __init__(self, path: Path | str, reason: str, allowed: str = "") -> None:
        super().__init__(str(path), reason, allowed)

    def __str__(self) -> str:
        hint = f"; {self.allowed}" if self.allowed else ""
        return one_line(f"{self.field}: {self.value}{hint}")


class WriteError(FileError):
    """A file or folder could not be written during the work: the disk is full, a limit is reached, or it was removed.

    Attributes:
        path: the file or folder to be written.
        cause: the system's message.
    """

    def __init__(self, path: Path | str, cause: OSError, hint: str = "") -> None:
        super().__init__(path, f"cannot be written: {system_words(cause)}", hint)
        self.path, self.cause = Path(path), cause


class ClusterError(FileError):
    """Machines that should help cannot do so any more."""


class InputFileError(GivewayError):
    """An unusable value in a file: the message begins with file and line.

    Attributes:
        path, line: its position; lines count from 1.
        cause: the error at this position.
    """

    def __init__(self, path: Path | str, line: int, cause: GivewayError) -> None:
        super().__init__(cause.field, cause.value, cause.allowed)
        self.path, self.line, self.cause = Path(path), line, cause

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.cause}"


class NativeMissingError(GivewayError):
    """The FMUs and tables that belong to the package were not found."""

    def __init__(self, name: str, installed: Path, environment: str) -> None:
        super().__init__(name, "not found", f"{installed} or {environment}")

    def __str__(self) -> str:
        return one_line(
            f"{self.field} was not found in the installed package ({self.allowed}); "
            "install the wheel or set GIVEWAY_NATIVE_DIR to the folder that `make fmus` wrote"
        )


class SimulationError(GivewayError):
    """An FMU refused its parameters or failed in a step.

    Attributes:
        time_s: simulated time of the failure in seconds.
    """

    def __init__(self, instance: str, reason: str, time_s: float) -> None:
        super().__init__(instance, reason, "")
        self.time_s = time_s

    def __str__(self) -> str:
        return one_line(f"{self.field} at t = {self.time_s:.6g} s: {self.value}")


def nearest_names(name: str, known: Iterable[str]) -> list[str]:
    """Up to three names of ``known`` that look like ``name``."""
    return difflib.get_close_matches(name, list(known), n=3, cutoff=0.6)


def system_words(error: OSError) -> str:
    """The system's text for ``error``, without number and file: "No space left on device"."""
    return os.strerror(error.errno) if error.errno else str(error)


def one_line(text: str) -> str:
    """``text`` with all white space collapsed to single spaces."""
    return " ".join(text.split())
