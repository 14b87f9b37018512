"""The effect of sensor noise on a metric: its range over seeds."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from giveway.experiments.reproduction.findings import Effort

if TYPE_CHECKING:
    from giveway.scenario.scenario import Scenario

__all__ = ["noise_note"]


def noise_note(what: str, scenario: Scenario, metric: str, seeds: int, effort: Effort) -> str:
    """A sentence with the range of ``metric`` over ``seeds`` runs of ``scenario``."""
    from giveway.batch import run_many

    runs = [dataclasses.replace(scenario, seed=seed) for seed in range(1, seeds + 1)]
    found = run_many(runs, threads=effort.threads)
    values = found[metric].values
    missing = int(np.isnan(values).sum())
    if missing:
        return f"{what}: did not happen with {missing} of {seeds} seeds of the sensor noise."
    unit = found[metric].attrs["units"]
    return f"{what}: {values.min():.1f} to {values.max():.1f} {unit} over {seeds} seeds of the sensor noise."
