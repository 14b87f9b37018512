"""What a newcomer measures or looks up for a robot file: flags and questions of `giveway robot new`."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.checks import finite
from giveway.base.errors import GivewayError
from giveway.base.units import factor
from giveway.robot.footprint import CORNERS_MAX, hull

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["QUESTIONS", "Measured", "Question", "measured", "outline_of"]

CIRCLE_CORNERS = 12
NUMBER = re.compile(r"\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*([^\d\s].*)?")
OUTLINES = "circle DIAMETER, triangle SIDE, rectangle LENGTH x WIDTH, or corners x,y x,y x,y ... in m"


@dataclass(frozen=True)
class Question:
    """One number, or the outline, that is asked.

    Attributes:
        key: the flag without its dashes, and the member of `Measured` with `_` for `-`.
        text: what it is, and how it is found.
        unit: of `Measured`; "" for the outline.
        low, high: allowed range in this unit.
        needed: without it no file can be written.
        otherwise: what an empty answer means.
    """

    key: str
    text: str
    unit: str
    low: float = 0.0
    high: float = 0.0
    needed: bool = True
    otherwise: str = "estimate"

    def read(self, field: str, text: str) -> Any:
        """The value that a user wrote: a number with or without a unit, or an outline."""
        if not self.unit:
            return outline_of(field, text)
        found = NUMBER.fullmatch(text)
        if found is None:
            raise GivewayError(field, text, self.allowed)
        try:
            number = float(found[1])
        except ValueError:
            raise GivewayError(field, text, self.allowed) from None
        unit = (found[2] or self.unit).strip()
        scale = 1.0 if unit == self.unit else factor(field, unit, self.unit)
        return finite(
            field, float(f"{number * scale:.12g}"), self.low, self.high, "" if self.unit == "1" else self.unit
        )

    @property
    def allowed(self) -> str:
        """What is allowed, in words."""
        unit = "" if self.unit == "1" else f" {self.unit}, or with another unit of the same kind"
        return f"a number from {self.low:g} to {self.high:g}{unit}"


QUESTIONS: Mapping[str, Question] = {
    one.key: one
    for one in (
        Question("mass", "Mass of the robot with wheels and usual load, on a scale", "kg", 1.0, 1000.0),
        Question("wheel-radius", "Radius of a wheel, half of the diameter of its catalogue", "m", 0.01, 1.0),
        Question("wheel-distance", "From the centre of the base to the middle of a wheel's width", "m", 0.05, 5.0),
        Question("outline", f"Body from above, first corner or side as the robot looks along x: {OUTLINES}", ""),
        Question("height", "Height of the body's top above the floor", "m", 0.02, 5.0),
        Question("clearance", "Lowest height of the body above the floor", "m", 0.0, 1.0, needed=False),
        Question("com-height", "Height of the centre of mass; tilt the robot until it balances", "m", 0.01, 2.0, False),
        Question("torque-limit", "Largest torque of a drive at its wheel", "N.m", 0.01, 1000.0, False),
        Question("gear-friction", "Torque at the wheel that just turns the unpowered motor", "N.m", 0.0, 1000.0, False),
        Question(
            "torque-constant",
            "Torque per ampere of a motor whose current is the sensor",
            "N.m/A",
            1e-4,
            100.0,
            needed=False,
            otherwise="torque sensors",
        ),
        Question("gear-ratio", "Turns of that motor per turn of its wheel", "1", 1.0, 1000.0, False, "not known"),
        Question("torque-noise", "Standard deviation of the sensed torque at rest, at 1 kHz", "N.m", 0.0, 100.0, False),
        Question("encoder-counts", "Encoder counts per turn of the wheel", "1", 16, 1_000_000, False),
    )
}
"""By flag, in the order in which they are asked."""

EXAMPLES = {
    "mass": "34.7 kg", "wheel-radius": "4 in", "wheel-distance": "240 mm", "outline": "circle 0.45", "height": "75 cm",
}  # fmt: skip


@dataclass(frozen=True)
class Measured:
    """The answers, SI units; None: not known."""

    name: str
    mass: float
    wheel_radius: float
    wheel_distance: float
    outline: NDArray[np.float64]
    height: float
    clearance: float | None = None
    com_height: float | None = None
    torque_limit: float | None = None
    gear_friction: float | None = None
    torque_noise: float | None = None
    encoder_counts: float | None = None
    torque_constant: float | None = None
    gear_ratio: float | None = None
    imu: bool = False


def measured(
    name: str, answers: Mapping[str, str | None], imu: bool, ask: Callable[[Question], str | None]
) -> Measured:
    """The answers, checked; ``ask`` gives the text for a question that ``answers`` leaves open, or None."""
    found: dict[str, Any] = {}
    missing = []
    for key, question in QUESTIONS.items():
        text = answers.get(key)
        text = ask(question) if text is None and _applies(key, found) else text
        if text is None and question.needed:
            missing.append(key)
        found[key.replace("-", "_")] = None if text is None else question.read(f"--{key}", text)
    if missing:
        flags = ", ".join(f"--{key}" for key in missing)
        allowed = " ".join(f'--{key} "{EXAMPLES[key]}"' for key in missing)
        raise GivewayError(flags, "nothing", f"what the robot is, such as {allowed}; it is needed")
    _check_sensing(found)
    if found["clearance"] is not None and found["clearance"] >= found["height"]:
        raise GivewayError("--clearance", f"{found['clearance']:g} m", f"below --height, {found['height']:g} m")
    if found["com_height"] is not None and found["com_height"] >= found["height"]:
        raise GivewayError("--com-height", f"{found['com_height']:g} m", f"below --height, {found['height']:g} m")
    return Measured(name=name, imu=imu, **found)


def _applies(key: str, found: Mapping[str, Any]) -> bool:
    """Whether it is worth asking, after what was ``found``."""
    by_current = found.get("torque_constant") is not None
    return {"gear-ratio": by_current, "torque-noise": not by_current}.get(key, True)


def _check_sensing(found: Mapping[str, Any]) -> None:
    """A motor's current is a torque by constant and ratio; a torque sensor has neither."""
    needs = {"torque_constant": "gear_ratio", "gear_ratio": "torque_constant"}
    for key, other in needs.items():
        if found[key] is None and found[other] is not None:
            flag, stated = key.replace("_", "-"), other.replace("_", "-")
            raise GivewayError(f"--{flag}", "nothing", f"{QUESTIONS[flag].allowed}; with --{stated} it is needed")
    if found["torque_constant"] is not None and found["torque_noise"] is not None:
        allowed = "torque sensors; the noise of a current is motor.current_noise in the file"
        raise GivewayError("--torque-noise", f"{found['torque_noise']:g} N.m, with --torque-constant,", allowed)


def outline_of(field: str, text: str) -> NDArray[np.float64]:
    """Corners (n, 2), anticlockwise, m: ``circle 0.45``, ``triangle 0.61``, ``rectangle 0.5 x 0.4``, or the corners."""
    shape, _, rest = text.strip().partition(" ")
    sizes = {"circle": 1, "triangle": 1, "rectangle": 2}
    if shape in sizes:
        numbers = [_length(field, text, part) for part in re.split(r"\s*x\s*", rest.strip())]
        if len(numbers) != sizes[shape]:
            raise GivewayError(field, text, OUTLINES)
        return _shape(shape, numbers)
    try:
        corners = np.array([[float(x) for x in pair.split(",")] for pair in text.split()])
    except ValueError:
        raise GivewayError(field, text, OUTLINES) from None
    if corners.ndim != 2 or corners.shape[1] != 2 or not 3 <= len(corners) <= CORNERS_MAX:
        raise GivewayError(field, text, f"{OUTLINES}: 3 to {CORNERS_MAX} corners")
    for value in corners.ravel():
        finite(field, float(value), -10.0, 10.0, "m")
    if len(hull(corners)) != len(corners):
        raise GivewayError(field, text, "corners of a convex outline: none of them within the others")
    clockwise = _area(corners) < 0.0
    return corners[::-1] if clockwise else corners


def _length(field: str, text: str, part: str) -> float:
    found = NUMBER.fullmatch(part)
    if found is None:
        raise GivewayError(field, text, OUTLINES)
    scale = factor(field, (found[2] or "m").strip(), "m")
    return finite(field, float(f"{float(found[1]) * scale:.12g}"), 0.01, 10.0, "m")


def _shape(shape: str, sizes: list[float]) -> NDArray[np.float64]:
    if shape == "rectangle":
        x, y = 0.5 * sizes[0], 0.5 * sizes[1]
        return np.array([[x, -y], [x, y], [-x, y], [-x, -y]])
    count = 3 if shape == "triangle" else CIRCLE_CORNERS
    radius = sizes[0] / math.sqrt(3.0) if shape == "triangle" else 0.5 * sizes[0] / math.cos(math.pi / count)
    angles = 2.0 * math.pi * np.arange(count) / count
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _area(corners: NDArray[np.float64]) -> float:
    x, y = corners.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
