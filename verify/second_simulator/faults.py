"""Faults that can be planted in the second robot; without MuJoCo, for the rung."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["FAULTS"]

FAULTS: Mapping[str, tuple[str, str, Mapping[str, float]]] = {
    "a floor that is softer by 5 %": ("weight", "sag", {"wheel.floor_stiffness": 0.95}),
    "rollers that hold by a tenth more": (
        "static push",
        "share of a static push",
        {"roller.presliding_stiffness[*]": 1.1},
    ),
    "rollers with a tenth more friction": ("drag and inertia", "rollers' friction", {"roller.coulomb_torque": 1.1}),
    "a base with 5 % more mass": ("drag and inertia", "inertia while accelerating", {"base.mass": 1.05}),
    "a rotor with 5 % more inertia": ("gear", "rotor's speed", {"drivetrain.motor_inertia": 1.05}),
    "a slider with 2 % less mass": ("hit", "impulse of a hit", {"slider.mass": 0.98}),
}
"""What is wrong: the check and the finding that have to see it, and factors of the model's parameters."""
