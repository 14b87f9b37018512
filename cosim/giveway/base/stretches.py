"""Successive rows for which something holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["stretches"]


def stretches(rows: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Begin and end (the row behind the last one) of each stretch of True in ``rows``, shape (n,)."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], rows, [False])).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
