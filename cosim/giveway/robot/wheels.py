"""How many wheels the robot has, and where: 120 degrees apart, the first straight ahead."""

import math

__all__ = ["AZIMUTHS_RAD", "WHEELS"]

WHEELS = 3
AZIMUTHS_RAD = tuple(2.0 * math.pi * wheel / WHEELS for wheel in range(WHEELS))
