"""The package keeps the conventions of the Modelica Standard Library, and the lint sees when it does not."""

import shutil
from pathlib import Path

import giveway
import pytest
from giveway_modelica.compiler import PACKAGE, classes
from giveway_modelica.lint import findings
from giveway_modelica.statements import declarations


def test_the_package_keeps_the_conventions() -> None:
    assert list(findings()) == []


FAULTS = {
    "within": ("Components/Motor.mo", "within GiveWay.Components;", "within GiveWay.Sources;", "first line"),
    "two classes": ("Components/Motor.mo", "end Motor;", "end Motor;\nmodel Other\nend Other;", "Other"),
    "file name": ("Components/Motor.mo", "Motor", "Engine", "not Motor alone"),
    "order": ("Components/package.order", "Motor\n", "", "Motor"),
    "order of nothing": ("Sources/package.order", "Push\n", "Push\nPull\n", "Pull"),
    "unit": ("Components/DiscContact.mo", 'Real mu(unit="1")', "Real mu", "mu is a Real without a unit"),
    "plain Real": ("Components/Motor.mo", "SI.Torque tau_net", "Real tau_net", "tau_net is a Real without a unit"),
    "description": ("Components/Motor.mo", ' "Largest torque of the motor"', "", "limit has no description"),
    "protected": ("Functions/closestPoint.mo", ' "Number of corners"', "", "n has no description"),
    "class description": ("Components/Motor.mo", ' "Motor behind a gear', ' /* "Motor behind a gear', "no description"),
    "documentation": ("Components/Motor.mo", "Documentation(info=", "Documentation(revisions=", "no documentation"),
    "HTML": ("Components/Motor.mo", "</p>\n</html>", "</html>", "not closed"),
    "empty HTML": ("Components/Load.mo", "<p>", "<p></p><!--", "says nothing"),
    "icon": ("Components/Motor.mo", "%name", "name", "no icon"),
    "experiment": ("Examples/BumperDrop.mo", "experiment(StopTime=", "experiment(StartTime=", "no experiment"),
    "example": ("Examples/BumperDrop.mo", "  extends Modelica.Icons.Example;\n", "", "does not extend"),
    "place": (
        "Components/Testbed.mo",
        "Placement(transformation(extent",
        "Place(transformation(extent",
        "no Placement",
    ),
    "place of a connector": ("Components/Motor.mo", "Placement(", "Place(", "flange has no Placement"),
    "line": ("Components/Testbed.mo", "annotation (Line(", "annotation (Lines(", "no Line"),
    "version": ("package.mo", f'version="{giveway.__version__}"', 'title="x"', "version="),
    "uses": ("package.mo", "uses(", "used(", "uses"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_the_lint_sees_a_planted_fault(tmp_path: Path, fault: str) -> None:
    package = tmp_path / "GiveWay"
    shutil.copytree(PACKAGE, package)
    name, healthy, sick, message = FAULTS[fault]
    path = package / name
    assert healthy in path.read_text()
    path.write_text(path.read_text().replace(healthy, sick))
    found = list(findings(package))
    assert any(message in text for text in found), found


def test_every_declaration_is_read() -> None:
    found = {one.name: declarations(one.text, one.name.rsplit(".", 1)[1]) for one in classes() if "." in one.name}
    assert sum(len(one) for one in found.values()) > 500
    motor = {one.name: one.type for one in found["GiveWay.Components.Motor"]}
    assert motor["tau_net"] == "SI.Torque"
    assert motor["direction"] == "Integer"
    assert "n" in {one.name for one in found["GiveWay.Functions.closestPoint"]}
