"""Checks of plain values; each raises GivewayError naming field, value and allowed range."""

from __future__ import annotations

import math

from giveway.base.errors import GivewayError

__all__ = ["finite", "whole"]


def finite(field: str, value: object, minimum: float = -math.inf, maximum: float = math.inf, unit: str = "") -> float:
    """``value`` as a finite float within [minimum, maximum]."""
    suffix = f" {unit}" if unit else ""
    if math.isinf(minimum) and math.isinf(maximum):
        allowed = f"a finite number{suffix}"
    else:
        allowed = f"a number from {minimum:g} to {maximum:g}{suffix}"
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise GivewayError(field, value, allowed)
    if not math.isfinite(value) or not minimum <= value <= maximum:
        raise GivewayError(field, value, allowed)
    return float(value)


def whole(field: str, value: object, minimum: int, maximum: int) -> int:
    """``value`` as an int within [minimum, maximum]."""
    if isinstance(value, bool) or not isinstance(value, int) or not minimum <= value <= maximum:
        raise GivewayError(field, value, f"a whole number from {minimum} to {maximum}")
    return value
