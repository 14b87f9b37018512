"""Serial lines: to a program of this computer, which qemu can be, and to a device."""

from __future__ import annotations

import abc
import contextlib
import os
import select
import subprocess
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

from giveway.base.errors import FileError, GivewayError, system_words
from giveway.firmware.frames import LineError

__all__ = ["BAUD", "DeviceLine", "ProgramLine"]

BAUD = 115200
_CHUNK = 4096
_END_S = 5.0  # a program that is told to end may take so long


class _Line(abc.ABC):
    """Reading and writing of file descriptors."""

    def __init__(self, reads: int, writes: int) -> None:
        self._reads, self._writes = reads, writes

    def write(self, data: bytes) -> None:
        """All of ``data``."""
        try:
            while data:
                data = data[os.write(self._writes, data) :]
        except OSError as error:
            raise LineError(self._gone(error)) from None

    def read(self, timeout_s: float) -> bytes:
        """What is there; TimeoutError if that is nothing for so long."""
        ready, _, _ = select.select([self._reads], [], [], timeout_s)
        if not ready:
            raise TimeoutError
        try:
            data = os.read(self._reads, _CHUNK)
        except OSError as error:
            raise LineError(self._gone(error)) from None
        if not data:
            raise LineError(self._gone(None))
        return data

    @abc.abstractmethod
    def _gone(self, error: OSError | None) -> str:
        """Why nothing comes any more."""


class ProgramLine(_Line):
    """A program whose standard input and output are the line; a context manager that ends it."""

    def __init__(self, command: Sequence[str]) -> None:
        self._name = Path(command[0]).name
        try:
            # A session of its own: Ctrl-C is for the simulation, which ends it.
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                bufsize=0,
                start_new_session=True,
            )
        except OSError as error:
            raise FileError(command[0], f"cannot be started: {system_words(error)}") from None
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        super().__init__(self._process.stdout.fileno(), self._process.stdin.fileno())

    @property
    def process_id(self) -> int:
        """Of the program."""
        return self._process.pid

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        with self._process:  # closes the pipes and waits
            self._process.terminate()
            try:
                self._process.wait(_END_S)
            except subprocess.TimeoutExpired:
                self._process.kill()

    def _gone(self, _error: OSError | None) -> str:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_END_S)
        assert self._process.stderr is not None
        said = self._process.stderr.read().decode("utf-8", "replace").strip().splitlines()
        code = self._process.returncode
        words = f"signal {-code}" if code is not None and code < 0 else f"exit code {code}"
        return f"{self._name} ended with {words}" + (f": {said[-1]}" if said else "")


class DeviceLine(_Line):
    """A serial device, 8 data bits, no parity; a context manager that closes it."""

    def __init__(self, path: Path, baud: int) -> None:
        import termios
        import tty

        speed = getattr(termios, f"B{baud}", None)
        if speed is None:
            known = sorted(int(name[1:]) for name in dir(termios) if name[0] == "B" and name[1:].isdigit())
            raise GivewayError(f"--controller {path}@{baud}", baud, ", ".join(map(str, known[1:])))
        try:
            device = os.open(path, os.O_RDWR | os.O_NOCTTY)
        except OSError as error:
            raise FileError(path, f"cannot be opened: {system_words(error)}") from None
        try:
            tty.setraw(device)
            settings = termios.tcgetattr(device)
            settings[4] = settings[5] = speed
            termios.tcsetattr(device, termios.TCSANOW, settings)
            termios.tcflush(device, termios.TCIOFLUSH)
        except termios.error:
            os.close(device)
            raise FileError(path, "is not a serial device") from None
        self._path, self._device = path, device
        super().__init__(device, device)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, _type: type[BaseException] | None, _error: BaseException | None, _traceback: TracebackType | None
    ) -> None:
        os.close(self._device)

    def _gone(self, error: OSError | None) -> str:
        return f"{self._path} is gone" + (f": {system_words(error)}" if error is not None else "")
