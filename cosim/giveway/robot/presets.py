"""Presets: which reflex a controller has. Its variable table states both, as ``start`` and as ``paper``."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from giveway.base.errors import UnknownNameError
from giveway.robot.variables import Value, table

__all__ = ["DEFAULT", "NO_REFLEX", "PAPER", "PRESETS", "check_preset", "preset_values"]

DEFAULT, PAPER = "default", "paper"
PRESETS: Mapping[str, str] = MappingProxyType(
    {
        DEFAULT: "two channels on measured motion and the rollers' bristles; an escape that keeps the wheels down",
        PAPER: "the paper's: planned motion, friction (28), leaky impulse, frozen impulse",
    }
)
"""Name to what it is."""

NO_REFLEX: Mapping[str, Value] = MappingProxyType({"detector.kind": 1, "detector.impulse_threshold": 1000.0})
"""A controller that never reacts, in any preset."""


def check_preset(preset: str, field: str = "preset") -> None:
    """UnknownNameError, which names ``field``, if there is no such preset."""
    if preset not in PRESETS:
        raise UnknownNameError(field, preset, PRESETS)


def preset_values(preset: str, model: str = "controller") -> dict[str, Value]:
    """The parameters of ``model`` that ``preset`` does not leave at their start values."""
    check_preset(preset)
    if preset == DEFAULT:
        return {}
    return {v.name: v.paper for v in table(model).select("parameter") if v.paper is not None}
