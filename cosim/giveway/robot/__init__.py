"""The robot: its file, the variables of the FMUs that take their start values from it, and its outline from above.

`robot_file` reads a robot file, `variables` the FMUs' tables, `changes` writes a robot file with other values.
"""

from giveway.robot.robot_file import CONFIDENCE, PROVENANCE, Entry, Robot, read_robot

__all__ = ["CONFIDENCE", "PROVENANCE", "Entry", "Robot", "read_robot"]
