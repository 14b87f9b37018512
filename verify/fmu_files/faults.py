"""Faults planted in the commands; a trial has to see each of them."""

from __future__ import annotations

import dataclasses
import os
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

__all__ = ["FAULTS", "Fault"]


def _replace_check(name: str, function: Callable[[Any], Any]) -> None:
    import giveway.fmu_tools.check as checks

    changed = dataclasses.replace(checks.CHECKS[name], function=function)
    checks.CHECKS = {**checks.CHECKS, name: changed}


def _writes_outside() -> None:
    """A check unpacks archive members under their own names."""

    def unpacks(file: Any) -> Iterator[Any]:
        with tempfile.TemporaryDirectory() as folder:
            for info in file.archive.infos:
                try:
                    (Path(folder) / info.filename).write_bytes(b"")
                except (OSError, ValueError):
                    continue
        yield from ()

    _replace_check("layout", unpacks)


def _leaves_behind() -> None:
    """Temporary folders stay."""
    from giveway.base import files

    files.remove_folder = lambda folder: None


def _no_limits() -> None:
    """XML of any size is held in memory."""
    from giveway.fmu_tools import xml_files

    kept: list[bytes] = []
    xml_files.Budget.add_element = lambda _self: kept.append(bytes(1000))  # type: ignore[method-assign,assignment]


def _traceback() -> None:
    """A text is converted to a number without a check."""
    from giveway.fmu_tools import description

    description._Reader._number = lambda _self, text, *_: int(text)  # type: ignore[method-assign]


def _has_long_text(file: Any) -> bool:
    return any(len(text) > 1000 for variable in file.described().variables for text in variable.attributes.values())


def _hangs() -> None:
    """A check of a long text never ends."""

    def slow(file: Any) -> Iterator[Any]:
        if _has_long_text(file):
            while True:
                pass
        yield from ()

    _replace_check("variable names", slow)


def _crashes() -> None:
    """A long text ends the process."""

    def ends(file: Any) -> Iterator[Any]:
        if _has_long_text(file):
            os.abort()
        yield from ()

    _replace_check("variable names", ends)


@dataclass(frozen=True)
class Fault:
    """A fault: how it is planted, which kind of file shows it, and what the trial reports."""

    plant: Callable[[], None]
    kind: str
    shows: str


FAULTS = {
    "writes outside": Fault(_writes_outside, "entries", "written outside"),
    "leaves folders behind": Fault(_leaves_behind, "description", "left behind"),
    "reads without limits": Fault(_no_limits, "large description", "MB of memory"),
    "trusts numbers": Fault(_traceback, "description", "traceback: ValueError"),
    "hangs": Fault(_hangs, "description", "over 10 s"),
    "crashes": Fault(_crashes, "description", "ended with SIGABRT"),
}
