"""How a study's runs are integrated; the names are those of `giveway.batch`."""

from __future__ import annotations

__all__ = ["METHODS"]

METHODS = ("event-exact",)
