"""The dummy with each of the other bumpers hits the unpowered robot, in Modelica and in the testbed FMU."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import pytest
from giveway_modelica.agreement import SMOOTH, heights, signals
from giveway_modelica.compiler import Compiler, simulated
from giveway_modelica.fmu_runs import LAWS, LEVER_KG, RUNS, TABLE, TESTBED, TOLERANCE, Alone

STOP_S = 0.6


def braces(values: Iterable[object]) -> str:
    """A list in Modelica."""
    return "{" + ", ".join(map(str, values)) + "}"


# As LAWS, for the models.
SET: Mapping[str, Mapping[str, float | str]] = {
    "Foam": {},
    "Gas": {"f_0": 20, "f_ambient": 100, "n": 1.3},
    "Damper": {"k": 200, "f_pre": 4, "d_1": 60, "d_2": 40, "rebound": 3},
    "Series": {"k": 600, "k_2": 2500, "f_pre_2": 15},
    "Lever": {"k": 400, "m_lever": LEVER_KG},
    "Table": {"travels": braces(TABLE[0]), "speeds": braces(TABLE[1]), "forces": braces(map(braces, TABLE[2]))},
}


def collision(compiler: Compiler, law: str, **changes: float | str) -> Any:
    values = ", ".join(f"{name}={value}" for name, value in {**SET[law], **changes}.items())
    text = (
        "  GiveWay.Components.Robot robot;\n"
        f"  GiveWay.Components.{law}Dummy dummy(slider(bumper({values})));\n"
        "equation\n  connect(robot.frame, dummy.frame);\n  robot.tau_ref = zeros(3);\n"
    )
    return simulated(compiler.load_text(text, f"dummy {law} {values}"), STOP_S, TOLERANCE)


def beside(law: str) -> Any:
    latched = RUNS["LatchRelease"]
    assert isinstance(latched, Alone)
    lever = {"bumper.lever_mass": LEVER_KG} if law == "Lever" else {}
    return Alone("testbed", {**TESTBED, **LAWS[law], **lever}, latched.inputs, latched.outputs).run(STOP_S)


@pytest.mark.parametrize(
    ("law", "fault"),
    [
        pytest.param("Foam", {"h": 0.15001}, marks=pytest.mark.deep),
        pytest.param("Gas", {"n": 1.3001}, marks=pytest.mark.deep),
        pytest.param("Damper", {"d_2": 40.01}, marks=pytest.mark.deep),
        pytest.param("Series", {"travel_1": 0.030005}, marks=pytest.mark.deep),
        ("Lever", {"m_lever": 0.3005}),
        pytest.param("Table", {"travels": "{0, 0.02, 0.05001, 0.09, 0.13}"}, marks=pytest.mark.deep),
    ],
)
def test_the_collision_is_that_of_the_testbed(compiler: Compiler, law: str, fault: dict[str, float | str]) -> None:
    reference, compared = beside(law), signals("LatchRelease")
    assert reference["truth.bumper_compression"].max() > 0.05
    found = heights(collision(compiler, law), reference, compared)
    assert max(found.values()) < SMOOTH, found
    wrong = heights(collision(compiler, law, **fault), reference, compared)
    assert max(wrong.values()) > SMOOTH, wrong
