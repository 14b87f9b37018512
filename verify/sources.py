"""Which sources were verified: one hash over names and contents of files."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

__all__ = ["CORE", "SCALARS", "core_files", "core_hash", "subject_hash"]

CORE = ("c_core/include/**/*.[ch]", "c_core/src/**/*.[ch]")
"""The files that a user copies."""
SCALARS = ("c_core/include/giveway/gw_math.h", "c_core/include/giveway/gw_types.h", "c_core/src/gw_math.c")
"""The scalar functions, with all headers that they include."""


def core_files(root: Path) -> list[Path]:
    """The files that a user copies."""
    return _files(root, CORE)


def core_hash(root: Path) -> str:
    return subject_hash(root, CORE)


def subject_hash(root: Path, subject: Iterable[str]) -> str:
    """Of the files below ``root`` that match these patterns."""
    total = hashlib.sha256()
    for path in _files(root, subject):
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        total.update(f"{path.relative_to(root).as_posix()} {content}\n".encode())
    return total.hexdigest()


def _files(root: Path, subject: Iterable[str]) -> list[Path]:
    return sorted({path for pattern in subject for path in root.glob(pattern) if path.is_file()})
