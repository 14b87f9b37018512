"""Benchmarks (`giveway bench`): one co-simulated second, collisions per second, integration methods."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from giveway.bench.co_simulation import Timing, measure

__all__ = ["Timing", "measure"]


def __getattr__(name: str) -> object:
    """Handed on when asked for: `command` is imported at every start, and has to be light."""
    if name in __all__:
        return getattr(importlib.import_module(f"{__name__}.co_simulation"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
