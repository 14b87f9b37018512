"""What a newcomer may type wrong: one line that names it, exit code 2, and nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest
from cosim_helpers import Cli, folder_content
from giveway.base import native
from giveway.cli import main as cli_main

RUN = ("run", "motionless", "--out", "out/run")
WRONG = {
    "unknown experiment": (
        ("run", "motionles", "--out", "out/run"),
        ("motionles", "a scenario file (TOML)", "did you mean motionless?"),
    ),
    "unknown bumper": ((*RUN, "--bumper", "magnetc"), ("--bumper", "magnetc", "foam, gas", "did you mean magnetic?")),
    "negative mass": ((*RUN, "--set", "testbed.base.mass=-3"), ("testbed.base.mass", "-3", "kg")),
    "unknown variable": ((*RUN, "--set", "testbed.base.mas=3"), ("base.mas", "did you mean base.mass")),
    "plan too fast for a limit that is set": (
        (*("run", "moving", "--out", "out/run"), "--set", "controller.reference.speed_limit=0.1"),
        ("giveway: plan.speed: 0.22 is not allowed", "at most 0.1 m/s, controller.reference.speed_limit"),
    ),
    "unknown model": ((*RUN, "--set", "testbd.base.mass=3"), ("testbd", "did you mean testbed?")),
    "output set": ((*RUN, "--set", "testbed.truth.x=1"), ("testbed.truth.x", "is an output")),
    "not a number": ((*RUN, "--set", "testbed.base.mass=heavy"), ("testbed.base.mass", "heavy", "number")),
    "NaN": ((*RUN, "--set", "testbed.base.mass=nan"), ("testbed.base.mass", "nan")),
    "infinity": ((*RUN, "--set", "testbed.base.mass=inf"), ("testbed.base.mass", "inf")),
    "fraction for a whole number": ((*RUN, "--set", "testbed.bumper.mount=0.5"), ("testbed.bumper.mount", "whole")),
    "bumper set twice": ((*RUN, "--set", "testbed.bumper.kind=0"), ("testbed.bumper.kind", "--bumper")),
    "too long for memory": ((*RUN, "--duration", "3000"), ("duration_s", "3000", "traces")),
    "no value": ((*RUN, "--set", "testbed.base.mass"), ("--set", "MODEL.PARAMETER=VALUE")),
    "negative duration": ((*RUN, "--duration", "-1"), ("duration_s", "-1")),
    "zero duration": ((*RUN, "--duration", "0"), ("duration_s", "0")),
    "NaN duration": ((*RUN, "--duration", "nan"), ("duration_s", "nan")),
    "duration in words": ((*RUN, "--duration", "long"), ("--duration",)),
    "FMI version": ((*RUN, "--fmi", "1"), ("fmi_version", "3 or 2")),
    "FMI version without FMUs": ((*RUN, "--engine", "native", "--fmi", "2"), ("--fmi", "only with --engine fmu")),
    "negative seed": ((*RUN, "--seed", "-1"), ("seed", "-1")),
    "missing robot file": ((*RUN, "--robot", "nowhere.toml"), ("nowhere.toml", "no such file")),
    "robot file is a folder": ((*RUN, "--robot", "."), (".", "cannot be read")),
    "output is a file": (("run", "motionless", "--out", "/dev/null"), ("/dev/null", "folder")),
    "no output given": (("run", "motionless"), ("--out",)),
    "unknown command": (("frob",), ("frob",)),
    "unknown model of variables": (("variables", "testbd"), ("testbd", "did you mean testbed?")),
    "no repeats": (("bench", "--repeats", "0"), ("--repeats", "1 to 100")),
    "robots of no measurement": (("bench", "--tune", "0", "--minutes", "1"), ("--tune", "0", "1 to")),
    "two measurements": (("bench", "--tune", "2", "--scale"), ("--tune", "2", "only without --scale")),
    "an option of another measurement": (("bench", "--scale", "--minutes", "6"), ("--minutes", "only with --tune")),
    "repeats of a measurement that has none": (
        ("bench", "--probability", "--repeats", "3"),
        ("--repeats", "3", "only without --probability"),
    ),
    "an option before the command": (
        ("crowd", "--draw", "judging", "endurance"),
        ("--draw", "judging", "behind `endurance`"),
    ),
    "one hit of some robots": (("crowd", "--only", "3", "--robots", "5"), ("--robots", "5", "only without --only")),
    "hours of one run": (
        ("crowd", "endurance", "--only", "3", "--hours", "1"),
        ("--hours", "1.0", "only without --only"),
    ),
    "unknown load": (("drivetrain", "--load", "weel"), ("load", "weel", "base, wheel, locked", "kg.m2")),
    "infinite load": (("drivetrain", "--load", "inf"), ("load", "inf", "locked")),
    "servo delay too long": (("drivetrain", "--servo-delay", "65"), ("servo.delay", "65", "0 to 64")),
    "drivetrain of no robot": (("drivetrain", "--plot", "--robot", "nowhere.toml"), ("nowhere.toml", "no such file")),
    "drivetrain output is a device": (("drivetrain", "--out", "/dev/null"), ("/dev/null", "folder")),
    "picture in a file": (("drivetrain", "--out", "/dev/null/a.png"), ("/dev/null/a.png", "not a writable folder")),
    "sweep of a locked wheel": (("drivetrain", "--load", "locked", "--sweep"), ("load", "locked", "100 kg m2")),
    "experiment of many runs": (
        ("run", "roller_calibration", "--out", "out/run"),
        ("experiment: roller_calibration", "motionless", "giveway reproduce --only roller_calibration"),
    ),
    "demo output is a file": (("demo", "--out", "/dev/null"), ("/dev/null", "folder")),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_input_is_one_line_and_writes_nothing(case: str, cli: Cli, tmp_path: Path) -> None:
    arguments, words = WRONG[case]
    done = cli(*arguments)
    assert done.returncode == 2, done.stderr
    assert len(done.stderr.splitlines()) == 1, done.stderr
    assert not done.stdout
    for word in words:
        assert word in done.stderr
    assert folder_content(tmp_path) == []


def test_a_folder_with_someone_elses_files_is_left_alone(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "chapter.txt").write_text("years of work")
    done = cli("run", "motionless", "--out", "thesis")
    assert done.returncode == 2
    assert "not empty" in done.stderr
    assert folder_content(tmp_path) == ["thesis", "thesis/chapter.txt"]


def test_broken_robot_files_name_the_key(cli: Cli, tmp_path: Path) -> None:
    robot = tmp_path / "robot.toml"
    for text, word in {
        "schema_version = 7\n": "robot.toml:1: schema_version: 7",
        "schema_version = 1\n[base.mass]\nvalue = 20.0\nunit = 'kg'\n": "is missing",
        "not toml at all": "robot.toml:1: not TOML",
    }.items():
        robot.write_text(text)
        done = cli(*RUN, "--robot", "robot.toml")
        assert done.returncode == 2
        assert len(done.stderr.splitlines()) == 1
        assert "robot.toml" in done.stderr
        assert word in done.stderr
    assert folder_content(tmp_path) == ["robot.toml"]


def test_missing_native_parts_name_both_places(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(native, "INSTALLED", tmp_path / "giveway" / "native")
    monkeypatch.setenv(native.ENVIRONMENT_VARIABLE, str(tmp_path / "elsewhere"))
    monkeypatch.setattr("sys.argv", ["giveway", "run", "motionless", "--out", str(tmp_path / "out")])
    with pytest.raises(SystemExit) as caught:
        cli_main()
    assert caught.value.code == 2
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1
    assert f"{native.ENVIRONMENT_VARIABLE}={tmp_path / 'elsewhere'}" in error
    assert str(tmp_path / "giveway" / "native") in error
    assert folder_content(tmp_path) == []


def test_an_fmu_that_refuses_its_parameters_is_one_line(cli: Cli, tmp_path: Path) -> None:
    # In range each, but not together: four corners are asked for, three are given, the fourth is at the origin.
    done = cli(*RUN, "--set", "testbed.outline.count=4")
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert "testbed" in done.stderr
    assert folder_content(tmp_path) == []


def test_an_outline_with_more_x_than_y_says_so(cli: Cli, tmp_path: Path) -> None:
    text = native.robot().read_text(encoding="utf-8")
    x = next(line for line in text[text.index("[outline.x]") :].splitlines() if line.startswith("value"))
    (tmp_path / "four.toml").write_text(text.replace(x, x.replace("]", ", 0.1]")), encoding="utf-8")
    done = cli(*RUN, "--robot", "four.toml")
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert "outline.y.value: 3 numbers is not allowed; allowed: as many as outline.x has, 4" in done.stderr
    assert folder_content(tmp_path) == ["four.toml"]
