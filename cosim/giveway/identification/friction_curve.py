"""Friction over the speed without a given law: used to judge (28) where it does not fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.identification.torque_model import TorqueModel
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.identification.roller_fit import Samples

__all__ = ["FrictionCurve", "friction_curve"]

NODES = 6


@dataclass(frozen=True)
class FrictionCurve:
    """Friction torque of a roller at some rates, straight between them and through zero at rest.

    Attributes:
        rate: roller rates, rising, shape (n,), rad/s.
        torque_nm: shape (n,), N m.
        left_nm: root mean square of its residual torques, N m.
        all_nm: root mean square of the torques that the rigid robot does not explain, about their mean, N m.
    """

    rate: NDArray[np.float64]
    torque_nm: NDArray[np.float64]
    left_nm: float
    all_nm: float

    @property
    def explained(self) -> float:
        """Share of the variance that the curve explains."""
        return 1.0 - (self.left_nm / self.all_nm) ** 2 if self.all_nm > 0.0 else 0.0


def friction_curve(
    samples: Sequence[Samples], used: Sequence[NDArray[np.bool_]], model: TorqueModel, slowest: float
) -> FrictionCurve:
    """The curve that fits the ``used`` samples best, by least squares; ``slowest``: rate above which a roller moves."""
    rate = np.concatenate([s.roller_rate[rows] for s, rows in zip(samples, used, strict=True)])
    wanted = np.concatenate([(s.torque_nm - s.rigid_nm)[rows] for s, rows in zip(samples, used, strict=True)])
    log = np.repeat(np.arange(len(samples)), [rows.sum() for rows in used])
    moving = np.abs(rate)[np.abs(rate) > slowest]
    nodes = np.unique(np.quantile(moving, np.linspace(0.02, 0.98, NODES)))
    columns = []
    for node in range(len(nodes)):
        hat = np.interp(np.abs(rate), [0.0, *nodes], [0.0, *np.eye(len(nodes))[node]])
        columns.append(((np.sign(rate) * hat) @ model.friction_gain.T).ravel())
    for one in np.unique(log):
        for wheel in range(WHEELS):
            tare = np.zeros(wanted.shape)
            tare[log == one, wheel] = 1.0
            columns.append(tare.ravel())
            wanted[log == one, wheel] -= wanted[log == one, wheel].mean()
    basis = np.stack(columns, axis=1)
    found = np.linalg.lstsq(basis, wanted.ravel(), rcond=None)[0]
    left = wanted.ravel() - basis @ found
    return FrictionCurve(
        nodes, found[: len(nodes)], float(np.sqrt(np.mean(left**2))), float(np.sqrt(np.mean(wanted**2)))
    )
