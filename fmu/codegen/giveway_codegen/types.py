"""Types of variables: a physical quantity with its unit, bounds and typical size."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .units import default_display_unit

__all__ = ["Quantity", "quantity_of"]


@dataclass(frozen=True)
class Quantity:
    """A type definition; ``kind`` is the variables' type, ``quantity`` the physical quantity's name.

    Variables with another display unit than usual for their quantity have a separate type, "Position.mm".
    """

    name: str
    kind: str
    quantity: str | None
    unit: str | None
    minimum: float | None
    nominal: float | None
    description: str
    own_display_unit: str | None = None

    @property
    def display_unit(self) -> str | None:
        return self.own_display_unit or default_display_unit(self.unit)

    def shown_in(self, display_unit: str | None) -> Quantity:
        """The type with this display unit."""
        if display_unit in (None, self.display_unit):
            return self
        description = f"{self.description}, shown in {display_unit}"
        return replace(self, name=f"{self.name}.{display_unit}", description=description, own_display_unit=display_unit)


# unit -> quantity, name and description of the signed type, of the unsigned type, typical magnitude for a robot. A
# variable has the unsigned type if its own range is not negative.
_REALS: dict[str, tuple[str, tuple[str, str], tuple[str, str], float]] = {
    "1": ("Dimensionless", ("SignedNumber", "Number"), ("Ratio", "Number that is not negative"), 1.0),
    "1/s": ("Rate", ("SignedRate", "Rate"), ("Rate", "Rate that is not negative"), 1.0),
    "Hz": ("Frequency", ("SignedFrequency", "Frequency"), ("Frequency", "Frequency"), 1.0),
    "J": ("Energy", ("Energy", "Energy"), ("EnergyMagnitude", "Energy that is not negative"), 1.0),
    "N": ("Force", ("Force", "Force"), ("ForceMagnitude", "Magnitude of a force"), 10.0),
    "N.m": ("Torque", ("Torque", "Torque"), ("TorqueMagnitude", "Magnitude of a torque"), 1.0),
    "N.m.s/rad": (
        "RotationalDampingConstant",
        ("SignedRotationalDamping", "Rotational damping"),
        ("RotationalDamping", "Rotational damping"),
        1.0,
    ),
    "N.m/rad": (
        "RotationalSpringConstant",
        ("SignedRotationalStiffness", "Rotational stiffness"),
        ("RotationalStiffness", "Rotational stiffness"),
        100.0,
    ),
    "N.s": ("Impulse", ("Impulse", "Impulse"), ("ImpulseMagnitude", "Magnitude of an impulse"), 1.0),
    "N.s/m": (
        "TranslationalDampingConstant",
        ("SignedDamping", "Damping"),
        ("Damping", "Damping"),
        10.0,
    ),
    "N.s2/m2": (
        "QuadraticDampingConstant",
        ("SignedQuadraticDamping", "Force per squared speed"),
        ("QuadraticDamping", "Force per squared speed"),
        10.0,
    ),
    "N/m": (
        "TranslationalSpringConstant",
        ("SignedStiffness", "Stiffness"),
        ("Stiffness", "Stiffness"),
        1e4,
    ),
    "kg": ("Mass", ("SignedMass", "Mass"), ("Mass", "Mass"), 10.0),
    "kg.m2": ("MomentOfInertia", ("SignedInertia", "Moment of inertia"), ("Inertia", "Moment of inertia"), 1.0),
    "m": ("Length", ("Position", "Coordinate or distance with a sign"), ("Length", "Length"), 0.1),
    "m/s": ("Velocity", ("Velocity", "Velocity"), ("Speed", "Magnitude of a velocity"), 0.1),
    "m/s2": ("Acceleration", ("Acceleration", "Acceleration"), ("AccelerationLimit", "Magnitude of it"), 1.0),
    "rad": ("Angle", ("Angle", "Angle"), ("AngleMagnitude", "Angle without sign"), 1.0),
    "rad/s": ("AngularVelocity", ("AngularVelocity", "Angular velocity"), ("AngularSpeed", "Magnitude of it"), 1.0),
    "rad/s2": (
        "AngularAcceleration",
        ("AngularAcceleration", "Angular acceleration"),
        ("AngularAccelerationLimit", "Magnitude of it"),
        1.0,
    ),
    "s": ("Time", ("SignedTime", "Time, or difference of times"), ("Duration", "Time that is not negative"), 0.1),
    "s/m": ("Slowness", ("SignedSlowness", "Time per way"), ("Slowness", "Time per way"), 1.0),
    "s/rad": (
        "AngularSlowness",
        ("SignedAngularSlowness", "Time per angle"),
        ("AngularSlowness", "Time per angle"),
        1.0,
    ),
}


def quantity_of(kind: str, unit: str | None, minimum: float | None) -> Quantity | None:
    """The type of a variable with this type, unit and lower bound; None: it has no definition."""
    signless = minimum is not None and minimum >= 0
    if kind == "integer":
        if signless:
            return Quantity("Count", "integer", None, None, 0, None, "Count or choice")
        return Quantity("Integer", "integer", None, None, None, None, "Integer of 32 bits")
    if kind == "boolean":
        return Quantity("Flag", "boolean", None, None, None, None, "Yes or no")
    if unit not in _REALS:
        base = (unit or "").removesuffix("/s")
        if base == unit or base not in _REALS:
            return None
        _, (name, description), _, nominal = _REALS[base]  # of a derivative
        return Quantity(f"RateOf{name}", "real", None, unit, None, nominal, f"{description}, per second")
    quantity, signed, magnitude, nominal = _REALS[unit]
    name, description = magnitude if signless else signed
    return Quantity(name, "real", quantity, unit, 0.0 if signless else None, nominal, description)
