"""Nobody waits in silence: bars at a terminal, lines elsewhere, for whatever takes more than a second."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from giveway.base.terminal import progress_bars, working
from giveway.base.words import counted
from giveway.cli import _main
from giveway.drivetrain import frequency_response
from giveway.drivetrain.analysis import analyse
from giveway.drivetrain.model import read
from giveway.study import answers
from giveway.study.engine import Outcome, plan_runs
from giveway.study.messages import overview, sizes
from study_helpers import small_study
from terminal_process import at_a_terminal


def test_a_run_shows_bars_at_a_terminal(tmp_path: Path) -> None:
    code, shown = at_a_terminal(["run", "motionless", "--duration", "0.1", "--out", "out"], "stderr", folder=tmp_path)
    assert code == 0
    for word in ("simulation", "report", "100 %"):
        assert word in shown.decode()


def test_elsewhere_every_part_of_the_work_is_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    with progress_bars(("first", "second")) as progress:
        for share in (0.0, 0.5, 1.0):
            progress("first", share)
        progress("second", 0.0)
    with working("alone"):
        pass
    assert capsys.readouterr().err == "[1 of 2] first\n[2 of 2] second\nalone\n"


def test_a_sweep_says_how_far_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    analysis = analyse(*read(None, "base", 0))
    said: list[tuple[str, str, float]] = []
    monkeypatch.setattr(
        frequency_response, "_measure_one", lambda setup, frequency_hz, version: (frequency_hz, 1.0 + 0.0j)
    )
    found = frequency_response.measure_all(analysis, 2.75, points=4, progress=lambda *words: said.append(words))
    cases = [(one.case, one.source) for one in found]
    assert cases == frequency_response.measurable(analysis, 2.75)
    assert said == [(*case, share) for case in cases for share in (0.0, 0.25, 0.5, 0.75, 1.0)]


def test_the_command_s_sweep_says_so_too(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(
        frequency_response, "_measure_one", lambda setup, frequency_hz, version: (frequency_hz, 1.0 + 0.0j)
    )
    assert _main(["drivetrain", "--sweep"]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "linear model"
    assert lines[1] == "[1 of 5] gear stuck, environment"
    assert len(lines) == 6


def test_a_study_in_python_shows_its_progress(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    small_study().run(tmp_path / "a")
    assert "small: 4 of 4 runs" in capsys.readouterr().err
    small_study(seed=2).run(tmp_path / "b", progress=False)
    assert capsys.readouterr().err == ""
    done = []
    small_study(seed=3).run(tmp_path / "c", progress=lambda progress: done.append(progress.done))
    assert done[-1] == 4
    assert capsys.readouterr().err == ""


def test_reading_a_study_says_how_far_it_is(tmp_path: Path) -> None:
    small_study(part_runs=1).run(tmp_path / "study", progress=False)
    shares: list[float] = []
    found = answers.load(tmp_path / "study", shares.append)
    assert shares == [0.0, *np.arange(4) / 4]
    assert found.complete


def test_one_of_something_is_no_plural() -> None:
    setup = small_study(vary=[]).setup()
    assert sizes(setup, plan_runs(setup)) == "small: 1 design, 1 collision, 1 sample with the nominal one: 1 run"
    done = Outcome(Path("out"), runs=1, stored=1, ran=1, reused=0, failed=0, wall_s=1.0, interrupted=False)
    assert overview(setup, done).startswith("small: 1 of 1 run is stored in out; ")
    assert (counted(0, "run"), counted(2000, "run")) == ("0 runs", "2,000 runs")
