"""The command line at a terminal of its own."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

__all__ = ["at_a_terminal"]


def at_a_terminal(
    arguments: Sequence[str],
    which: Literal["stdout", "stderr"],
    *,
    folder: Path | None = None,
    environment: Mapping[str, str] | None = None,
) -> tuple[int, bytes]:
    """Exit code, and what the command shows where the stream ``which`` is a terminal."""
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "giveway", *arguments]
    out, error = (theirs, None) if which == "stdout" else (subprocess.DEVNULL, theirs)
    with subprocess.Popen(command, cwd=folder, stdin=theirs, stdout=out, stderr=error, env=environment) as process:
        os.close(theirs)
        shown = b""
        while True:
            try:
                part = os.read(ours, 4096)
            except OSError:  # Linux says so when the other end is closed
                break
            if not part:
                break
            shown += part
    os.close(ours)
    return process.returncode, shown
