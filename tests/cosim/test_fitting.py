"""The fitted values: the record belongs to the robot file, the targets hold at them, and the fit does its work."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from cosim_helpers import Cli, folder_content
from giveway.base.errors import InputFileError
from giveway.fitting.parameters import FREE, from_unit, limits, to_unit
from giveway.fitting.quantities import QUANTITIES, Bench
from giveway.fitting.record import read_record, robot_text
from giveway.fitting.search import SEEDS, STAGES, Fit, evaluate, search

ROBOT = Path(__file__).parents[2] / "robots" / "trikey.toml"
RECORD = ROBOT.with_suffix(".fit.json")
PATHS = [path for free in FREE for path in free.paths]


def entries(path: Path) -> dict[str, dict[str, object]]:
    tables = tomllib.loads(path.read_text(encoding="utf-8"))
    groups = {group: table for group, table in tables.items() if isinstance(table, dict) and group != "robot"}
    return {f"{group}.{name}": entry for group, table in groups.items() for name, entry in table.items()}


@pytest.fixture(scope="module")
def committed() -> Fit:
    values = {path: float(entries(ROBOT)[path]["value"]) for path in PATHS}  # type: ignore[arg-type]
    return evaluate(Bench(ROBOT), values)


def test_what_is_fitted_is_what_the_fit_fits() -> None:
    found = {name: entry for name, entry in entries(ROBOT).items() if entry["provenance"] == "fitted"}
    assert sorted(found) == sorted(PATHS)
    assert all("giveway fit" in str(entry["source"]) for entry in found.values())
    assert all(found[path]["unit"] == free.unit for free in FREE for path in free.paths)


def test_the_record_is_of_the_committed_values() -> None:
    kept = {path: entry["fitted"] for entry in read_record(RECORD)["parameters"] for path in entry["paths"]}
    assert kept == {path: entries(ROBOT)[path]["value"] for path in PATHS}
    assert "giveway fit --robot robots/trikey.toml" in read_record(RECORD)["command"]


def test_the_recorded_residuals_are_computed_again(committed: Fit) -> None:
    kept = {entry["quantity"]: entry for entry in read_record(RECORD)["targets"]}
    assert list(kept) == [quantity.name for quantity in QUANTITIES]
    # Four digits are kept; integration at 1e-6 leaves the rest to the compiler.
    recorded = [kept[quantity.name]["fit"] for quantity in QUANTITIES]
    assert committed.quantities == pytest.approx(recorded, rel=1e-3)
    assert committed.residuals == pytest.approx([kept[q.name]["residual"] for q in QUANTITIES], abs=0.02)


def test_every_target_holds_with_every_seed_of_the_noise(committed: Fit) -> None:
    assert len(SEEDS) == 20
    for values in committed.spread:
        residuals = {q.name: q.residual(value) for q, value in zip(QUANTITIES, values, strict=True)}
        assert all(abs(residual) <= 1.0 for name, residual in residuals.items() if "lead" not in name), residuals
    lead = [quantity.name for quantity in QUANTITIES].index("lead of magnetic over spring")
    assert committed.spread[0, lead] > 1.0  # ms, the controller's tick: earlier with every seed


def test_values_are_near_their_estimates(committed: Fit) -> None:
    lower, upper = limits()
    deviations = to_unit(committed.values)
    assert (deviations > lower).all()  # no bound is touched
    assert (deviations < upper).all()
    assert np.abs(deviations).max() < 2.0


def test_the_committed_values_are_a_minimum(committed: Fit) -> None:
    # Half a step of the scaled parameters away, in any one of them, it is not better.
    bench, here = Bench(ROBOT), to_unit(committed.values)
    away = [here + sign * 0.5 * step for step in np.eye(len(FREE)) for sign in (1.0, -1.0)]
    for point, quantities in zip(away, bench.measure([from_unit(point) for point in away]), strict=True):
        residuals = [quantity.residual(value) for quantity, value in zip(QUANTITIES, quantities, strict=True)]
        assert np.sum(np.square(residuals)) + np.sum(point**2) > committed.cost


@pytest.mark.deep
def test_the_search_improves_on_what_it_starts_from() -> None:
    bench = Bench(ROBOT)
    stages: list[str] = []
    found = search(bench, lambda stage, _share: stages.append(stage), samples=1)
    start = evaluate(bench, from_unit(np.zeros(len(FREE))), seeds=(1,))
    assert found.cost < start.cost
    assert list(dict.fromkeys(stages)) == list(STAGES)


@pytest.mark.deep
def test_command_writes_robot_file_and_record(cli: Cli, tmp_path: Path) -> None:
    done = cli("fit", "--robot", str(ROBOT), "--out", "new.toml", "--samples", "1")
    assert done.returncode == 0, done.stderr
    assert "Singular values" in done.stdout
    assert folder_content(tmp_path) == ["new.fit.json", "new.toml"]
    before, after = entries(ROBOT), entries(tmp_path / "new.toml")
    assert list(before) == list(after)
    assert {name for name in before if before[name] != after[name]} <= set(PATHS)
    record = json.loads((tmp_path / "new.fit.json").read_text())
    kept = {path: entry["fitted"] for entry in record["parameters"] for path in entry["paths"]}
    assert kept == {path: after[path]["value"] for path in PATHS}
    lines = [path.read_text(encoding="utf-8").splitlines() for path in (ROBOT, tmp_path / "new.toml")]
    assert len(lines[0]) == len(lines[1])  # comments and all


def test_wrong_input_is_told(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "half.toml").write_text(ROBOT.read_text(encoding="utf-8").replace("[servo.kp]", "[servo.gain]"))
    for arguments, words in (
        (("--out", "new.toml", "--samples", "0"), "samples: 0"),
        (("--out", "new.toml", "--robot", "half.toml"), "servo.gain: gain is unknown"),
        (("--out", str(tmp_path)), "is not a file"),
    ):
        done = cli("fit", *arguments)
        assert done.returncode == 2, done.stdout
        assert words in done.stderr
    assert folder_content(tmp_path) == ["half.toml"]


def test_an_entry_without_a_value_is_refused(committed: Fit, tmp_path: Path) -> None:
    robot = tmp_path / "robot.toml"
    robot.write_text(ROBOT.read_text(encoding="utf-8").replace("[servo.kd]\nvalue = ", "[servo.kd]\nnumber = "))
    with pytest.raises(InputFileError, match=r"servo\.kd\.number: number is unknown"):
        robot_text(robot, committed, "robot.fit.json")


def test_ctrl_c_leaves_nothing_behind(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "giveway", "fit", "--out", "new.toml"]
    with subprocess.Popen(command, cwd=tmp_path, env=os.environ, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        assert process.stderr.readline() == "[1 of 3] sampling the box\n"
        process.send_signal(signal.SIGINT)
        _, rest = process.communicate(timeout=120)
    assert process.returncode == 130, rest
    assert rest == "giveway: interrupted; nothing was written\n"
    assert folder_content(tmp_path) == []
