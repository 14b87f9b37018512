"""The smallest push that a detector can notice, as arrays: from its thresholds and the sensors' noise, no simulation.

A constant push begins at once at the middle of the resting base, and its whole force is sensed. It is noticed when
the mean of what a detector compares, noise left out, reaches the threshold:

- force average: its threshold.
- impulse: its leak at rest; the integral of a smaller force never grows.
- channels: the smaller one of both. The slow channel needs its threshold at rest. In the fast one, a low-pass of time
  t_j sees at most the share r^(r/(1 - r)), r = t_j/t_b, of the push, since the baseline (time t_b) follows it, and
  needs sqrt(rest^2 + (multiple sigma_j)^2), with sigma_j the noise behind that low-pass as in gw_fast_channel.c.

The noise is that of the torque signal: its standard deviation and its quantum, as a force of the wheels, and as a
motion of the wheels that the encoder does not see (torque over stiffness), differentiated twice. Of what the controller
believes, at least 40 % of the variance count.

It is that of torque sensors. Where torque comes from the motors' current, the gears stand between: a push below their
stiction does not reach the signal at all, and how far a gear slides, once the swinging base has broken it away, and on
which wheels, no linear model says. `giveway.detectability` simulates such pushes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Values = Mapping[str, NDArray[np.float64]]

__all__ = ["CONTROLLER", "TESTBED", "smallest_push_n"]

# gw_fast_channel.c
BANK_S = (0.002, 0.006, 0.018, 0.05)
FIRST_NORMAL, NORMAL_SHARE, LEAST_SHARE = 2, 0.8, 0.4

CONTROLLER = (
    "controller.period", "detector.kind", "detector.force_threshold", "detector.leak_rest", "channels.noise_multiple",
    "channels.baseline_time", "channels.fast_rest", "channels.slow_rest", "estimator.rate_cutoff",
    "estimator.torque_noise", "estimator.drivetrain_stiffness",
)  # fmt: skip
TESTBED = ("electronics.torque_noise", "electronics.torque_resolution", "drivetrain.stiffness", "wheel.radius",
           "wheel.inertia", "base.mass", "roller.inertia", "roller.radius")  # fmt: skip
"""Parameters that decide."""


def smallest_push_n(controller: Values, testbed: Values) -> NDArray[np.float64]:
    """Of robots whose parameters are arrays of n, by name."""
    kind = controller["detector.kind"]
    channels = np.minimum(controller["channels.slow_rest"], _fast_channel_n(controller, testbed))
    return np.select(
        [kind == 0, kind == 1], [controller["detector.force_threshold"], controller["detector.leak_rest"]], channels
    )


def _fast_channel_n(controller: Values, testbed: Values) -> NDArray[np.float64]:
    quantum = testbed["electronics.torque_resolution"]
    true_n2 = testbed["electronics.torque_noise"] ** 2 + quantum**2 / 12.0
    believed_n2 = controller["estimator.torque_noise"] ** 2
    # A stiffness of 0 is a rigid drivetrain to the controller.
    believed_stiffness = controller["estimator.drivetrain_stiffness"]
    soft = believed_stiffness > 0.0
    believed_compliance = np.where(soft, 1.0 / np.where(soft, believed_stiffness, 1.0), 0.0)
    found = np.full(len(quantum), np.inf)
    for number, time_s in enumerate(BANK_S):
        true = true_n2 * _force_variance(controller, testbed, believed_compliance, time_s)
        least = LEAST_SHARE * believed_n2 * _force_variance(controller, testbed, believed_compliance, time_s)
        noise_n2 = np.maximum(true, least) * (NORMAL_SHARE if number >= FIRST_NORMAL else 1.0)
        threshold = np.sqrt(
            controller["channels.fast_rest"] ** 2 + controller["channels.noise_multiple"] ** 2 * noise_n2
        )
        ratio = time_s / controller["channels.baseline_time"]
        with np.errstate(divide="ignore", invalid="ignore"):
            passed = np.where(np.abs(ratio - 1.0) < 1e-6, np.exp(-1.0), ratio ** (ratio / (1.0 - ratio)))
        found = np.minimum(found, threshold / passed)
    return found


def _force_variance(
    controller: Values, testbed: Values, compliance: NDArray[np.float64], time_s: float
) -> NDArray[np.float64]:
    """Of the force behind a low-pass, per variance of the torque: `predicted_n2` of gw_fast_channel.c."""
    radius = testbed["wheel.radius"]
    rolling = 1.5 * (testbed["wheel.inertia"] / radius**2 + testbed["roller.inertia"] / testbed["roller.radius"] ** 2)
    mass = testbed["base.mass"] + rolling
    w, a = controller["estimator.rate_cutoff"], 1.0 / time_s
    both = (w + a) ** 2
    of_position = (w + 2.0 * a) / (4.0 * both) * (mass * w * w * a) ** 2
    of_force = w * a * (2.0 * w + a) / (4.0 * both)
    position_m2, force_n2 = 2.0 / 3.0 * (compliance * radius) ** 2, 1.5 / radius**2
    return np.asarray(controller["controller.period"] * (of_position * position_m2 + of_force * force_n2))
