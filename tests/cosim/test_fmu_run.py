"""`giveway fmu info` and `giveway fmu run`: any FMU, both interfaces and versions; the run is that of the FMU."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from giveway import native
from giveway.cli import _main
from giveway.errors import GivewayError, SimulationError
from giveway.fmu import Instance, open_fmu
from giveway.fmu_run import run_fmu
from giveway.variables import table as variable_table

DRIVE = ["carrier.velocity=0.2", "bumper.kind=1"]  # the carrier's face moves into the plate's


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("interface", ["cs", "me"])
def test_a_run_is_written_as_csv_and_as_a_page(version: int, interface: str, tmp_path: Path) -> None:
    file = str(native.fmu("drivetrain", version))
    options = ["--interface", interface, "--stop", "0.2", "--step", "0.002"]
    for name in ("run.csv", "run.html"):
        assert _main(["fmu", "run", file, *options, "--set", "motor.torque=6", "--out", str(tmp_path / name)]) == 0
    with (tmp_path / "run.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    time = np.array([float(row["time"]) for row in rows])
    assert time[-1] == pytest.approx(0.2)
    assert len(rows) >= 101
    torque = np.array([float(row["sensor.torque"]) for row in rows])
    assert np.ptp(torque) > 0.1
    page = (tmp_path / "run.html").read_text()
    assert page.count("<svg") >= 3  # one plot per unit that moves
    assert "sensor.torque" in page
    assert "http://" not in page.replace("http://www.w3.org", ""), "self-contained"


def test_it_is_what_the_fmu_does_by_itself() -> None:
    """The compression follows the input exactly, so the run is the FMU's and not the plotter's."""
    run = run_fmu(native.fmu("bumper", 3), "cs", 0.1, 0.001, DRIVE)
    assert (run.interface, run.units["carrier.force"]) == ("CoSimulation", "N")
    steps = 0.2 * 0.001  # a step moves the face by its velocity, then it is where the input says
    np.testing.assert_allclose(run.traces["compression"][1:], steps, rtol=1e-9)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"stop_s": -1.0}, "--stop: -1.0 is not allowed"),
        ({"stop_s": float("nan")}, "--stop: nan is not allowed"),
        ({"step_s": 0.0}, "--step: 0.0 is not allowed"),
        ({"step_s": 1e-8}, "no more than 2000000 steps"),
        ({"interface": "se"}, "--interface: se is not allowed; allowed: cs or me"),
        ({"assignments": ["bumper.preload"]}, "NAME=VALUE"),
        ({"assignments": ["bumper.preloud=1"]}, "did you mean bumper.preload"),
        ({"assignments": ["bumper.preload=-1"]}, "bumper.preload: -1 is not allowed; allowed: a finite number from 0"),
        ({"assignments": ["bumper.kind=1.5"]}, "a whole number from 1 to 2"),
        ({"assignments": ["compression=1"]}, "compression is unknown"),
    ],
)
def test_wrong_input_is_named(arguments: dict, text: str) -> None:
    with pytest.raises(GivewayError) as caught:
        run_fmu(native.fmu("bumper", 2), **arguments)
    assert text in str(caught.value)


@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_that_refuses_says_why(version: int) -> None:
    """Each value is within its bounds; together they are not, and the FMU's own words come through."""
    for _ in range(2):
        with pytest.raises(SimulationError, match="each of 0, 1 and 2 exactly once"):
            run_fmu(native.fmu("controller", version), None, 0.1, None, ["geometry.wheel_slot[0]=1"])
    # Nor does it take the messages of an instance of ours, before or after.
    table = variable_table("controller")
    with (
        Instance(open_fmu(native.fmu("controller", version)), "controller") as instance,
        pytest.raises(SimulationError, match="each of 0, 1 and 2 exactly once"),
    ):
        instance.initialise({"geometry.wheel_slot[0]": 1}, table)


def test_an_ending_that_means_nothing_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "run.txt"
    assert _main(["fmu", "run", str(native.fmu("bumper", 2)), "--out", str(out)]) == 2
    assert "a file that ends in .csv or .html" in capsys.readouterr().err


def test_info_says_what_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert _main(["fmu", "info", str(native.fmu("testbed", 3)), "--grep", "bumper.preload"]) == 0
    said = capsys.readouterr().out
    for words in (
        "Co-Simulation, Model Exchange",
        "x86_64-linux (glibc 2.",
        "1 variables",
        "0.0 to 10000.0",
        "giveway testbed",
    ):
        assert words in said
