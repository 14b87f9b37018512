"""The definition of a run, in Python or as a TOML file, checked before anything runs.

Plan and pushes of the robot, the collider and its start, and the body region that is hit.
"""

from giveway.scenario.scenario import BUMPERS, Scenario

__all__ = ["BUMPERS", "Scenario"]
