"""What a run is judged by: the numbers of the batch library, whether the run was one of it, of the FMUs, or loaded.

Their definitions are in GWB_METRICS of fmu/batch/giveway_batch.h, one line each, and in `NativeMetric.description`.
`Collision` adds what figures draw besides.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.library import recorded
from giveway.library.batch_library import OF_COLLISION, OF_DESIGN, OF_FREE_RUN, native_metrics
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

    from giveway.scenario.body_regions import BodyRegion

__all__ = ["Collision", "Metric", "collision", "definitions", "design", "evaluate", "without_collision"]

FIRST_PEAK = "peak force of the first contact"
PUSH_FORCES = ("testbed.push.force_x", "testbed.push.force_y")


@dataclass(frozen=True)
class Metric:
    """One number of a run.

    Attributes:
        name: what it is.
        value: what the robot estimated, did or suffered; None if it did not happen.
        unit: unit of value and truth.
        truth: what the testbed knows it should be; None where there is no such thing.
        decimals: digits after the point that are worth printing; None for a number that is judged by its exponent.
    """

    name: str
    value: float | None
    unit: str
    truth: float | None = None
    decimals: int | None = 2

    def __post_init__(self) -> None:
        for name in ("value", "truth"):
            number = getattr(self, name)
            finite = number is not None and math.isfinite(number)
            object.__setattr__(self, name, float(number) if finite else None)


def evaluate(
    traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]], region: BodyRegion | None = None
) -> dict[str, Metric]:
    """Every metric of a run by name, in the order of tables.

    Args:
        traces: all that the run recorded, to its end or as far as it came.
        parameters: by model, those of the manifest; others have their start values.
        region: the body region that is hit; None: no share of its limits.
    """
    limits_n = (0.0, 0.0) if region is None else (region.peak_limit_n, region.lasting_limit_n)
    columns = {str(name): values.values for name, values in traces.data_vars.items()}
    values, truths = recorded.evaluate(traces["time"].values, columns, parameters, limits_n)
    numbers = zip(native_metrics(), values.tolist(), truths.tolist(), strict=True)
    return {
        metric.name: Metric(metric.name, value, metric.unit, truth, metric.decimals)
        for metric, value, truth in sorted(numbers, key=lambda one: one[0].line)
    }


def definitions(names: Iterable[str]) -> dict[str, str]:
    """What each of ``names`` is, in a few words; names that the library does not have are left out."""
    words = {metric.name: metric.description for metric in native_metrics()}
    return {name: words[name] for name in names if name in words}


def shown(metrics: Mapping[str, Metric], where: int) -> tuple[Metric, ...]:
    """Those of ``metrics`` that are shown ``where``: `OF_COLLISION`, `OF_DESIGN` or `OF_FREE_RUN`."""
    names = {metric.name for metric in native_metrics() if metric.shown & where}
    return tuple(metric for name, metric in metrics.items() if name in names)


def collision(traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]]) -> tuple[Metric, ...]:
    """The metrics of the first collision in ``traces``, in the order of the table."""
    return shown(evaluate(traces, parameters), OF_COLLISION)


def design(
    traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]], region: BodyRegion | None = None
) -> tuple[Metric, ...]:
    """What a bumper design is judged by beyond `collision`, and what happened otherwise than asked."""
    return shown(evaluate(traces, parameters, region), OF_DESIGN)


def without_collision(traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]]) -> tuple[Metric, ...]:
    """The metrics of a run in which nothing can be hit, in the order of the table."""
    return shown(evaluate(traces, parameters), OF_FREE_RUN)


class Collision:
    """The first collision of a run, cut out of its traces.

    Attributes:
        time_s: shape (n,).
        metrics: all of the run, by name.
        contact_s: time of the first cover contact, None if there was none.
        detected: row of the first detection after contact, None if there was none.
    """

    def __init__(self, traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]]) -> None:
        self._traces = traces
        self.time_s: NDArray[np.float64] = traces["time"].values
        self.metrics = evaluate(traces, parameters)
        self.contact_s = self.metrics["contact time"].value
        after_ms = self.metrics["detection time"].value
        self.detected: int | None = None
        if self.contact_s is not None and after_ms is not None:
            self.detected = int(np.abs(self.time_s - (self.contact_s + 1e-3 * after_ms)).argmin())

    def __getitem__(self, name: str) -> NDArray[Any]:
        values: NDArray[Any] = self._traces[name].values
        return values

    def pushed(self) -> NDArray[np.bool_]:
        """Rows with an external push; its traces are there only if the scenario has one."""
        none = np.zeros(len(self.time_s), dtype=np.bool_)
        forces = [self[name] for name in PUSH_FORCES if name in self._traces]
        return np.any([none, *(force != 0.0 for force in forces)], axis=0)  # type: ignore[no-any-return]

    @property
    def start(self) -> int:
        """The first row at or after contact; 0 without one."""
        return 0 if self.contact_s is None else int(np.searchsorted(self.time_s, self.contact_s))

    def true_impulse(self) -> NDArray[np.float64] | None:
        """Impulse on the robot from contact to detection, base frame, N s, shape (2,); None without a detection."""
        size, direction = self.metrics["impulse at detection"].truth, self.metrics["force direction"].truth
        if size is None or direction is None:
            return None
        return size * np.array([math.cos(math.radians(direction)), math.sin(math.radians(direction))])

    def true_point(self) -> NDArray[np.float64] | None:
        """Contact point on the robot up to detection, base frame, m, shape (2,); None without a detection."""
        x, y = (self.metrics[f"contact point {axis}"].truth for axis in "xy")
        return None if x is None or y is None else 1e-3 * np.array([x, y])

    def peak_torque_row(self) -> int | None:
        """The row of the peak wheel torque; None if no wheel carried an impact."""
        peak = self.metrics["peak wheel torque"].value
        if peak is None:
            return None
        torque = [np.abs(self[f"testbed.truth.wheel_torque[{wheel}]"][self.start :]) for wheel in range(WHEELS)]
        return self.start + int(np.any([one == abs(peak) for one in torque], axis=0).argmax())

    def impact_sign(self, wheel: int) -> float:
        """Sign of the torque that the impact makes at ``wheel`` when it is largest; 1 if no wheel carried one."""
        row = self.peak_torque_row()
        return 1.0 if row is None else math.copysign(1.0, self[f"testbed.truth.wheel_torque[{wheel}]"][row])
