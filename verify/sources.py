"""Which sources were verified: one hash over the names and contents of c_core/include and c_core/src."""

from __future__ import annotations

import hashlib
from pathlib import Path

__all__ = ["core_files", "core_hash"]


def core_files(root: Path) -> list[Path]:
    """The files that a user copies."""
    return sorted(path for folder in ("include", "src") for path in (root / "c_core" / folder).rglob("*.[ch]"))


def core_hash(root: Path) -> str:
    total = hashlib.sha256()
    for path in core_files(root):
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        total.update(f"{path.relative_to(root).as_posix()} {content}\n".encode())
    return total.hexdigest()
