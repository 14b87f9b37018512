"""The motion of the wheels as the planned one, for logs without a plan: the controller tells rest from motion by it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.identification.torque_model import TorqueModel
from giveway.replay.inputs import Steps, jump_radps, value_of, wheels_at_azimuths
from giveway.robot.variables import Value
from giveway.robot.wheels import WHEELS
from giveway.scenario.plan import PLAN_INPUTS

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["UNOBSERVED", "WheelPlan", "moving", "over_gaps"]

STANDING_S = 0.25  # before and after the last count of an encoder a wheel counts as moving
SMOOTHING_S = 0.03
TRUNCATE = 4.0  # standard deviations: as far as the smoothing reaches
TOGETHER_S = 0.05  # of rows that come one by one
UNOBSERVED: Mapping[str, Value] = MappingProxyType({"motor.inertia": 0.0})
"""The controller's commands on such a plan are not those that the motors got: it does not observe them."""


def moving(inputs: Mapping[str, NDArray[Any]], step_s: float) -> NDArray[np.bool_]:
    """Whether an encoder counts, or does within `STANDING_S`; ``inputs`` are the controller's."""
    from scipy.ndimage import maximum_filter1d

    counts = np.stack([inputs[f"sensor.encoder[{wheel}]"] for wheel in range(WHEELS)], axis=1).astype(np.float64)
    known = np.rint(over_gaps(counts, inputs["sensor.present"]))
    turned = np.diff(known, axis=0, prepend=known[:1]).any(axis=1)
    return np.asarray(maximum_filter1d(turned, 2 * round(STANDING_S / step_s) + 1))


def over_gaps(values: NDArray[np.float64], present: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Straight over rows without a sample."""
    good = np.flatnonzero(present)
    if len(good) in (0, len(present)):
        return values
    return np.stack([np.interp(np.arange(len(present)), good, column[good]) for column in values.T], axis=1)


class WheelPlan:
    """Adds the plan to successive `Steps`; they come back as soon as what is ahead of them is known, in `DELAY_S`."""

    DELAY_S = STANDING_S + TOGETHER_S

    def __init__(self, parameters: Mapping[str, Value], step_s: float) -> None:
        self._step_s = step_s
        radius_m, distance_m = (value_of(parameters, f"geometry.wheel_{name}") for name in ("radius", "distance"))
        model = TorqueModel(radius_m, distance_m, 1.0, 0.0, 0.0, 0.0, 0.0)
        self._inverse = np.linalg.inv(model.wheel_jacobian)
        self._order = wheels_at_azimuths(parameters)
        self._azimuth = value_of(parameters, "geometry.azimuth")
        self._most_rad = jump_radps(parameters) * step_s
        self._sigma = SMOOTHING_S / step_s
        self._reach = 2 + max(math.ceil(TRUNCATE * self._sigma), round(STANDING_S / step_s))
        self._together = max(1, round(TOGETHER_S / step_s))
        self._parts: list[Steps] = []
        self._held = self._told = 0  # rows in the parts, and how many of them came back before
        self._turned = 0.0  # sums of what came before the row in front of the next one
        self._moved = np.zeros(3)

    def add(self, steps: Steps | None, last: bool) -> Steps | None:
        """The steps whose plan is known with ``steps``, the next ones; ``last``: all that are left."""
        if steps is not None:
            self._parts.append(steps)
            self._held += len(steps.present)
        end = self._held - (0 if last else self._reach)
        if end - self._told < (1 if last else self._together):
            return None
        buffer = _joined(self._parts)
        found = self._planned(buffer, self._told, end)
        keep = max(0, end - self._reach)
        self._parts, self._held, self._told = [_rows(buffer, slice(keep, None))], self._held - keep, end - keep
        return found

    def _planned(self, steps: Steps, begin: int, end: int) -> Steps:
        """Rows ``begin`` to ``end`` of ``steps``, with their plan."""
        around = slice(max(begin - 1, 0), min(end + 1, len(steps.present)))  # differences take the rows beside them
        twist = self._twist(steps)[around]
        turned = np.cumsum(np.concatenate([[self._turned], twist[:, 2]]))[1:]
        theta = turned * self._step_s + self._azimuth
        cos, sin = np.cos(theta), np.sin(theta)
        rates = np.stack(
            [cos * twist[:, 0] - sin * twist[:, 1], sin * twist[:, 0] + cos * twist[:, 1], twist[:, 2]], axis=1
        )
        growth = np.gradient(rates, self._step_s, axis=0) if len(rates) > 1 else np.zeros_like(rates)
        own = slice(begin - around.start, end - around.start)
        moved = np.cumsum(np.concatenate([self._moved[None, :], rates[own]]), axis=0)[1:]
        plan = np.concatenate([moved * self._step_s, rates[own], growth[own]], axis=1)
        self._moved = moved[-1]
        if own.stop > 1:  # the next rows begin with the last one of these
            self._turned = float(turned[own.stop - 2])
        found = _rows(steps, slice(begin, end))
        return dataclasses.replace(found, inputs={**found.inputs, **dict(zip(PLAN_INPUTS, plan.T, strict=True))})

    def _twist(self, steps: Steps) -> NDArray[np.float64]:
        """Of the base in the axes of the first wheel, (n, 3)."""
        from scipy.ndimage import gaussian_filter1d

        angle = over_gaps(steps.angle_rad[:, self._order], steps.present)
        change = np.diff(angle, axis=0, prepend=angle[:1])
        change[np.abs(change) > self._most_rad] = 0.0  # no wheel turns so far: the encoder jumped
        smooth = gaussian_filter1d(change, self._sigma, axis=0, mode="constant", truncate=TRUNCATE)
        rate = (smooth + np.concatenate([smooth[1:], smooth[-1:]])) / (2.0 * self._step_s)
        twist = np.einsum("ij,kj->ik", rate, self._inverse)
        twist[~moving(steps.inputs, self._step_s)] = 0.0
        return np.asarray(twist)


def _rows(steps: Steps, rows: slice) -> Steps:
    yaw = None if steps.yaw_rate is None else steps.yaw_rate[rows]
    inputs = {name: values[rows] for name, values in steps.inputs.items()}
    arrays = (steps.angle_rad[rows], steps.torque_nm[rows], steps.present[rows])
    return Steps(steps.first + (rows.start or 0), inputs, *arrays, yaw)


def _joined(parts: list[Steps]) -> Steps:
    first = parts[0]
    if len(parts) == 1:
        return first
    inputs = {name: np.concatenate([one.inputs[name] for one in parts]) for name in first.inputs}
    yaw = [one.yaw_rate for one in parts if one.yaw_rate is not None]
    return Steps(
        first.first,
        inputs,
        np.concatenate([one.angle_rad for one in parts]),
        np.concatenate([one.torque_nm for one in parts]),
        np.concatenate([one.present for one in parts]),
        np.concatenate(yaw) if yaw else None,
    )
