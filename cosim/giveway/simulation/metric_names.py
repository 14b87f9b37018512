"""Former names of metrics: they still work, with a warning about the new name."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from types import MappingProxyType

__all__ = ["RENAMED", "current_name", "former_name"]

# "Travel" is a property of a bumper (`testbed.bumper.travel`), "compression" the part that a collision uses.
# The peak of a run may belong to a later contact; the peak of the first contact is a separate metric.
RENAMED: Mapping[str, str] = MappingProxyType(
    {"bumper travel": "bumper compression", "peak contact force": "peak force of the run"}
)


def current_name(field: str, name: str) -> str:
    """The present name of the metric ``name``; if it differs, a FutureWarning names ``field`` and both."""
    if name not in RENAMED:
        return name
    warnings.warn(f'{field}: "{name}" is called "{RENAMED[name]}" now', FutureWarning, stacklevel=3)
    return RENAMED[name]


def former_name(name: str) -> str | None:
    """The former name of the metric ``name``; None: it always had this name."""
    return next((old for old, new in RENAMED.items() if new == name), None)
