"""`giveway fmu info` and `giveway fmu run`: any FMU, both interfaces and versions; the run is that of the FMU."""

from __future__ import annotations

import csv
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from figure_labels import check_panels, check_planted, curve
from giveway.base import native
from giveway.base.errors import FileError, GivewayError, SimulationError
from giveway.cli import _main
from giveway.fmu_tools import page as run_page
from giveway.fmu_tools.archive import Archive, ArchiveError
from giveway.fmu_tools.description import read_description
from giveway.fmu_tools.inputs import read_inputs
from giveway.fmu_tools.run import run_fmu
from giveway.robot.variables import table as variable_table
from giveway.simulation.fmu import Instance, open_fmu
from stub_fmus import VARIABLES_3, description_3, entry, files, library, pack

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
    time = np.array([float(row["time [s]"]) for row in rows])
    assert time[-1] == pytest.approx(0.2)
    assert len(rows) >= 101
    torque = np.array([float(row["sensor.torque [N.m]"]) for row in rows])
    assert np.ptp(torque) > 0.1
    page = (tmp_path / "run.html").read_text()
    assert page.count('class="drawn"') >= 3  # one plot per unit that moves
    assert "sensor.torque" in _labels(page)
    assert not re.search(r"(?:src|href)=", page.split("<main")[1].split("</main>")[0]), "self-contained"


def test_it_is_what_the_fmu_does_by_itself() -> None:
    """The compression follows the input exactly, so the run is the FMU's and not the plotter's."""
    run = run_fmu(native.fmu("bumper", 3), "cs", 0.1, 0.001, DRIVE)
    assert (run.interface, run.units["carrier.force"]) == ("CoSimulation", "N")
    steps = 0.2 * 0.001  # a step moves the face by its velocity, then it is where the input says
    np.testing.assert_allclose(run.traces["compression"][1:], steps, rtol=1e-9)
    for unit, name in (("m", "compression"), ("N", "carrier.force")):
        figure = run_page._figure(run.traces, unit, [name])
        assert figure.axes[0].get_ylabel() == unit
        figure.axes[0].set_ylabel(f"({unit})")  # as labels of other figures have it
        wanted = [curve(run.traces["time"], "s", run.traces[name], unit)]
        check_planted(figure, lambda figure=figure, wanted=wanted: check_panels(figure, [wanted]))


@pytest.mark.parametrize(("most_steps", "step_s"), [(100, 0.001), (99, 0.002), (10, 0.016)])
def test_the_fmus_own_step_is_doubled_until_there_are_few_enough(most_steps: int, step_s: float) -> None:
    run = run_fmu(native.fmu("bumper", 3), "cs", 0.1, most_steps=most_steps)
    assert run.step_s == pytest.approx(step_s, rel=1e-12)
    assert len(run.traces) == math.ceil(0.1 / step_s - 1e-9) + 1
    said = f"steps of {step_s:g} s, not 0.001 s: those would be more than {most_steps} (--step, --max-steps)"
    assert run.note == ("" if step_s == 0.001 else said)


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
        ({"assignments": ["bumper.kind=1.5"]}, "a whole number from 1 to 8"),
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
    assert _main(["fmu", "info", str(native.fmu("testbed", 3)), "--grep", "Spring force at full extension"]) == 0
    said = capsys.readouterr().out
    for words in (
        "Co-Simulation, Model Exchange",
        "x86_64-linux (glibc 2.",
        "1 variables",
        "0.0 to 10000.0",
        "giveway testbed",
    ):
        assert words in said


# --- Inputs over time, and what is drawn

# y follows u, and steps counts: what is drawn by default is y.
BODIES = (
    ("fmi3SetFloat64", "if (*vr == 1) input = *value; return 0;"),
    (
        "fmi3GetFloat64",
        "for (size_t i = 0; i < n; ++i) value[i] = vr[i] == 4 ? 2 * input : vr[i] == 1 ? input : 7; return 0;",
    ),
    ("fmi3GetInt32", "*value = ++count; return 0;"),
)
SIGNATURES = {
    "fmi3SetFloat64(void)": "fmi3SetFloat64(void *c, const unsigned *vr, size_t n, const double *value, size_t m)",
    "fmi3GetInt32(void)": "fmi3GetInt32(void *c, const unsigned *vr, size_t n, int *value, size_t m)",
}


@pytest.fixture(scope="module")
def follower(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An FMU whose output y is twice its input u, and whose output steps counts how often it is asked."""
    binary = library(3, BODIES, extra="static double input; static int count;", signatures=tuple(SIGNATURES.items()))
    return pack(tmp_path_factory.mktemp("follower") / "follower.fmu", files(binary=binary))


def _inputs(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def test_inputs_come_from_a_file(follower: Path, tmp_path: Path) -> None:
    """Between rows reals are interpolated; where the time stands still they jump."""
    inputs = _inputs(tmp_path / "in.csv", "time [s],u [N],on\n0,0,false\n0.5,1,true\n0.5,3,true\n1,3,0\n")
    run = run_fmu(follower, inputs=inputs)
    # A step takes the input at its beginning; at 0.5 s that is the value after the jump.
    before = np.concatenate([[0.0], np.arange(0.0, 0.45, 0.1) * 2.0, np.full(5, 3.0)])
    np.testing.assert_allclose(run.traces["y"], 2.0 * before, rtol=1e-12, atol=1e-12)


def test_an_integer_input_may_have_64_bits(tmp_path: Path) -> None:
    variables = f'{VARIABLES_3}<Int64 name="counts" valueReference="9" causality="input" start="0"/>'
    described = read_description(description_3(variables=variables).encode())
    found = read_inputs(_inputs(tmp_path / "in.csv", "time,counts\n0,1\n1,1099511627776\n"), described)
    assert found["counts"].tolist() == [1, 2**40]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "has no row of values"),
        ("time,u\n", "has no row of values"),
        ("t,u\n0,1\n", ":1: first column: t is not allowed; allowed: time or time [s]"),
        ("time [ms],u\n0,1\n", ":1: first column: time [ms]"),
        ("time,v\n0,1\n", ":1: column: v is unknown"),
        ("time,y\n0,1\n", ":1: column: y is unknown"),
        ("time,u [kN]\n0,1\n", ":1: unit of u: kN is not allowed; allowed: N"),
        ("time,u,u\n0,1,2\n", "two columns of the same name"),
        ("time,u\n0,1\n1\n", ":3: row: 1 cells is not allowed; allowed: 2"),
        ("time,u\n0,1\n\n-1,1\n", ":4: time: -1 is not allowed"),
        ("time,u\n0,nan\n", ":2: u: nan is not allowed"),
        ("time,on\n0,maybe\n", ":2: on: maybe is not allowed; allowed: true or false"),
    ],
)
def test_an_input_file_that_is_wrong_is_named_with_its_line(
    text: str, words: str, follower: Path, tmp_path: Path
) -> None:
    path = _inputs(tmp_path / "in.csv", text)
    with pytest.raises(GivewayError) as caught:
        run_fmu(follower, inputs=path)
    assert str(caught.value).startswith(str(path))
    assert words in str(caught.value)


def test_an_input_file_that_is_not_there_is_named(follower: Path, tmp_path: Path) -> None:
    with pytest.raises(GivewayError, match="no such file"):
        run_fmu(follower, inputs=tmp_path / "none.csv")


def test_columns_carry_units_and_can_be_read_again(follower: Path, tmp_path: Path) -> None:
    out = tmp_path / "run.csv"
    assert _main(["fmu", "run", str(follower), "--plot", "u", "--set", "u=1", "--out", str(out)]) == 0
    lines = out.read_text().splitlines()
    assert lines[0] == "time [s],u [N],y [N],steps"
    again = tmp_path / "again.csv"
    again.write_text("\n".join(",".join(line.split(",")[:2]) for line in lines) + "\n")
    run = run_fmu(follower, inputs=again)
    assert len(run.traces) == 11


def _page_of(follower: Path, out: Path, *options: str) -> str:
    inputs = _inputs(out.with_name("in.csv"), "time,u\n0,0\n1,1\n")
    arguments = ["fmu", "run", str(follower), "--input", str(inputs), *options, "--out", str(out)]
    assert _main(arguments) == 0
    return out.read_text()


def _labels(page: str) -> set[str]:
    """What the plots say: curves, and units of their axes."""
    data = json.loads(page.split('id="data">')[1].split("</script>")[0])
    panels = [panel for figure in data["figures"] for panel in figure["axes"]]
    curves = {line["label"] for panel in panels for line in panel["lines"]}
    return curves | {panel["y"]["label"] for panel in panels}


def test_outputs_are_drawn_and_counters_are_not(follower: Path, tmp_path: Path) -> None:
    page = _page_of(follower, tmp_path / "run.html")
    assert page.count('class="drawn"') == 1
    assert {"y", "N"} <= _labels(page)
    assert "steps" not in _labels(page)
    assert "<h2>Not drawn</h2><p>steps (--plot NAME draws them)</p>" in page
    assert "more, in the CSV" not in page


def test_the_user_says_what_is_drawn(follower: Path, tmp_path: Path) -> None:
    page = _page_of(follower, tmp_path / "run.html", "--plot", "s*", "--plot", "?")
    assert {"y", "u", "steps"} <= _labels(page)
    assert "Not drawn" not in page
    with pytest.raises(GivewayError, match=r"--plot: stops is unknown.*did you mean steps"):
        run_fmu(follower, plot=["stops"])


def test_counters_are_drawn_if_there_is_nothing_else(follower: Path, tmp_path: Path) -> None:
    out = tmp_path / "run.html"
    assert _main(["fmu", "run", str(follower), "--out", str(out)]) == 0
    assert "steps" in _labels(out.read_text())


def test_real_outputs_of_the_testbed_come_before_its_switches(tmp_path: Path) -> None:
    out = tmp_path / "run.html"
    assert _main(["fmu", "run", str(native.fmu("testbed", 3)), "--stop", "0.3", "--out", str(out)]) == 0
    page = out.read_text()
    assert "solver.steps" not in _labels(page)
    assert "truth.vx" in _labels(page) or "truth.x" in _labels(page)
    listed = page.split("<h2>Not drawn</h2>")[1].split("</p>")[0]
    assert "solver.steps" in listed


def test_a_library_for_another_processor_is_not_loaded(tmp_path: Path) -> None:
    binary = bytearray(library(3))
    assert binary[:4] == b"\x7fELF"
    binary[18:20] = (183 if binary[18] == 62 else 62).to_bytes(2, "little")  # AArch64 and x86-64
    path = pack(tmp_path / "other.fmu", files(binary=bytes(binary)))
    with pytest.raises(FileError, match=r"cannot be run: .* is for "):
        run_fmu(path)


def test_a_unit_without_base_units_has_factor_one() -> None:
    """And what another part of the description calls Output is none."""
    text = description_3().replace("</UnitDefinitions>", '<Unit name="piece"/></UnitDefinitions>')
    annotation = '<Annotations><Output valueReference="5"/></Annotations>'
    text = text.replace("<DefaultExperiment", f"{annotation}<DefaultExperiment")
    description = read_description(text.encode())
    assert [unknown.key for unknown in description.outputs] == [3, 4]
    piece = next(unit for unit in description.units if unit.name == "piece")
    assert (piece.base, piece.factor) == (None, 1.0)


def test_a_name_that_ends_early_is_not_unpacked_for_what_it_began_with(tmp_path: Path) -> None:
    """Python's zipfile cuts a name at its first zero byte; other programs do not."""
    path = pack(tmp_path / "cut.fmu", files(), [entry("aXbb/../../x")])
    path.write_bytes(path.read_bytes().replace(b"aXbb/../../x", b"a\0bb/../../x"))
    (tmp_path / "out").mkdir()
    with Archive(path) as archive, pytest.raises(ArchiveError, match="leads elsewhere"):
        archive.extract(tmp_path / "out")
    assert not (tmp_path / "out" / "a").exists()
