"""Temporary folders that go: at the end of this process, or, if it is killed, when the next one makes one."""

from __future__ import annotations

import atexit
import contextlib
import os
import shutil
import sys
import tempfile
from pathlib import Path

from giveway.base import system
from giveway.base.errors import WriteError

__all__ = ["temporary_folder"]

_PREFIX = "giveway-unpacked-"
_UNLOCKED = "giveway-new-"  # until it is locked it has another name, so that nobody takes it for a dead one's


def temporary_folder() -> Path:
    """A new folder; those that killed processes left behind are removed.

    A process holds a lock on its folders, which ends with it however it ends. On Windows, where folders cannot be
    locked, those of killed processes stay.
    """
    parent = Path(tempfile.gettempdir())
    if sys.platform != "win32":
        _remove_abandoned(parent)
    try:
        folder = Path(tempfile.mkdtemp(prefix=_UNLOCKED))
        if sys.platform != "win32":
            with contextlib.suppress(
                OSError
            ):  # a disk without locks, where nobody can tell: there a killed one's stays
                _lock(folder)  # open until the end of the process
        folder = folder.rename(parent / folder.name.replace(_UNLOCKED, _PREFIX, 1))
    except OSError as error:
        raise WriteError(parent, error) from error
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _remove_abandoned(parent: Path) -> None:
    with contextlib.suppress(OSError):
        for folder in parent.glob(f"{_PREFIX}*"):
            with contextlib.suppress(OSError):  # it is in use, somebody else's, or gone
                if folder.lstat().st_uid == os.getuid():
                    lock = _lock(folder)
                    shutil.rmtree(folder, ignore_errors=True)
                    os.close(lock)


def _lock(folder: Path) -> int:
    """A descriptor that holds the lock; OSError if another process has it, or if this is no folder."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        system.lock(descriptor)
    except OSError:
        os.close(descriptor)
        raise
    return descriptor
