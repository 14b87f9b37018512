"""What `make verify` compares with the plant are the package's equations, copied into small models."""

import re
from pathlib import Path

import pytest
from giveway_modelica.compiler import PACKAGE

SUBSET = Path(__file__).parents[2] / "verify" / "modelica"
# Equation of the small model -> the class of the package that has it.
COPIES = {
    "Bumper": {
        "f_spring": "Interfaces/PartialSpringBumper",
        "f_bottom": "Interfaces/PartialSpringBumper",
        "f_end": "Components/MagneticBumper",
        "f_magnet": "Components/MagneticBumper",
    },
    "Contact": {"f_normal": "Components/DiscContact", "f_friction": "Components/DiscContact"},
}
# Names that the package gives to what the small models write out.
RENAMED = {"touching": "depth > 0"}


def equation(path: Path, left: str) -> str:
    """The right side, without what only steers events."""
    found = re.search(rf"^  {left} = (.*?);", path.read_text(), re.MULTILINE | re.DOTALL)
    assert found, (path, left)
    bare = found[1].replace("noEvent", "")
    for name, meaning in RENAMED.items():
        bare = re.sub(rf"\b{name}\b", meaning, bare)
    return re.sub(r"[\s()]", "", bare)


@pytest.mark.parametrize(("model", "left"), [(model, left) for model, found in COPIES.items() for left in found])
def test_the_small_model_has_the_packages_equation(model: str, left: str) -> None:
    assert equation(SUBSET / f"{model}.mo", left) == equation(PACKAGE / f"{COPIES[model][left]}.mo", left)
