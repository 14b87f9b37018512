"""Where a slider starts that is to have a speed when it meets the robot: asked of the batch library."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.library.batch_library import library

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["LONGEST_RUN_UP_S", "RUN_UP", "find_run_ups"]

LONGEST_RUN_UP_S = 60.0  # the library's
RUN_UP = np.dtype(
    [
        ("end_speed_mps", "f8"),
        ("duration_s", "f8"),
        ("slider.mass", "f8"),
        ("slider.friction", "f8"),
        ("slider.friction_speed", "f8"),
        ("slider.damping", "f8"),
        ("rope.hanging_mass", "f8"),
        ("rope.stiffness", "f8"),
        ("rope.damping", "f8"),
        ("rope.drop_height", "f8"),
        ("rope.attached", "u4"),
        ("status", "u4"),
        ("start_speed_mps", "f8"),
        ("travel_m", "f8"),
        ("reached_mps", "f8"),
        ("time_count", np.uintp),
        ("times_s", np.uintp),
        ("travels_m", np.uintp),
    ],
    align=True,
)
"""A question and its answer: gwb_run_up_t of giveway_batch.h says what each is."""


def find_run_ups(run_ups: NDArray[Any], times_s: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
    """Fill in the answers of ``run_ups`` (`RUN_UP`, shape (n,)).

    Returns how far the sliders are from their starts at ``times_s``, ascending, shape (n, k), s; in m, of the same
    shape. Without them only the answers are found, and k is 0.
    """
    times = np.ascontiguousarray(np.zeros((len(run_ups), 0)) if times_s is None else times_s, dtype=np.float64)
    travels = np.zeros_like(times)
    rows = np.arange(len(run_ups)) * times.strides[0]
    run_ups["time_count"] = times.shape[1]
    run_ups["times_s"] = times.ctypes.data + rows
    run_ups["travels_m"] = travels.ctypes.data + rows
    library().run_up(run_ups.ctypes.data, len(run_ups))
    return travels
