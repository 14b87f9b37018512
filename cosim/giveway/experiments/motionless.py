"""A slider hits the motionless robot (Kim, Llado, Sentis 2016, 5.2).

A 9.08 kg slider, pulled by a hanging weight of 4.54 kg, reaches 0.5 m/s and hits the middle of one side of the body.
The robot notices through its wheel torques alone and gives way by 0.5 m: the escape decays with the time constant
M_des/B_des = 1.25 s, so 8 s let it settle to within 1 mm. Afterwards it holds where it is.
"""

from __future__ import annotations

from giveway.experiments import Experiment
from giveway.scenario import BUMPERS, Scenario

DURATION_S = 8.0
HOLD = 0  # after the escape; 1 would go back to the path


def scenario(bumper: str) -> Scenario:
    """The experiment with ``bumper`` ("none", "spring" or "magnetic") on the slider."""
    return Scenario("motionless", DURATION_S, bumper=bumper, controller={"supervisor.after_settled": HOLD})


EXPERIMENT = Experiment(
    name="motionless",
    summary="A pulled slider at 0.5 m/s hits the resting robot, which notices and gives way (paper, 5.2).",
    section="5.2",
    bumpers=tuple(BUMPERS),
    scenario=scenario,
)
