"""Words that follow a number."""

from __future__ import annotations

__all__ = ["counted"]


def counted(count: int, noun: str) -> str:
    """The number and what it counts: "1 run", "2,000 runs"."""
    return f"{count:,} {noun}" + ("" if count == 1 else "s")
