"""Completion of the command line in bash, zsh and fish, as `giveway --install-completion` sets it up."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
@pytest.mark.parametrize(
    ("typed", "word", "offered"), [("giveway sw", 1, "sweep"), ("giveway study ev", 2, "evidence")]
)
def test_commands_are_completed(shell: str, typed: str, word: int, offered: str) -> None:
    asked = {
        "_GIVEWAY_COMPLETE": f"complete_{shell}",
        "COMP_WORDS": typed,
        "COMP_CWORD": str(word),
        "_TYPER_COMPLETE_ARGS": typed,
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
    }
    command = [sys.executable, "-c", "import sys; sys.argv[0] = 'giveway'; from giveway.cli import main; main()"]
    answer = subprocess.run(command, env=os.environ | asked, capture_output=True, text=True, check=True)
    assert offered in answer.stdout
    assert "calibrate" not in answer.stdout
