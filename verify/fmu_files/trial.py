"""Gives one file to the commands, and judges what happened."""

from __future__ import annotations

import functools
import io
import os
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType

from verify.fmu_files.make import Base, hostile

__all__ = ["LONGEST_S", "MOST_MB", "Folders", "Trial", "try_seed"]

LONGEST_S, MOST_MB = 10.0, 500.0  # the promise for any file; processor time, which does not depend on other processes
RUN_EVERY = 60  # one in this many of the files that may be run is run: a run takes a second
INFO_EVERY = 3  # as slow as `check`
LIST_EVERY = 9  # printing tables takes longer than reading
RUN_LIMIT_S = 8.0
ALLOWED_CODES = {"check": (0, 1, 2), "info": (0, 2), "run": (0, 1, 2)}


class _TooLongError(BaseException):
    """Raised by the alarm clock."""


@dataclass(frozen=True)
class Folders:
    """Where files are tried.

    Attributes:
        cage: the commands can touch nothing outside of it, and may write only to `temporary` in it.
        outside: where absolute names point to; has to stay empty.
    """

    cage: Path
    outside: Path

    @property
    def temporary(self) -> Path:
        return self.cage / "deep" / "temporary"

    @property
    def file(self) -> Path:
        return self.cage / "case.fmu"

    def make(self) -> None:
        for folder in (self.temporary, self.outside):
            folder.mkdir(parents=True, exist_ok=True)


@dataclass
class Trial:
    """The outcome of one file.

    Attributes:
        codes: exit code by command.
        bad: what went wrong, in words; empty if nothing did.
    """

    seed: int
    kind: str
    codes: dict[str, int] = field(default_factory=dict)
    bad: list[str] = field(default_factory=list)
    seconds: float = 0.0
    memory_mb: float = 0.0


def try_seed(seed: int, bases: list[Base], folders: Folders, kind: str = "") -> Trial:
    """Make the file, pass it to `check` and to `info` or `run`, and check what they leave behind."""
    made = hostile(seed, bases, str(folders.outside), kind)
    folders.file.write_bytes(made.content)
    trial = Trial(seed, made.kind)
    runs = made.may_run and seed % RUN_EVERY == 0
    commands: dict[str, list[str]] = {"check": []}
    if runs:
        commands["run"] = [
            "--time-limit",
            str(RUN_LIMIT_S),
            "--stop",
            "0.01",
            "--out",
            str(folders.temporary / "o.csv"),
        ]
    elif seed % INFO_EVERY == 0:
        commands["info"] = ["--variables"] if seed % LIST_EVERY == 0 else []
    for command, options in commands.items():
        _try(trial, command, [command, str(folders.file), *options], folders)
    return trial


def _try(trial: Trial, command: str, arguments: list[str], folders: Folders) -> None:
    tempfile.tempdir = str(folders.temporary)
    said, complained = io.StringIO(), io.StringIO()
    _reset_peak()
    start = time.process_time()
    signal.signal(signal.SIGPROF, _ring)
    signal.setitimer(signal.ITIMER_PROF, LONGEST_S)
    try:
        with redirect_stdout(said), redirect_stderr(complained):
            trial.codes[command] = _call(arguments)
    except _TooLongError:
        trial.bad.append(f"{command}: over {LONGEST_S:g} s")
    except BaseException as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(where.filename).name}:{where.lineno}"
        trial.bad.append(f"{command}: traceback: {type(error).__name__} at {place}: {str(error)[:200]}")
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    seconds, memory = time.process_time() - start, _peak_mb()
    trial.seconds, trial.memory_mb = max(trial.seconds, seconds), max(trial.memory_mb, memory)
    if memory > MOST_MB:
        trial.bad.append(f"{command}: {memory:.0f} MB of memory")
    code = trial.codes.get(command)
    if code is not None and code not in ALLOWED_CODES[command]:
        trial.bad.append(f"{command}: exit code {code}")
    if "Traceback" in said.getvalue() + complained.getvalue():
        trial.bad.append(f"{command}: traceback in its output")
    if complained.getvalue().count("\n") > 1:
        trial.bad.append(f"{command}: more than one line: {complained.getvalue()[:200]}")
    _look_for_leftovers(trial, command, folders)


def _call(arguments: list[str]) -> int:
    """The command line without its last exception handler, so that unexpected exceptions come through."""
    from giveway.base.errors import GivewayError

    try:
        code = _commands()(args=arguments, standalone_mode=False)
    except GivewayError as error:
        print(f"giveway: {error}", file=sys.stderr)
        return 2
    return code if isinstance(code, int) else 0


@functools.cache
def _commands() -> Callable[..., object]:
    """Made once: for Typer this takes longer than most files."""
    from giveway.fmu_tools.command import fmu_app
    from typer.main import get_command

    return get_command(fmu_app)


def _look_for_leftovers(trial: Trial, command: str, folders: Folders) -> None:
    (folders.temporary / "o.csv").unlink(missing_ok=True)
    expected = {folders.file, folders.temporary, folders.temporary.parent}
    strangers = [path for path in folders.cage.rglob("*") if path not in expected]
    strangers += list(folders.outside.iterdir())
    for path in strangers:
        where = "left behind" if folders.temporary in path.parents else "written outside"
        trial.bad.append(f"{command}: {where}: {str(path)[-100:]}")
        shutil.rmtree(path, ignore_errors=True) if path.is_dir() else path.unlink(missing_ok=True)


def _ring(_number: int, _frame: FrameType | None) -> None:
    raise _TooLongError


def _reset_peak() -> None:
    Path("/proc/self/clear_refs").write_text("5")


def _peak_mb() -> float:
    """Largest resident memory of this process since it was reset."""
    lines = Path(f"/proc/{os.getpid()}/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM:")) / 1024.0
