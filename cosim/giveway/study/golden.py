"""Runs that show whether another machine gives the same bits: hits of every bumper, standing and tipping, two methods.

Their parameters are computed where the study is, and are sent as they are: sines of NumPy differ between processors.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from giveway.library.batch_library import METHODS
from giveway.library.work import Work

__all__ = ["golden_works"]

_HIT = {"speed": 0.5, "mass": 9.08, "edge": 0, "time": 0.12}
_GOLDEN = {
    "schema_version": 1,
    "scenario": {"duration": 0.25, "bumper": "magnetic"},
    "collision": [{"name": "flat", **_HIT}, {"name": "high", **_HIT, "height": 0.3}],
    "vary": [
        {"quantity": "bumper", "values": ["none", "spring", "magnetic"]},
        {"quantity": "testbed.bumper.latch_force", "values": [10.0, 45.8, 60.0]},
    ],
}


def golden_works() -> list[Work]:
    """One for each method."""
    from giveway.study.engine import plan_runs
    from giveway.study.study_file import check

    found = []
    for method in METHODS:
        table = plan_runs(check({**_GOLDEN, "method": method}, Path(), "golden"))
        design, sample, case = table.split(np.arange(table.count))
        values = np.empty((table.count, len(table.columns.names)))
        for number in range(len(table.cases)):
            mine = case == number
            values[mine] = table.rows(design[mine], sample[mine], number).values
        found.append(table.work(values, case, method, None))
    return found
