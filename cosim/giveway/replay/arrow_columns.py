"""Columns of Arrow from and to NumPy; pyarrow's own ways import pandas, which takes as long as a short replay."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["column_of", "numbers_of"]


def column_of(values: NDArray[Any]) -> Any:
    """A column of numbers or booleans."""
    import pyarrow

    kind = pyarrow.from_numpy_dtype(values.dtype)
    bits = np.packbits(values, bitorder="little") if values.dtype == np.bool_ else np.ascontiguousarray(values)
    return pyarrow.Array.from_buffers(kind, len(values), [None, pyarrow.py_buffer(bits)])


def numbers_of(column: Any) -> NDArray[np.float64]:
    """A column of float64, perhaps in chunks; NaN where it has nothing."""
    parts = [_numbers(chunk) for chunk in getattr(column, "chunks", [column])]
    return parts[0] if len(parts) == 1 else np.concatenate([np.zeros(0), *parts])


def _numbers(array: Any) -> NDArray[np.float64]:
    there, data = array.buffers()
    rows = slice(array.offset, array.offset + len(array))
    if data is None:
        return np.full(len(array), np.nan)
    found = np.frombuffer(data, dtype=np.float64)[rows]
    if array.null_count:
        bits = np.unpackbits(np.frombuffer(there, dtype=np.uint8), bitorder="little")[rows]
        found = np.where(bits, found, np.nan)
    return found
