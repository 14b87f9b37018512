"""Studies at the command line: from the file to the chosen bumper, and wrong files before anything runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from cosim_helpers import Cli

STUDY = """
schema_version = 1
name = "at the command line"

[scenario]
duration = 0.35
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
metric = "peak contact force"

[report]
chosen = 1
metrics = ["bumper travel"]
"""


def test_from_the_file_to_the_chosen_bumper(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(STUDY, encoding="utf-8")
    checked = cli("sweep", "mine.toml", "--check")
    assert checked.returncode == 0, checked.stderr
    assert "9 designs, 1 collision" in checked.stdout
    assert not (tmp_path / "out").exists()
    swept = cli("sweep", "mine.toml")
    assert swept.returncode == 0, swept.stderr
    folder = tmp_path / "out" / "studies" / "mine"
    for word in ("9 designs", "bumper travel", "What decides", "mu*"):
        assert word in swept.stdout
    assert "9 of 9 runs" in swept.stderr
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.count("<svg") == 4  # trade-off, effects, sensitivities, traces
    assert not re.findall(r"(?:src|href)=\"(?!#)[^\"]*\"|@import|https?://(?!www\.w3\.org)", page), "needs a network"
    best = re.search(r"^ *(\d+) .* yes *$", swept.stdout, flags=re.MULTILINE)
    assert best is not None
    assert (folder / "chosen" / f"design-{best[1]}" / "front" / "traces.parquet").is_file()
    shown = cli("study", "show", str(folder))
    assert shown.returncode == 0, shown.stderr
    assert best[0] in shown.stdout
    for file in ("bumper.ssv", "bumper.toml", "bumper.csv"):
        exported = cli("study", "export", str(folder), "--design", best[1], "--out", file)
        assert exported.returncode == 0, exported.stderr
        assert (tmp_path / file).stat().st_size > 0
    again = cli("run", "bumper.toml", "--out", "run")
    assert again.returncode == 0, again.stderr
    simulated = cli("study", "run", str(folder), "--design", "0")
    assert "peak contact force" in simulated.stdout


@pytest.mark.parametrize(("arguments", "words"), [
    (("sweep", "nothing.toml"), "nothing.toml: no such file"),
    (("sweep", "wrong.toml"), "wrong.toml:20: vary[0].quantity: testbed.bumper.spring_rat is unknown"),
    (("study", "show", "nothing"), "manifest.json: no such file"),
    (("study", "export", "nothing", "--out", "a.ssv"), "manifest.json: no such file"),
    (("sweep", "mine.toml", "--threads", "0"), "threads: 0 is not allowed"),
])  # fmt: skip
def test_wrong_input_is_one_line_and_writes_nothing(
    arguments: tuple[str, ...], words: str, cli: Cli, tmp_path: Path
) -> None:
    (tmp_path / "mine.toml").write_text(STUDY, encoding="utf-8")
    (tmp_path / "wrong.toml").write_text(STUDY.replace("bumper.spring_rate", "bumper.spring_rat"), encoding="utf-8")
    found = cli(*arguments)
    assert found.returncode == 2
    assert found.stderr.count("\n") == 1
    assert words in found.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.toml", "wrong.toml"]
