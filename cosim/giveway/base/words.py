"""Words that follow a number."""

from __future__ import annotations

__all__ = ["counted", "memory"]


def counted(count: int, noun: str) -> str:
    """The number and what it counts: "1 run", "2,000 runs"."""
    return f"{count:,} {noun}" + ("" if count == 1 else "s")


def memory(amount: float) -> str:
    """A number of bytes in a unit that suits it: "946 kB", "1.2 GB"."""
    for unit in ("bytes", "kB", "MB", "GB"):
        if amount < 999.5:
            return f"{amount:.3g} {unit}"
        amount /= 1000.0
    return f"{amount:,.0f} TB"
