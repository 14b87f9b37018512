"""A build says how far it is, what went wrong, and nothing else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
NINJA = Path(sys.executable).parent / "ninja"
STEPS = 3


def build(folder: Path, command: str) -> subprocess.CompletedProcess[str]:
    """A build of a few steps by Ninja, each of which runs that command."""
    steps = "".join(f"build step{number}: step\n" for number in range(STEPS))
    (folder / "build.ninja").write_text(f"rule step\n command = {command}\n description = Making $out\n{steps}")
    words = [sys.executable, ROOT / "cmake" / "progress.py", "compiling", NINJA, "-C", folder, "-j", "1"]
    return subprocess.run(words, capture_output=True, text=True, check=False, timeout=60)


def test_a_build_ends_with_one_line(tmp_path: Path) -> None:
    said = build(tmp_path, "sleep 0.5; touch $out; echo -- chatter")
    assert said.returncode == 0, said.stderr
    (line,) = said.stdout.splitlines()
    assert line.startswith(f"compiling: {STEPS} steps in ")


def test_a_build_with_nothing_to_do_says_nothing(tmp_path: Path) -> None:
    build(tmp_path, "touch $out")
    assert build(tmp_path, "touch $out").stdout == ""


def test_what_a_compiler_says_comes_through_with_its_exit_code(tmp_path: Path) -> None:
    said = build(tmp_path, "echo error: no such thing; exit 7")
    assert "error: no such thing" in said.stdout
    assert "Making step" not in said.stdout
    assert said.returncode != 0


def test_a_tree_inside_the_tree_counts() -> None:
    """As Ninja and the trees of two platforms inside it say it, on a pipe."""
    lines = ["[1/2] outer", "[FMUs 1/5] a", "[FMUs 5/5] b", "[FMUs 1/4] c", "[FMUs 4/4] d", "[2/2] outer"]
    code = f"import time; time.sleep(1.1); print({chr(10).join(lines)!r})"
    words = [sys.executable, ROOT / "cmake" / "progress.py", "compiling", sys.executable, "-c", code]
    said = subprocess.run(words, capture_output=True, text=True, check=True, timeout=60).stdout
    assert said.startswith("compiling: 11 steps in ")
