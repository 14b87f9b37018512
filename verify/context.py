"""The context of a rung: its folders, and tools run within limits of memory and time."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from verify.failure import RungFailed

__all__ = ["PYTEST", "Context", "Finished", "Tool", "kill_all"]

LAST_LINES = 60  # characters of a tool's output that are kept as evidence

_running: set[subprocess.Popen[str]] = set()
_running_lock = threading.Lock()


@dataclass(frozen=True)
class Tool:
    """A program that a rung calls, and how it is asked for its version."""

    name: str
    version: tuple[str, ...] = ("--version",)
    package: str = ""  # the package to install, if its name is not that of the tool
    folder: Path | None = None  # looked into before the PATH


# Of this interpreter: the tools have a pytest of their own, in front on the PATH, without the project.
PYTEST = Tool("pytest", folder=Path(sys.executable).parent)


@dataclass(frozen=True)
class Finished:
    command: tuple[str, ...]
    returncode: int
    stdout: str
    stderr: str

    @property
    def evidence(self) -> str:
        lines = (self.stdout + self.stderr).strip().splitlines()
        return "\n".join([f"$ {' '.join(self.command)}", f"exit code {self.returncode}", *lines[-LAST_LINES:]])


@dataclass(frozen=True)
class Context:
    """``root``: the repository. ``work``: an empty folder of the rung's own, kept until its next run."""

    root: Path
    work: Path
    path: str = field(default_factory=lambda: os.environ["PATH"])

    @property
    def core(self) -> Path:
        return self.root / "c_core"

    def which(self, tool: Tool) -> str:
        """The tool's program; `RungFailed` if it is not there."""
        path = self.path if tool.folder is None else f"{tool.folder}{os.pathsep}{self.path}"
        found = shutil.which(tool.name, path=path)
        if found is None:
            package = f" (package {tool.package})" if tool.package else ""
            raise RungFailed(f"missing tool: {tool.name}{package}; see verify/system_packages.sh")
        return found

    def run(
        self,
        *command: str | Path,
        cwd: Path | None = None,
        timeout_s: float = 600.0,
        memory_gib: float | None = 4.0,
        environment: Mapping[str, str] | None = None,
        expect: int | None = 0,
    ) -> Finished:
        """Run a program; `RungFailed` unless it exits with ``expect`` (None: with anything) in time.

        ``memory_gib`` limits the address space, of each process; None is for programs that reserve terabytes of it
        and use little (AddressSanitizer, wine).
        """
        words = tuple(str(word) for word in command)
        limited = words
        if memory_gib is not None:
            limited = ("bash", "-c", 'ulimit -v "$0" && exec "$@"', str(int(memory_gib * 2**20)), *words)
        process = subprocess.Popen(
            limited,
            cwd=cwd or self.work,
            env={**os.environ, "PATH": self.path, **(environment or {})},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            start_new_session=True,  # so that a time-out ends its children too
        )
        with _running_lock:
            _running.add(process)
        try:
            stdout, stderr = process.communicate(timeout=timeout_s)
        except subprocess.TimeoutExpired:
            _kill(process)
            stdout, stderr = process.communicate()
            raise RungFailed(f"$ {' '.join(words)}\nnot finished after {timeout_s:.0f} s\n{stdout}{stderr}") from None
        finally:
            with _running_lock:
                _running.discard(process)
        finished = Finished(words, process.returncode, stdout, stderr)
        if expect is not None and finished.returncode != expect:
            raise RungFailed(finished.evidence)
        return finished


def _kill(process: subprocess.Popen[str]) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def kill_all() -> None:
    """End every program that is still running (the user has interrupted)."""
    with _running_lock:
        for process in _running:
            _kill(process)
