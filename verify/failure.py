"""How a rung fails."""

from __future__ import annotations

__all__ = ["RungFailed"]


class RungFailed(Exception):
    """The evidence: what was found, where, and what was expected."""

    def __init__(self, evidence: str) -> None:
        super().__init__(evidence)
        self.evidence = evidence
