"""Processes that wait to run tests in Python: each forks for every run (see warm.py)."""

from __future__ import annotations

import json
import os
import queue
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from verify.failure import RungFailed

__all__ = ["WarmProcesses"]


class WarmProcesses:
    """``count`` processes with the interpreter ``python`` in ``folder``, for use from ``count`` threads."""

    def __init__(self, python: Path, folder: Path, count: int) -> None:
        self._free: queue.Queue[subprocess.Popen[str]] = queue.Queue()
        for _ in range(count):
            self._free.put(_started(python, folder))

    def ask(self, request: Mapping[str, Any]) -> Any:
        """pytest's exit code, or "time" if the tests took too long."""
        process = self._free.get()
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            print(json.dumps(request), file=process.stdin, flush=True)
            answer = process.stdout.readline()
        finally:
            self._free.put(process)
        if not answer:
            raise RungFailed("a process that runs the tests in Python has ended")
        return json.loads(answer)["code"]

    def close(self) -> None:
        while not self._free.empty():
            process = self._free.get()
            assert process.stdin is not None
            process.stdin.close()
            process.wait()


def _started(python: Path, folder: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [str(python), "-m", "verify.mutation.rooms.warm"],
        cwd=folder,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,  # Ctrl-C must not look like tests that failed
    )
