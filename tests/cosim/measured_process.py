"""A command with its peak memory and processor time.

It is started by a small process of its own: Linux counts the memory that a process held before it became the command,
and a whole test run holds more than the command may take.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

STARTER = """
import os, sys
pid = os.posix_spawn(sys.argv[2], sys.argv[2:], os.environ)
_, status, usage = os.wait4(pid, 0)
with open(sys.argv[1], "w") as file:
    print(os.waitstatus_to_exitcode(status), usage.ru_maxrss, usage.ru_utime + usage.ru_stime, file=file)
"""


@dataclass(frozen=True)
class Measured:
    """What a command did.

    Attributes:
        code: its exit code.
        said: standard output and error.
        memory_kb, processor_s: peak memory of the largest process, processor time of all of them.
    """

    code: int
    said: str
    memory_kb: int
    processor_s: float


def measure(command: Sequence[str], folder: Path, environment: Mapping[str, str] | None = None) -> Measured:
    """Run ``command``; ``folder`` takes the file with the figures."""
    figures = folder / "figures.txt"
    answer = subprocess.run(
        [sys.executable, "-I", "-S", "-c", STARTER, str(figures), *command],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=True,
    )
    code, memory_kb, processor_s = figures.read_text().split()
    return Measured(int(code), answer.stdout, int(memory_kb), float(processor_s))
