"""The functions that an FMI 2 importer hands to an FMU."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

__all__ = ["fmi2_callbacks"]


def fmi2_callbacks(log: Callable[[Any, bytes, int, bytes, bytes], None]) -> Any:
    """FMPy's own callbacks, except for ``log`` (environment, instance, status, category, text).

    Messages have printf arguments; FMPy's native proxy formats them into the text. On processors that FMPy has no proxy
    for the text is the format alone.
    """
    from fmpy import fmi2

    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(log)
    callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
    callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
    try:
        from fmpy.logging import addLoggerProxy
    except OSError:  # Intel's processors and macOS have it
        return callbacks
    addLoggerProxy(ctypes.byref(callbacks))
    return callbacks
