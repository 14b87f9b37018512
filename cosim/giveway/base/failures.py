"""Unexpected errors as one line; the traceback goes to a file that the line names."""

from __future__ import annotations

import contextlib
import os
import platform
import shlex
import sys
import tempfile
import traceback
from collections.abc import Sequence
from pathlib import Path

from giveway.base.errors import one_line, system_words
from giveway.base.version import VERSION

__all__ = ["DEBUG_VARIABLE", "unforeseen"]

DEBUG_VARIABLE = "GIVEWAY_DEBUG"


def unforeseen(error: Exception, arguments: Sequence[str]) -> str:
    """One line about an unexpected ``error``; writes a file with the traceback."""
    details = _write_details(error, arguments)
    where = f"`giveway --debug` or {DEBUG_VARIABLE}=1 shows the traceback" if details is None else f"details: {details}"
    return one_line(f"{_words(error)}; {where}")


def _words(error: Exception) -> str:
    if isinstance(error, MemoryError):
        return "out of memory"
    if isinstance(error, OSError) and error.errno is not None:
        return f"{error.filename}: {system_words(error)}" if error.filename else system_words(error)
    return f"unexpected {type(error).__name__}: {error}" if str(error) else f"unexpected {type(error).__name__}"


def _write_details(error: Exception, arguments: Sequence[str]) -> Path | None:
    """The file with details about the cause; None if it cannot be written."""
    text = "\n".join([
        f"giveway {VERSION}, Python {sys.version}, {platform.platform()}",
        f"giveway {shlex.join(arguments)}",
        "",
        "".join(traceback.format_exception(error)),
    ])  # fmt: skip
    for place in (_temporary_folder, _cache_folder):
        with contextlib.suppress(OSError, RuntimeError):  # RuntimeError: the home folder is unknown
            handle, name = tempfile.mkstemp(prefix="giveway-failure-", suffix=".txt", dir=place())
            try:
                with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace") as file:
                    file.write(text)
            except OSError:
                Path(name).unlink()
                raise
            return Path(name)
    return None


def _temporary_folder() -> Path:
    return Path(tempfile.gettempdir())


def _cache_folder() -> Path:
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "giveway"
    folder.mkdir(parents=True, exist_ok=True)
    return folder
