"""The share of a collision's impulse that the estimator sees: one hit, variants of the estimator, seeds of the noise.

The estimate is taken tick by tick (an averaging window of one sample), delays of sensors and bus included. Detection is
off, so that every variant sees the same collision.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from giveway import batch
from giveway.base.errors import SimulationError
from giveway.robot.presets import NO_REFLEX, PAPER
from giveway.robot.variables import table
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.robot.variables import Value
    from giveway.scenario.scenario import Scenario

__all__ = ["FORMS", "SHOWN_S", "Form", "Seen", "run_forms"]

SHOWN_S = 0.2
"""Time after the contact over which the impulses are recorded, s."""
TRACES = (
    *("testbed.truth.first_contact_time", "testbed.truth.contact_impulse_x", "testbed.truth.contact_impulse_y"),
    *("controller.estimate.force_x", "controller.estimate.force_y"),
)
WATCHING: Mapping[str, Value] = {"estimator.average_window": 1, **NO_REFLEX}
FINE_COUNTS = 1_000_000  # encoder counts per turn with negligible steps: 0.6 um at the rim
NOISELESS_TESTBED: Mapping[str, Value] = {
    "electronics.torque_noise": 0.0,
    "electronics.torque_resolution": 0.0,
    "electronics.encoder_counts": FINE_COUNTS,
}
NOISELESS_CONTROLLER: Mapping[str, Value] = {
    "estimator.encoder_counts": FINE_COUNTS,
    "sensor_check.encoder_jump": FINE_COUNTS,
}
# of a moving robot's travel, some ten encoder counts: the position of the hit within a count is random
ENCODER_PHASE_M = 1e-3


@dataclass(frozen=True)
class Form:
    """One variant of the estimator.

    Attributes:
        label: for tables and figures.
        controller: its parameters, beside those of the preset "paper".
        softness: the bristle stiffness that it assumes, relative to that of the rollers.
    """

    label: str
    controller: Mapping[str, Value] = field(default_factory=dict)
    softness: float = 1.0

    def parameters(self, scenario: Scenario) -> dict[str, Value]:
        """The controller parameters for ``scenario``, stiffness included."""
        known = scenario.parameters("controller")
        names = [f"estimator.presliding_stiffness[{wheel}]" for wheel in range(WHEELS)]
        stiffness = {name: self.softness * float(known.get(name, _start("controller", name))) for name in names}
        return {**WATCHING, **stiffness, **scenario.controller, **self.controller}


def measured(cutoff_radps: float) -> dict[str, Value]:
    """Controller parameters for measured acceleration, with this corner of the rate filters."""
    return {"estimator.acceleration_source": 1, "estimator.rate_cutoff": cutoff_radps}


BRISTLES: Mapping[str, Value] = MappingProxyType({"estimator.friction_model": 1})
# The filters need two corner times to follow a motion, and the motion until then is missing; but the effect of an
# encoder step on the acceleration grows with the square of the corner frequency.
CUTOFF_RADPS, LOW_CUTOFF_RADPS, HIGH_CUTOFF_RADPS = 300.0, 200.0, 400.0
FORMS: Mapping[str, Form] = MappingProxyType(
    {
        "paper": Form("the paper's, planned acceleration"),
        "measured": Form("the paper's, measured acceleration", measured(CUTOFF_RADPS)),
        "bristles": Form("bristles, measured acceleration", {**BRISTLES, **measured(CUTOFF_RADPS)}),
        "soft": Form("bristles 30 % too soft", {**BRISTLES, **measured(CUTOFF_RADPS)}, softness=0.7),
        "slow": Form(f"bristles, corner at {LOW_CUTOFF_RADPS:g} rad/s", {**BRISTLES, **measured(LOW_CUTOFF_RADPS)}),
        "fast": Form(f"bristles, corner at {HIGH_CUTOFF_RADPS:g} rad/s", {**BRISTLES, **measured(HIGH_CUTOFF_RADPS)}),
    }
)


@dataclass(frozen=True)
class Seen:
    """Impulses in the direction of the true one, N s, from the contact on, one row per run, one column per ms.

    Attributes:
        time_s: shape (n,), from the first sample after the contact.
        true, seen: shape (runs, n).
    """

    time_s: NDArray[np.float64]
    true: NDArray[np.float64]
    seen: NDArray[np.float64]

    def share(self, after_s: float) -> NDArray[np.float64]:
        """Seen over true impulse at ``after_s`` after the contact, shape (runs,)."""
        column = int(np.argmin(np.abs(self.time_s - after_s)))
        return np.asarray(self.seen[:, column] / self.true[:, column])

    def excess(self) -> NDArray[np.float64]:
        """Largest amount by which the seen impulse exceeds the true one, N s, shape (runs,)."""
        return np.asarray((self.seen - self.true).max(axis=1))


def run_forms(
    scenario: Scenario,
    forms: Sequence[Form],
    seeds: int,
    *,
    noise: bool = True,
    threads: int = 2,
    progress: Callable[[float], None] = lambda _share: None,
) -> list[Seen]:
    """The hit of ``scenario`` as seen by each of ``forms``, for ``seeds`` seeds: each has its own sensor noise, and for
    a moving robot its own position within the encoders' counts.

    Without ``noise`` the torques are exact and the encoders very fine.
    """
    runs = [_run(scenario, form, seed, seeds, noise) for form in forms for seed in range(1, seeds + 1)]
    found = batch.run_many(
        runs, threads=threads, traces=TRACES, progress=lambda done, total: progress(done / max(total, 1))
    )
    failed = [str(message) for message in found["message"].values if str(message)]
    if failed:
        raise SimulationError("impulse share", failed[0], 0.0)
    trace = {name: found[name].values for name in TRACES}
    return [_seen(trace, slice(k * seeds, (k + 1) * seeds), scenario.step_s) for k in range(len(forms))]


def _run(scenario: Scenario, form: Form, seed: int, seeds: int, noise: bool) -> Scenario:
    testbed: dict[str, Value] = dict(scenario.testbed)
    controller = form.parameters(scenario)
    if not noise:
        testbed |= NOISELESS_TESTBED
        controller |= NOISELESS_CONTROLLER
    further_m = ENCODER_PHASE_M * (seed - 1) / seeds
    direction = float(scenario.parameters("testbed").get("slider.direction", _start("testbed", "slider.direction")))
    for name, along in (("slider.target_x", -math.cos(direction)), ("slider.target_y", -math.sin(direction))):
        if name in testbed:  # only for a moving robot is the slider elsewhere
            testbed[name] = float(testbed[name]) + further_m * along
    return dataclasses.replace(scenario, testbed=testbed, controller=controller, seed=seed, preset=PAPER)


def _start(model: str, name: str) -> Value:
    start = table(model)[name].start
    assert start is not None  # parameters have one
    return start


def _seen(trace: Mapping[str, NDArray[np.float64]], runs: slice, step_s: float) -> Seen:
    contact_s = trace["testbed.truth.first_contact_time"][runs, -1]
    columns = round(SHOWN_S / step_s)
    true, seen = np.empty((len(contact_s), columns)), np.empty((len(contact_s), columns))
    for k, contact in enumerate(contact_s):
        first = math.ceil(contact / step_s)
        rows = slice(first, first + columns)
        impulse = np.stack([trace[f"testbed.truth.contact_impulse_{axis}"][runs][k, rows] for axis in "xy"])
        force = np.stack([trace[f"controller.estimate.force_{axis}"][runs][k, rows] for axis in "xy"])
        along = impulse[:, -1] / np.linalg.norm(impulse[:, -1])
        true[k], seen[k] = along @ impulse, np.cumsum(along @ force) * step_s
    return Seen(step_s * np.arange(1, columns + 1, dtype=np.float64), true, seen)
