"""Names that metrics had before: what users wrote with them goes on working, with a word about the new name."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from types import MappingProxyType

__all__ = ["RENAMED", "current_name", "former_name"]

# "Travel" is what a bumper has (`testbed.bumper.travel`), "compression" what a collision uses of it.
# The peak of a run may belong to a later contact than the first, which has a peak of its own.
RENAMED: Mapping[str, str] = MappingProxyType(
    {"bumper travel": "bumper compression", "peak contact force": "peak force of the run"}
)


def current_name(field: str, name: str) -> str:
    """The name of the metric ``name`` today; if that is another one, a FutureWarning names ``field`` and both."""
    if name not in RENAMED:
        return name
    warnings.warn(f'{field}: "{name}" is called "{RENAMED[name]}" now', FutureWarning, stacklevel=3)
    return RENAMED[name]


def former_name(name: str) -> str | None:
    """What the metric ``name`` was called before; None: it always had this name."""
    return next((old for old, new in RENAMED.items() if new == name), None)
