"""One run whose bits are known: a push on the resting robot with the paper's reflex, whose bits do not change.

Everything that it is made of is a number that this file states, so that no function of the system's mathematics
library decides a bit before the run begins. `python -m giveway.doctor.golden` prints the digest.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from giveway.scenario.scenario import Scenario
    from giveway.simulation.result import Result

__all__ = ["DIGEST", "digest", "golden_scenario"]

DIGEST = "4ef68ef53f5502602e99e64c3df84970"
"""Of every sample of `TRACES`, by every engine on every platform."""

TRACES = (
    *(f"testbed.sensor.torque[{wheel}]" for wheel in range(3)),
    *(f"testbed.sensor.encoder[{wheel}]" for wheel in range(3)),
    *(f"controller.command.wheel_angle[{wheel}]" for wheel in range(3)),
    *("controller.estimate.force_x", "controller.estimate.force_y", "controller.estimate.torque_z"),
)


def golden_scenario(fmi_version: int = 3) -> Scenario:
    """0.8 s, with a push of 60 N along x from 0.3 s to 0.6 s."""
    from giveway.scenario.plan import Pushes, TimedPush
    from giveway.scenario.scenario import Scenario

    push = Pushes((TimedPush(60.0, 0.0, -0.176, 0.05, 0.3, 0.3, 0.05),))
    return Scenario("golden", 0.8, bumper="none", push=push, preset="paper", fmi_version=fmi_version)


def digest(result: Result) -> str:
    """Of the bits of `TRACES`."""
    found = hashlib.blake2b(digest_size=16)
    for name in TRACES:
        found.update(np.ascontiguousarray(result.traces[name].values, dtype="<f8").tobytes())
    return found.hexdigest()


if __name__ == "__main__":
    from giveway.simulation.runner import run

    print(digest(run(golden_scenario(), None, "native")))
