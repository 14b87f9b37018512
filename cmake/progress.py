"""`python progress.py WORDS COMMAND...`: run a build with one line of progress instead of Ninja's and CMake's many.

On a terminal the line is `WORDS: 34 of 120`, replaced as it goes; elsewhere a new one comes now and then. A build of
less than a second says nothing. What compilers and linkers say comes through, and so does the exit code.
"""

from __future__ import annotations

import re
import subprocess
import sys
import time
from collections.abc import Sequence
from typing import TextIO

STATUS = re.compile(r"^(?:\x1b\[[0-9;]*m)*\[(FMUs )?(\d+)/(\d+)\] ")  # [FMUs 5/80] is from a tree inside the tree
CHATTER = re.compile(r"^(-- |ninja: (no work to do\.|Entering directory)|\s*$)")
QUIET_S = 1.0
BETWEEN_LINES_S = 15.0


class Progress:
    """How far the build is, and of the trees inside it: the number of their steps is known when they begin."""

    def __init__(self, words: str, out: TextIO) -> None:
        self._words = words
        self._out = out
        self._start = self._said = time.monotonic()
        self._steps = {"": (0, 0), "FMUs ": (0, 0)}  # of the tree, and of the one that is built inside it
        self._inside_done = 0  # steps of those that came before
        self._is_shown = False

    def step(self, tree: str, done: int, total: int) -> None:
        before, _ = self._steps[tree]
        if tree and done < before:
            self._inside_done += before
        self._steps[tree] = (done, total)
        now = time.monotonic()
        if now - self._start < QUIET_S or not (self._out.isatty() or now - self._said > BETWEEN_LINES_S):
            return
        self._said = now
        self._show()

    def _show(self) -> None:
        done = sum(done for done, _ in self._steps.values()) + self._inside_done
        total = sum(total for _, total in self._steps.values()) + self._inside_done
        line = f"{self._words}: {done} of {total}"
        self._out.write(f"\r\x1b[K{line}" if self._out.isatty() else f"{line}\n")
        self._out.flush()
        self._is_shown = True

    def clear(self) -> None:
        """Make room for another line."""
        if self._is_shown and self._out.isatty():
            self._out.write("\r\x1b[K")

    def end(self) -> None:
        seconds = time.monotonic() - self._start
        if seconds >= QUIET_S:
            self.clear()
            steps = sum(done for done, _ in self._steps.values()) + self._inside_done
            self._out.write(f"{self._words}: {steps} steps in {seconds:.0f} s\n")
            self._out.flush()


def main(words: str, command: Sequence[str]) -> int:
    progress = Progress(words, sys.stdout)
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    assert process.stdout is not None
    for line in process.stdout:
        if match := STATUS.match(line):
            progress.step(match[1] or "", int(match[2]), int(match[3]))
        elif not CHATTER.match(line):
            progress.clear()
            sys.stdout.write(line)
            sys.stdout.flush()
    code = process.wait()
    if code == 0:
        progress.end()
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
