"""The page of what is asked of the reflex: its figures are of these sources, and none is left out or judged wrongly."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from giveway.crowd.table import TARGETS

from docs.markdown import replaced
from docs.reflex_targets import BEGIN, END, HASH_DIGITS, tables
from verify.sources import core_hash

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/site/reference/reflex_targets.md").read_text(encoding="utf-8")
PLANAR, TIPPING = (
    [["all hits", "missed", "0", "3", "1 to 9", "missed"]],
    [["all hits", "missed", "0", "0", "0 to 4", "met"]],
)
HITS = {"targets": {"planar": PLANAR, "tipping": TIPPING, "planar, IMU": TIPPING, "tipping, IMU": PLANAR}}
QUIET = {"planar": {"hours": 300.0, "false alarms": 2, "per hour": 2 / 300, "per hour, upper 95 % bound": 0.021}}
DOCUMENTS: dict[str, dict[str, Any]] = {"as-drawn": HITS, "calibrated": HITS, "without-contact": {"groups": QUIET}}


def _rows(page: str) -> list[list[str]]:
    """Every line of the tables of hits: row, figure, at most, then what was found."""
    lines = [[cell.strip() for cell in line.strip("| ").split(" | ")] for line in page.splitlines() if line[:2] == "| "]
    without = lines.index(next(line for line in lines if line[0] == "robots"))
    return [line for line in lines[:without] if line[0] not in ("hits", "---")]


def test_the_page_is_of_the_sources_in_this_repository() -> None:
    found = re.search(rf"hash `([0-9a-f]{{{HASH_DIGITS}}})`", PAGE)
    assert found
    assert core_hash(ROOT).startswith(found[1]), "make targets"


def test_every_figure_that_is_asked_for_is_there_and_judged_by_its_value() -> None:
    rows = _rows(PAGE)
    asked = {(one.row, one.what, f"{one.most:g}") for targets in TARGETS.values() for one in targets}
    assert asked == {tuple(line[:3]) for line in rows}
    judged = [(float(at_most), cell) for _, _, at_most, *cells in rows for cell in cells if ", " in cell]
    assert len(judged) > 150  # six kinds of robots, some 30 figures each
    for at_most, cell in judged:
        met = float(cell.split(" ", 1)[0]) <= at_most
        assert cell.endswith(", met" if met else ", missed"), cell


def test_figures_stand_where_they_belong() -> None:
    made = tables(DOCUMENTS, "0123456789abcdef")
    page = replaced(f"before\n{BEGIN}\nold\n{END}\nafter\n", BEGIN, END, made)
    assert page == f"before\n{made}\nafter\n"
    assert replaced(page, BEGIN, END, made) == page
    assert "`0123456789ab`" in page
    assert (
        "| all hits | missed | 0 | 3 (1 to 9), missed | 3 (1 to 9), missed | 0 (0 to 4), met | 0 (0 to 4), met |"
        in page
    )
    assert "| all hits | missed | 0 | 0 (0 to 4), met | 3 (1 to 9), missed |" in page
    assert "| planar | 300 | 2 | 0.00667 | 0.021, missed |" in page


def test_a_page_without_marks_is_refused() -> None:
    with pytest.raises(SystemExit, match="has no lines"):
        replaced(PAGE.replace(BEGIN, ""), BEGIN, END, "")


def test_who_ends_it_ends_its_command(tmp_path: Path) -> None:
    words = ["crowd", "--draw", "tuning", "--no-imu", "--out", str(tmp_path / "crowd")]
    lines = f"from docs.reflex_targets import _run; raise SystemExit(_run({words!r}))"
    with subprocess.Popen([sys.executable, "-c", lines], cwd=ROOT, stderr=subprocess.DEVNULL) as running:
        lock = tmp_path / "crowd" / ".lock"
        while not lock.exists() and running.poll() is None:
            time.sleep(0.05)
        running.terminate()
        assert running.wait() == signal.SIGTERM
    again = subprocess.run(
        [Path(sys.executable).parent / "giveway", *words, "--robots", "1"], capture_output=True, check=False
    )
    assert again.returncode == 0, again.stderr
