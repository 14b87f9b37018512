"""Live: lines on standard input, detections as they happen, Ctrl-C; and a log of an hour in little memory."""

from __future__ import annotations

import io
import re
import signal
import subprocess
import sys
from pathlib import Path

import giveway
import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
from cosim_helpers import Cli, short
from giveway.base import native
from giveway.replay.run_log import write_log
from measured_process import measure


@pytest.fixture(scope="module")
def lines(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    path = tmp_path_factory.mktemp("log") / "run.csv"
    write_log(path, giveway.run(short(), engine="native"))
    return path.read_text().splitlines(keepends=True)


def following() -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "giveway", "replay", "--follow"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(command, text=True, **pipes)  # type: ignore[call-overload, no-any-return]


def test_detections_come_while_lines_come_and_ctrl_c_ends_it(lines: list[str]) -> None:
    with following() as process:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdin.writelines(lines[:350])
        process.stdin.flush()
        assert process.stdout.readline().startswith("Following standard input; controller: the log's own")
        hit = process.stdout.readline()
        assert re.match(r"t = 0\.1\d\d s: hit 1: \d", hit)
        process.send_signal(signal.SIGINT)
        process.stdin.close()
        rest = process.stdout.read()
        assert process.wait(60) == 0, process.stderr.read()
    assert re.search(r"Followed \d+ rows, 0\.\d+ s \(Ctrl-C\): 1 detections", rest)


def test_the_end_of_the_input_ends_it(lines: list[str], cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(lines)))
    done = cli("replay", "--follow", "--robot", str(native.robot()))
    assert done.returncode == 0, done.stderr
    assert "hit 1" in done.stdout
    assert "Followed 501 rows, 0.501 s: 1 detections" in done.stdout


def test_a_byte_order_mark_is_left_out(lines: list[str], cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    own = [line for line in lines if not line.startswith("#")]
    monkeypatch.setattr("sys.stdin", io.StringIO("\ufeff" + "".join(own)))
    done = cli("replay", "--follow", "--robot", str(native.robot()))
    assert done.returncode == 0, done.stderr
    assert "Followed 501 rows, 0.501 s: 1 detections" in done.stdout


def test_without_a_plan_detections_come_later(lines: list[str], cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    own = [line.rstrip().split(",") for line in lines if not line.startswith("#")]
    kept = [at for at, head in enumerate(own[0]) if not head.startswith("plan_")]
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(",".join(row[at] for at in kept) + "\n" for row in own)))
    done = cli("replay", "--follow", "--robot", str(native.robot()))
    assert done.returncode == 0, done.stderr
    assert "it is taken to be the motion of the wheels, and detections are told 0.3 s late" in done.stdout
    assert "Followed 501 rows, 0.501 s: 1 detections" in done.stdout


def test_wrong_lines_are_named(lines: list[str], cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = [*lines[:100], lines[100].replace(",", ";", 1), *lines[101:]]
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(wrong)))
    done = cli("replay", "--follow")
    assert done.returncode == 2, done.stdout
    assert "standard input:101: columns: 17 is not allowed; allowed: 18, as in line" in done.stderr


@pytest.mark.deep
def test_an_hour_is_played_in_little_memory(tmp_path: Path) -> None:
    """3.6 million rows, 500 MB as numbers: the process needs less than 700 MB, of which 150 are Python's libraries."""
    result = giveway.run(short(), engine="native")
    write_log(tmp_path / "run.parquet", result)
    one = pyarrow.parquet.read_table(tmp_path / "run.parquet").slice(0, 100)  # at rest
    rows, parts = 100, 36_000
    with pyarrow.parquet.ParquetWriter(tmp_path / "hour.parquet", one.schema) as writer:
        for start in range(0, parts, 600):
            many = pyarrow.concat_tables([one] * 600)
            at = start * rows + np.arange(600 * rows)
            many = many.set_column(0, one.schema.field(0), pyarrow.array(at * 1e-3))
            counter = one.schema.get_field_index("sensor_counter")
            many = many.set_column(counter, one.schema.field(counter), pyarrow.array(at.astype(np.int32)))
            writer.write_table(many)
    log, out = str(tmp_path / "hour.parquet"), str(tmp_path / "out")
    played = measure([sys.executable, "-m", "giveway", "replay", log, "--out", out], tmp_path)
    assert played.code == 0, played.said
    assert "3600000 of 1 ms" in played.said
    assert played.memory_kb < 700_000
    assert (tmp_path / "out/report.html").stat().st_size < 2_000_000
    speed = re.search(r"\(([\d.]+) s of processor time\)", played.said)
    assert speed is not None
    assert (
        3600.0 / float(speed[1]) > 150.0
    )  # 300 when nothing else runs; processor time grows when the caches are shared
