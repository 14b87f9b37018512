"""An accelerometer at the height of the centre of mass shows the sum of all forces, whatever a hit does to the body.

Experiment 5.2 with a robot that tips, hit below and above its centre of mass (0.414 m).
"""

from __future__ import annotations

import math
from dataclasses import replace

import giveway
import numpy as np
import pytest
from giveway.crowd.population import IMU_CONTROLLER

PUSHED_DEG = -120.0  # of experiment 5.2
LATER_MS = 30


def hit(contact_height_m: float, imu_height_m: float | None) -> tuple[float, float, float]:
    """Delay (ms), and 30 ms after the decision errors of direction (deg) and place (mm)."""
    planned = giveway.experiment("motionless").scenario("magnetic")
    own = {"base.tipping": True, "imu.present": True, "contact.height": contact_height_m}
    if imu_height_m is not None:
        own["imu.height"] = imu_height_m
    scenario = replace(
        planned,
        duration_s=2.0,
        testbed={**planned.testbed, **own},
        controller={**planned.controller, **IMU_CONTROLLER},
    )
    run = giveway.run(scenario, engine="native")
    tick = int(np.argmax(run.traces["controller.detection.count"].values > 0)) + LATER_MS

    def at(name: str) -> float:
        return float(run.traces[name].values[tick])

    off = math.remainder(at("controller.detection.direction") - math.radians(PUSHED_DEG), 2.0 * math.pi)
    place = math.hypot(
        *(at(f"controller.detection.point_{axis}") - at(f"testbed.truth.contact_base_{axis}") for axis in "xy")
    )
    return run.metric("detection time").value, math.degrees(off), 1e3 * place


@pytest.mark.parametrize("height_m", [0.2, 0.75])
def test_where_the_robot_file_has_it_a_hit_of_any_height_is_felt_at_once(height_m: float) -> None:
    """Within what is asked of a robot with an accelerometer: 6 ms, 5 deg, 20 mm."""
    delay_ms, off_deg, place_mm = hit(height_m, None)
    assert delay_ms < 6.0
    assert abs(off_deg) < 5.0
    assert place_mm < 20.0


def test_low_in_the_body_it_feels_a_high_hit_late() -> None:
    """The body leans about a point near the floor: what sits there is hardly accelerated at first."""
    assert hit(0.75, 0.2)[0] > 2.0 * hit(0.75, None)[0]
