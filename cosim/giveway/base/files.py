"""Atomic writing: first under a temporary name, then one rename, so that no partial file is ever visible."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from giveway.base.errors import FileError, WriteError, system_words

__all__ = [
    "check_file",
    "check_output",
    "make_scratch_folder",
    "read_json",
    "remove_folder",
    "replace_file",
    "replace_files",
    "replace_folder",
    "scratch_folder",
    "write_text",
]

MARKERS = ("manifest.json", "summary.json", "drivetrain.json", "table.json")


def read_json(path: Path, schema_version: int, hint: str) -> dict[str, Any]:
    """The object in a JSON file of this schema version; FileError names the fault, ``hint`` what to give instead."""
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
    with _looking_at(folder):
        if folder.exists():
            if not folder.is_dir():
                raise FileError(folder, "is a file", "give a folder to write to")
            if any(folder.iterdir()) and not any((folder / marker).is_file() for marker in MARKERS):
                raise FileError(folder, "is not empty and holds no giveway result", "give a new or an empty folder")
        _check_parent(folder)


def check_file(path: Path) -> None:
    """Refuse, before any work is done, a file that `replace_file` could not write."""
    with _looking_at(path):
        if path.exists() and not path.is_file():
            raise FileError(path, "is not a file", "give a file to write to")
        _check_parent(path)


def _existing_parent(path: Path) -> Path:
    """The nearest existing folder above ``path``."""
    parent = path.absolute().parent
    while not parent.exists():
        parent = parent.parent
    return parent


@contextmanager
def _looking_at(path: Path) -> Iterator[None]:
    """Errors of the system when it reads a path (no permission, name too long) name ``path``."""
    try:
        yield
    except OSError as error:
        raise FileError(path, f"cannot be written: {system_words(error)}") from None


def _check_parent(path: Path) -> None:
    parent = _existing_parent(path)
    try:
        with tempfile.TemporaryFile(dir=parent):  # permissions are not sufficient: it may be a read-only disk, or /proc
            pass
    except OSError as error:
        words = f"cannot be written: {parent} is not a writable folder ({system_words(error)})"
        raise FileError(path, words) from None


@contextmanager
def _writing(path: Path, temporary: Path | None = None) -> Iterator[None]:
    """Disk errors in ``path`` or ``temporary`` name ``path``; other errors pass unchanged."""
    try:
        yield
    except OSError as error:
        where = error.filename
        if isinstance(where, str) and temporary is not None and not Path(where).is_relative_to(temporary):
            raise
        raise WriteError(path, error) from error
    except WriteError as error:
        if temporary is None or not error.path.is_relative_to(temporary):
            raise
        raise WriteError(path, error.cause) from error


def remove_folder(folder: Path) -> None:
    """Remove a folder as far as possible; Ctrl-C meanwhile stays Ctrl-C.

    `shutil.rmtree`, interrupted while it closes a descriptor, closes it again. That fails in spite of `ignore_errors`,
    and the error would take the place of the interrupt.
    """
    try:
        shutil.rmtree(folder, ignore_errors=True)
    except OSError as error:
        interrupt = error.__context__
        if not isinstance(interrupt, KeyboardInterrupt):
            raise
        shutil.rmtree(folder, ignore_errors=True)  # what is left
        raise interrupt from None


def make_scratch_folder(prefix: str) -> Path:
    """A new folder in the system's temporary folder; FileError if it cannot be made."""
    try:
        return Path(tempfile.mkdtemp(prefix=prefix))
    except OSError as error:
        raise FileError(tempfile.gettempdir(), f"cannot be written: {error.strerror}") from None


@contextmanager
def scratch_folder(prefix: str) -> Iterator[Path]:
    """The same for the length of a block."""
    folder = make_scratch_folder(prefix)
    try:
        yield folder
    finally:
        remove_folder(folder)


@contextmanager
def replace_file(path: Path) -> Iterator[Path]:
    """A file of the same ending that takes the place of ``path`` when the block ends without an exception."""
    with replace_files(path) as (temporary,):
        yield temporary


@contextmanager
def replace_files(*paths: Path) -> Iterator[tuple[Path, ...]]:
    """Files of the same endings that take the places of ``paths``, all of them, if the block ends without an exception.

    Raises:
        FileError: one of them could not be written; nothing was done yet.
        WriteError: writing failed during the work; ``paths`` are unchanged.
    """
    for path in paths:
        check_file(path)
    with ExitStack() as folders:
        temporary = []
        for path in paths:
            with _writing(path):
                folder = Path(tempfile.mkdtemp(prefix=f".{path.name}-", dir=_existing_parent(path)))
            folders.callback(remove_folder, folder)
            temporary.append(folder / path.name)
            folders.enter_context(_writing(path, folder))
        yield tuple(temporary)
        # When all of them are on the disk, only renames remain.
        for new, path in zip(temporary, paths, strict=True):
            with _writing(path):
                _sync(new)
                path.absolute().parent.mkdir(parents=True, exist_ok=True)
        for new, path in zip(temporary, paths, strict=True):
            with _writing(path):
                new.replace(path)


@contextmanager
def replace_folder(folder: Path) -> Iterator[Path]:
    """A temporary folder next to ``folder`` that replaces it when the block ends without an exception.

    Parent folders made for it are removed again if the block fails.

    Raises:
        FileError: it could not be written, or holds something else; nothing was done yet.
        WriteError: writing failed during the work; ``folder`` is unchanged.
    """
    check_output(folder)
    made = [parent for parent in folder.absolute().parents if not parent.exists()]
    with _writing(folder):
        folder.absolute().parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.absolute().parent))
    try:
        with _writing(folder, temporary):
            temporary.chmod(0o755)
            yield temporary
        with _writing(folder):
            _swap(temporary, folder)
    except BaseException:
        remove_folder(temporary)
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
    remove_folder(old)


def write_text(path: Path, text: str) -> None:
    """Write ``text`` to ``path`` atomically (UTF-8; other bytes of a file name as in Python, ``\\udcfc``).

    Raises:
        WriteError: writing failed; ``path`` is unchanged.
    """
    with _writing(path):
        handle, name = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.absolute().parent)
    temporary = Path(name)
    try:
        with _writing(path):
            with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace") as stream:
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
