"""What `make verify` compares with the plant are the package's equations, copied into small models."""

import re
from pathlib import Path

import pytest
from giveway_modelica.compiler import PACKAGE

SUBSET = Path(__file__).parents[2] / "verify" / "modelica"
# Equation of the small model -> the class of the package that has it.
COPIES = {
    "Drivetrain": {
        "wind_up": "Components/TorqueSensorSpring",
        "tau_s": "Components/TorqueSensorSpring",
        "tau_net": "Components/Motor",
        "J*der(w)": "Components/Motor",
        "der(phi)": "Components/Motor",
        "f": "Components/TanhRoller",
    },
    "Bumper": {
        "f_spring": "Interfaces/PartialSpringBumper",
        "f_bottom": "Interfaces/PartialGuidedBumper",
        "f_end": "Components/MagneticBumper",
        "f_magnet": "Components/MagneticBumper",
    },
    "Contact": {"f_normal": "Components/DiscContact", "f_friction": "Components/DiscContact"},
}
# What the package says by name, by a connector or by a mode, and the small models write out.
RENAMED = {
    "Components/DiscContact": {"touching": "depth > 0"},
    "Components/TorqueSensorSpring": {"motor.phi": "phi", "wheel.phi": "q", "der(wind_up)": "(w - w_w)"},
    "Components/Motor": {"+ flange.tau": "- tau_s", "if direction == 0 then 0 else ": ""},  # sliding, on the sensor
    "Components/TanhRoller": {"coulomb": "B_r", "slope*v": "slope*w_w"},
}


def equation(folder: Path, name: str, left: str) -> str:
    """The right side, without what only steers events."""
    found = re.search(rf"^  {re.escape(left)} = (.*?);", (folder / f"{name}.mo").read_text(), re.MULTILINE | re.DOTALL)
    assert found, (name, left)
    bare = found[1].replace("noEvent", "")
    for said, meant in RENAMED.get(name, {}).items():
        bare = bare.replace(said, meant)
    return re.sub(r"[\s()]", "", bare)


@pytest.mark.parametrize(("model", "left"), [(model, left) for model, found in COPIES.items() for left in found])
def test_the_small_model_has_the_packages_equation(model: str, left: str) -> None:
    assert equation(SUBSET, model, left) == equation(PACKAGE, COPIES[model][left], left)
