"""What a run is made of, in Python or as a TOML file, and checked before anything runs.

Plan and pushes of the robot, what collides with it and where that has to start, and which body region is hit.
"""

from giveway.scenario.scenario import BUMPERS, Scenario

__all__ = ["BUMPERS", "Scenario"]
