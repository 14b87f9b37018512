"""Writing so that nothing half-written is ever seen: a temporary name first, then one rename."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from giveway.errors import FileError

__all__ = ["check_file", "check_output", "read_json", "replace_file", "replace_folder", "write_text"]

MARKERS = ("manifest.json", "summary.json", "drivetrain.json", "table.json")


def read_json(path: Path, schema_version: int, hint: str) -> dict[str, Any]:
    """The object in a JSON file of this schema version; FileError says what is wrong, ``hint`` what to give instead."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise FileError(path, "no such file", hint) from None
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise FileError(path, f"cannot be read: {error}") from None
    found = document.get("schema_version") if isinstance(document, dict) else None
    if found != schema_version:
        raise FileError(path, f"schema_version is {found}", f"this version reads {schema_version}")
    assert isinstance(document, dict)
    return document


def check_output(folder: Path) -> None:
    """Refuse, before any work is done, a folder that `replace_folder` could not or should not replace."""
    if folder.exists():
        if not folder.is_dir():
            raise FileError(folder, "is a file", "give a folder to write to")
        if any(folder.iterdir()) and not any((folder / marker).is_file() for marker in MARKERS):
            raise FileError(folder, "is not empty and holds no giveway result", "give a new or an empty folder")
    _check_parent(folder)


def check_file(path: Path) -> None:
    """Refuse, before any work is done, a file that `replace_file` could not write."""
    if path.exists() and not path.is_file():
        raise FileError(path, "is not a file", "give a file to write to")
    _check_parent(path)


def _existing_parent(path: Path) -> Path:
    """The nearest folder above ``path`` that is there."""
    parent = path.absolute().parent
    while not parent.exists():
        parent = parent.parent
    return parent


def _check_parent(path: Path) -> None:
    parent = _existing_parent(path)
    if not parent.is_dir() or not os.access(parent, os.W_OK):
        raise FileError(path, f"cannot be written: {parent} is not a writable folder")


@contextmanager
def replace_file(path: Path) -> Iterator[Path]:
    """A file of the same ending that takes the place of ``path`` when the block ends without an exception."""
    check_file(path)
    with tempfile.TemporaryDirectory(prefix=f".{path.name}-", dir=_existing_parent(path)) as folder:
        temporary = Path(folder) / path.name
        yield temporary
        _sync(temporary)
        path.absolute().parent.mkdir(parents=True, exist_ok=True)
        temporary.replace(path)


@contextmanager
def replace_folder(folder: Path) -> Iterator[Path]:
    """A temporary folder beside ``folder`` that takes its place when the block ends without an exception.

    Parents that had to be made are removed again if the block fails.
    """
    check_output(folder)
    made = [parent for parent in folder.absolute().parents if not parent.exists()]
    try:
        folder.absolute().parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.absolute().parent))
    except OSError as error:
        raise FileError(folder, f"cannot be written: {error.strerror}") from None
    try:
        temporary.chmod(0o755)
        yield temporary
        _swap(temporary, folder)
    except BaseException:
        shutil.rmtree(temporary, ignore_errors=True)
        for parent in made:
            if parent.is_dir() and not any(parent.iterdir()):
                parent.rmdir()
        raise


def _swap(temporary: Path, folder: Path) -> None:
    for path in temporary.rglob("*"):
        if path.is_file():
            _sync(path)
    if not folder.exists() or not any(folder.iterdir()):
        temporary.replace(folder)  # onto an empty folder, too: one atomic rename
        return
    old = Path(tempfile.mkdtemp(prefix=f".{folder.name}-old-", dir=folder.absolute().parent))
    folder.replace(old)
    temporary.replace(folder)
    shutil.rmtree(old, ignore_errors=True)


def write_text(path: Path, text: str) -> None:
    """Write ``text`` to ``path`` atomically (UTF-8)."""
    handle, name = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.absolute().parent)
    temporary = Path(name)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            stream.write(text)
        temporary.chmod(0o644)
        _sync(temporary)
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _sync(path: Path) -> None:
    with path.open("rb") as stream:
        os.fsync(stream.fileno())
