"""examples/c_master: the C program that couples both FMUs gives the bits of our own master."""

from __future__ import annotations

import dataclasses
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from giveway import experiments
from giveway.base import native
from giveway.robot.variables import table
from giveway.simulation.fmu import open_fmu
from giveway.simulation.master import simulate

ROOT = Path(__file__).parents[2]
BUILD = Path(os.environ.get("GIVEWAY_BUILD_DIR", ROOT / "build"))
PROGRAM = BUILD / "examples" / "c_master" / "c_master"
RECORDED = ("truth.x", "truth.slider_position", "truth.contact_force", "truth.wheel_torque[1]", "energy.dissipated")
PARAMETERS = ("testbed.bumper.kind=2", "controller.supervisor.after_settled=0")  # of the scenario below


def folders() -> list[str]:
    return [str(open_fmu(native.fmu(model, 3)).folder) for model in native.MODELS]


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False, timeout=60)


def test_it_gives_the_bits_of_our_own_master() -> None:
    scenario = dataclasses.replace(experiments.get("motionless").scenario("magnetic"), duration_s=0.6)
    assert scenario.parameters("controller") == {"supervisor.after_settled": 0}
    assert scenario.parameters("testbed") == {"slider.present": True, "bumper.kind": 2}  # a slider is there by default
    record = simulate(scenario)
    chosen = [word for name in RECORDED for word in ("--record", name)]
    done = run(*folders(), "--seconds", "0.6", *chosen, *PARAMETERS)
    assert done.returncode == 0, done.stderr
    header, *lines = done.stdout.splitlines()
    variables = table("testbed")
    assert header == ",".join(("time [s]", *(f"{name} [{variables[name].unit}]" for name in RECORDED)))
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    ours = np.column_stack([record.time_s, *(record.traces[f"testbed.{name}"] for name in RECORDED)])
    assert rows.shape == ours.shape
    assert np.abs(ours[:, 3]).max() > 1.0, "nothing was hit"
    assert rows.tobytes() == ours.tobytes()
    # The planted fault: with another bumper the comparison must not hold.
    other = run(*folders(), "--seconds", "0.6", *chosen, "testbed.bumper.kind=1", PARAMETERS[1])
    assert other.stdout.splitlines()[0] == header
    assert other.stdout != done.stdout


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        ((), 2, "usage: c_master CONTROLLER TESTBED"),
        (("/nowhere", "/nowhere"), 1, "unzip the FMU into that folder first"),
        (("C", "T", "--repeat", "0"), 2, "--repeat must be from 1"),
        (("C", "T", "--seconds", "nan"), 2, "--seconds must be above 0"),
        (("C", "T", "what=1"), 2, "what=1"),
        (("C", "T", "testbed.bumper.mood=1"), 1, "testbed has no variable bumper.mood"),
        (("C", "T", "testbed.slider.mass=-1"), 1, "variable slider.mass is -1, but must be"),
    ],
)
def test_wrong_input_is_said(arguments: tuple[str, ...], code: int, text: str) -> None:
    names = dict(zip("CT", folders(), strict=True))
    done = run(*(names.get(argument, argument) for argument in arguments))
    assert done.returncode == code
    assert text in done.stderr
