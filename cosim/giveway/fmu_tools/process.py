"""Runs any FMU in a separate process, in a temporary folder that is always removed."""

from __future__ import annotations

import contextlib
import json
import logging
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from giveway.base.errors import SimulationError, one_line
from giveway.base.files import make_scratch_folder, remove_folder
from giveway.fmu_tools.child import STATUS_BYTES, read_status
from giveway.fmu_tools.isolation import signal_name

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["FmuStoppedError", "run_in_child", "temporary_folder"]

_log = logging.getLogger(__name__)

POLL_S = 0.05
LAST_BYTES, LAST_LINES = 4000, 3  # of what the FMU printed
# Waits for the end of the caller, then ends its processes and removes its folder, which a killed caller cannot do.
_JANITOR = 'read child; cat > /dev/null; kill -s KILL -- "-$child" 2> /dev/null; rm -rf -- "$1"'


class FmuStoppedError(SimulationError):
    """The process that the FMU ran in crashed, ended by itself, or took too long."""


class TemporaryFolder:
    """A folder in the system's temporary folder, and a janitor that removes it if this process is killed."""

    def __init__(self) -> None:
        self.path = make_scratch_folder("giveway-fmu-run-")
        self._janitor: subprocess.Popen[str] | None = None
        with contextlib.suppress(OSError):  # a system without this shell: then a killed run leaves its folder behind
            self._janitor = subprocess.Popen(
                ["/bin/sh", "-c", _JANITOR, "sh", str(self.path)],
                stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True,
                start_new_session=True,
            )  # fmt: skip

    def also_kills(self, group: int) -> None:
        """The janitor ends the process group, too."""
        if self._janitor is not None and self._janitor.stdin is not None:
            with contextlib.suppress(OSError):
                self._janitor.stdin.write(f"{group}\n")
                self._janitor.stdin.flush()

    def remove(self) -> None:
        remove_folder(self.path)
        if self._janitor is not None:
            self._janitor.kill()
            self._janitor.communicate()


@contextmanager
def temporary_folder() -> Iterator[TemporaryFolder]:
    """A folder that is removed at the end of the block, or of this process."""
    folder = TemporaryFolder()
    try:
        yield folder
    finally:
        folder.remove()


def run_in_child(
    name: str,
    folder: TemporaryFolder,
    job: dict[str, Any],
    time_limit_s: float | None,
    progress: Callable[[float, float], None] | None,
) -> tuple[NDArray[Any], str]:
    """Run the FMU that is unpacked in the folder's ``fmu``, and return its traces.

    The second value tells what went wrong after the end of the run, when its results were safe; empty if nothing did.
    Raises SimulationError with the FMU's own message if it refuses or fails, FmuStoppedError if its process crashes or
    hangs. ``job`` is the input of `child`.
    """
    import numpy as np

    path = folder.path
    (path / "work").mkdir()
    (path / "status").write_bytes(bytes(STATUS_BYTES))
    (path / "job.json").write_text(json.dumps(job), encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, "-P", "-u", "-c", "from giveway.fmu_tools.child import main; main()", str(path)],
        cwd=path / "work", stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        start_new_session=True,
    )  # fmt: skip
    folder.also_kills(process.pid)
    printed = _Tail(process)
    try:
        in_time = _wait(process, path / "status", time_limit_s, job["stop_s"], progress)
    finally:
        _end(process)
        printed.join()
    time_s, doing = read_status((path / "status").read_bytes())
    words = printed.last_lines()
    if not in_time:
        limit = f"not finished after {time_limit_s:g} s (--time-limit), in {doing}"
        raise FmuStoppedError(name, one_line(f"{limit}. {words}"), time_s)
    how = _how_it_ended(process.returncode)
    if not (path / "result.json").is_file():
        raise FmuStoppedError(name, one_line(f"the FMU's process {how} in {doing}. {words}"), time_s)
    error = json.loads((path / "result.json").read_text(encoding="utf-8"))["error"]
    if error is not None:
        raise SimulationError(name, one_line(f"{error} {words}"), time_s)
    traces = np.load(path / "traces.npy", allow_pickle=False)
    after = f"{name}: the run is complete, but then the FMU's process {how} in {doing}" if process.returncode else ""
    return traces, after


def _wait(
    process: subprocess.Popen[bytes],
    status: Path,
    time_limit_s: float | None,
    stop_s: float,
    progress: Callable[[float, float], None] | None,
) -> bool:
    """Whether it ended within the limit."""
    end = None if time_limit_s is None else time.monotonic() + time_limit_s
    while True:
        try:
            process.wait(POLL_S)
        except subprocess.TimeoutExpired:
            if progress is not None:
                progress(read_status(status.read_bytes())[0], stop_s)
            if end is not None and time.monotonic() > end:
                return False
        else:
            return True


def _end(process: subprocess.Popen[bytes]) -> None:
    """Including all processes that the FMU started."""
    if hasattr(os, "killpg"):
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()
    process.wait()


def _how_it_ended(code: int) -> str:
    return f"ended with {signal_name(-code)}" if code < 0 else f"ended by itself (exit code {code})"


class _Tail:
    """Reads the FMU's printed output, which may be endless, and keeps the end."""

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        assert process.stdout is not None
        self._stream = process.stdout
        self._kept = b""
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        while piece := os.read(self._stream.fileno(), 1 << 16):
            self._kept = (self._kept + piece)[-LAST_BYTES:]
            _log.debug("%s", piece.decode("utf-8", "replace").rstrip())

    def join(self) -> None:
        self._thread.join(1.0)

    def last_lines(self) -> str:
        lines = [line.strip() for line in self._kept.decode("utf-8", "replace").splitlines()]
        return " ".join([line for line in lines if line][-LAST_LINES:])
