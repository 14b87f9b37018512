"""What firmware is made of, as one number: who asks a board can tell whether it runs the right one."""

from __future__ import annotations

import functools
import hashlib

import numpy as np

from giveway.firmware.core import core_files
from giveway.firmware.settings import Settings

__all__ = ["firmware_digest"]


def firmware_digest(settings: Settings) -> str:
    """16 hexadecimal digits of the C library's sources and of every bit of the configuration."""
    hashed = hashlib.sha256(_core_hash())
    for setting in settings.all():
        value = np.float32(setting.value) if setting.variable.type == "real" else np.uint32(setting.value)
        hashed.update(f"{setting.variable.c_core} {value.tobytes().hex()}\n".encode())
    return hashed.hexdigest()[:16]


@functools.cache
def _core_hash() -> bytes:
    hashed = hashlib.sha256()
    for name, content in sorted(core_files().items()):
        hashed.update(f"{name} {len(content)}\n".encode() + content)
    return hashed.digest()
