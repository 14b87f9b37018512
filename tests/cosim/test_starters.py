"""`giveway new`: the files that it writes can be used as they are, and so can each of their options."""

from __future__ import annotations

import re
from pathlib import Path

import giveway
import pytest
from cosim_helpers import Cli
from giveway import batch
from giveway.starters import command
from giveway.study import study_file

FOLDER = Path(command.__file__).parent


def options(kind: str) -> list[str]:
    """The starter with one option taken; of a table that is an option, with the whole table."""
    lines = (FOLDER / f"{kind}.toml").read_text(encoding="utf-8").splitlines()
    found, at = [], 0
    while at < len(lines):
        end = at + 1
        if re.match(r"# \[", lines[at]):
            while end < len(lines) and re.match(r"# \w+ = ", lines[end]):
                end += 1
        if re.match(r"# (\[|\w+ = )", lines[at]):
            taken = [line.removeprefix("# ") for line in lines[at:end]]
            found.append("\n".join([*lines[:at], *taken, *lines[end:]]))
        at = end
    return found


def test_a_scenario_to_start_from_runs(process: Cli, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    answer = process("new", "scenario", str(path))
    assert answer.returncode == 0
    assert f"giveway run {path} " in answer.stdout
    assert f"giveway run {path} " in path.read_text(encoding="utf-8")
    result = batch.run(giveway.read_scenario(path))
    assert result.metric("detection time").value > 0.0


def test_a_study_to_start_from_is_checked(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    assert cli("new", "study", str(path)).returncode == 0
    # 9 designs, 4 samples, 2 collisions, and none to tell how sure it is: half a minute on one slow processor.
    assert cli("sweep", str(path), "--check").stdout.strip().endswith("72 runs")


def test_they_start_from_your_robot(cli: Cli, tmp_path: Path) -> None:
    """A path is seen from the file, a shipped robot keeps its name; the study fits a small one, too."""
    sizes = ("--mass", "8", "--wheel-radius", "0.058", "--wheel-distance", "0.15", "--height", "0.3")
    (tmp_path / "robots").mkdir()
    assert cli("robot", "new", "robots/mine.toml", *sizes, "--outline", "circle 0.36").returncode == 0
    assert cli("new", "study", "studies.toml", "--robot", "robots/mine.toml").returncode == 0
    assert 'robot = "robots/mine.toml" ' in (tmp_path / "studies.toml").read_text(encoding="utf-8")
    assert "72 runs" in cli("sweep", "studies.toml", "--check").stdout
    (tmp_path / "cases").mkdir()
    assert cli("new", "scenario", "cases/one.toml", "--robot", "robots/mine.toml").returncode == 0
    robot = giveway.read_scenario(tmp_path / "cases" / "one.toml").robot
    assert robot is not None
    assert robot.resolve() == tmp_path / "robots" / "mine.toml"
    assert cli("new", "scenario", "two.toml", "--robot", "lekiwi").returncode == 0
    assert 'robot = "lekiwi" ' in (tmp_path / "two.toml").read_text(encoding="utf-8")
    for wrong in ("lekiwii", "none.toml", "studies.toml"):
        assert cli("new", "study", "three.toml", "--robot", wrong).returncode == 2
    assert not (tmp_path / "three.toml").exists()


@pytest.mark.parametrize("kind", ["scenario", "study"])
def test_each_option_can_be_taken(kind: str, tmp_path: Path) -> None:
    taken = options(kind)
    assert len(taken) > 6
    trikey = Path(__file__).parents[2] / "robots/trikey.toml"
    (tmp_path / "ROBOT.toml").write_bytes(trikey.read_bytes())
    for text in taken:
        path = tmp_path / f"{kind}.toml"
        path.write_text(text, encoding="utf-8")
        (giveway.read_scenario if kind == "scenario" else study_file.read)(path)


def test_no_file_is_replaced(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("kept", encoding="utf-8")
    answer = cli("new", "scenario", str(path))
    assert (answer.returncode, answer.stdout, path.read_text(encoding="utf-8")) == (2, "", "kept")
    assert "is there already" in answer.stderr
    assert cli("new", "study", str(tmp_path / "mine.txt")).returncode == 2
    assert sorted(tmp_path.iterdir()) == [path]
