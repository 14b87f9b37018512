"""Studies at the command line: from the file to the chosen bumper, and wrong files before anything runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from cosim_helpers import Cli
from giveway.cli import _main
from page_arrays import data_of

STUDY = """
schema_version = 1
name = "at the command line"

[scenario]
duration = 0.65
bumper = "magnetic"

[[collision]]
name = "front"
speed = 0.5
edge = 0
time = 0.12

[designs]
kind = "morris"
trajectories = 3

[[vary]]
quantity = "testbed.bumper.spring_rate"
low = 500
high = 3000

[[vary]]
quantity = "testbed.bumper.latch_force"
low = 0
high = 60

[[objective]]
metric = "detection time"

[[objective]]
metric = "peak force of the run"

[report]
chosen = 1
metrics = ["bumper compression"]
"""


def test_from_the_file_to_the_chosen_bumper(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.toml").write_text(STUDY, encoding="utf-8")
    swept = cli("sweep", "mine.toml")
    assert swept.returncode == 0, swept.stderr
    folder = tmp_path / "out" / "studies" / "mine"
    for word in ("9 designs", "bumper compression", "What decides", "mu*"):
        assert word in swept.stdout
    assert "9 of 9 runs" in swept.stderr
    page = (folder / "report.html").read_text(encoding="utf-8")
    data = data_of(page)  # of trade-off, effects and traces
    assert {"detection time", "peak force of the run"} <= {one["label"] for one in data["columns"]}
    assert data["runs"]["cases"][0]["name"] == "front"
    for heading in ("Trade-off", "What decides", "Chosen designs"):
        assert re.search(rf"<h[23]>{heading}</h", page)
    assert not re.findall(r"(?:src|href)=\"(?!#)[^\"]*\"|@import|https?://(?!www\.w3\.org)", page), "needs a network"
    best = re.search(r"^ *(\d+) .* yes *$", swept.stdout, flags=re.MULTILINE)
    assert best is not None
    assert (folder / "chosen" / f"design-{best[1]}" / "front" / "traces.parquet").is_file()
    # In this process from here on: what is tested is what the commands do, and imports take seconds.
    monkeypatch.chdir(tmp_path)

    def say(*arguments: str) -> str:
        capsys.readouterr()
        assert _main(list(arguments)) == 0, capsys.readouterr().err
        return capsys.readouterr().out

    assert best[0] in say("study", "show", str(folder))
    for file in ("bumper.ssv", "bumper.toml", "bumper.csv"):
        say("study", "export", str(folder), "--design", best[1], "--out", file)
        assert (tmp_path / file).stat().st_size > 0
    say("study", "export", str(folder), "--out", "all.csv")
    assert (tmp_path / "all.csv").read_text(encoding="utf-8").count("\n") == 10
    assert "peak force of the run" in say("run", "bumper.toml", "--out", "run")
    assert "peak force of the run" in say("study", "run", str(folder), "--design", "0")
    assert _main(["study", "sure", str(folder), "--indices", "64"]) == 2
    assert "tolerance: 0 uncertain quantities is not allowed; allowed: at least two" in capsys.readouterr().err


def test_a_file_can_be_checked_without_a_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.toml").write_text(STUDY, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert _main(["sweep", "mine.toml", "--check"]) == 0
    assert "9 designs, 1 collision" in capsys.readouterr().out
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("arguments", "words"), [
    (("sweep", "nothing.toml"), "nothing.toml: no such file"),
    (("sweep", "wrong.toml"), "wrong.toml:20: vary[0].quantity: testbed.bumper.spring_rat is unknown"),
    (("study", "show", "nothing"), "manifest.json: no such file"),
    (("study", "export", "nothing", "--out", "a.ssv"), "manifest.json: no such file"),
    (("study", "export", "s", "--out", "a.csv", "--collision", "front"), "--collision: front is not allowed"),
    (("study", "export", "s", "--design", "1", "--out", "a.toml", "--model", "bumper"), "--out ends in .ssv"),
    (("sweep", "mine.toml", "--threads", "0"), "threads: 0 is not allowed"),
])  # fmt: skip
def test_wrong_input_is_one_line_and_writes_nothing(
    arguments: tuple[str, ...],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "mine.toml").write_text(STUDY, encoding="utf-8")
    (tmp_path / "wrong.toml").write_text(STUDY.replace("bumper.spring_rate", "bumper.spring_rat"), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert _main(list(arguments)) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert words in said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.toml", "wrong.toml"]


def test_the_name_that_a_metric_had_before_still_works(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "old.toml").write_text(STUDY.replace("bumper compression", "bumper travel"), encoding="utf-8")
    checked = cli("sweep", "old.toml", "--check")
    assert checked.returncode == 0
    assert checked.stderr == 'giveway: report.metrics[0]: "bumper travel" is called "bumper compression" now\n'
