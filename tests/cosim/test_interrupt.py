"""Ctrl-C at the terminal: a clean end that keeps what was computed."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import giveway

ENOUGH_FOR_SOME_STEPS_S = 0.2


def test_ctrl_c_saves_the_part_that_was_computed(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "giveway", "-v", "run", "motionless", "--duration", "250", "--out", "part"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        said = []
        for line in process.stderr:
            said.append(line)
            if "stepping" in line:
                break
        time.sleep(ENOUGH_FOR_SOME_STEPS_S)
        process.send_signal(signal.SIGINT)
        _, rest = process.communicate(timeout=120)
    assert process.returncode == 130, "".join(said) + rest
    assert "Traceback" not in rest
    assert "Interrupted at t =" in rest
    part = giveway.load(tmp_path / "part")
    assert part.interrupted
    assert 0.0 < part.manifest["simulated_s"] < 250.0
    assert "was interrupted" in (tmp_path / "part" / "report.html").read_text(encoding="utf-8")
