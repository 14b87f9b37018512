"""Records the sensors of the paper's experiment 5.2, rigid slider, in recorded_collision.inc for the firmware.

The robot reacts as in the paper: c_core is compared with another form of that reflex on this recording, too.

From the top of the repository, after `make build`: .venv/bin/python examples/firmware_mps2_an386/record_collision.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from giveway.base import native
from giveway.base.files import write_text
from giveway.experiments.motionless import scenario
from giveway.robot.presets import PAPER
from giveway.robot.robot_file import read_robot
from giveway.simulation.master import simulate

TICKS = 800  # tare, hit, reaction, and the second hit of the slider, which is still being pulled
FILE = Path(__file__).with_name("recorded_collision.inc")
HEADING = """\
/* Sensors of the motionless robot that a rigid slider hits, one row per millisecond: three torques as multiples of the
 * sensor's resolution, three encoder counts. Made by record_collision.py; do not edit. */
"""


def main() -> None:
    traces = simulate(scenario("none", preset=PAPER)).traces
    resolution_nm = read_robot(native.robot()).value("drivetrain.torque_sensor_resolution")
    torques_nm = np.column_stack([traces[f"testbed.sensor.torque[{wheel}]"][:TICKS] for wheel in range(3)])
    encoders = np.column_stack([traces[f"testbed.sensor.encoder[{wheel}]"][:TICKS] for wheel in range(3)])
    steps = np.rint(torques_nm / resolution_nm).astype(int)
    # The firmware makes the very same floats from the integers.
    assert np.array_equal((steps * resolution_nm).astype(np.float32), torques_nm.astype(np.float32))
    assert traces["testbed.sensor.present"][:TICKS].all()
    assert (np.diff(traces["testbed.sensor.counter"][:TICKS]) == 1).all()
    rows = ["{" + ", ".join(str(number) for number in row) + "},\n" for row in np.hstack([steps, encoders])]
    write_text(FILE, HEADING + "".join(rows))


if __name__ == "__main__":
    main()
