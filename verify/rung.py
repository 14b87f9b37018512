"""What a rung of the ladder is: a check with the tools it needs, and the figure it gives."""

from __future__ import annotations

import importlib
import pkgutil
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

from verify.context import Context, Tool
from verify.failure import RungFailed
from verify.sources import CORE

__all__ = ["Figure", "Rung", "RungFailed", "Value", "all_rungs", "planted"]

NAME = re.compile(r"r\d\d_(\w+)")


Value = str | int | float | bool


@dataclass(frozen=True)
class Figure:
    """What a rung measured: one line for people, and the values for summary.json and VERIFIED.json.

    ``varies``: text about results that differ between runs, such as how much was done in a given time. It is printed
        and stored in summary.json, but not in VERIFIED.json, which is the same for the same sources.
    """

    text: str
    values: Mapping[str, Value] = field(default_factory=dict)
    varies: str = ""

    @property
    def words(self) -> str:
        """All of it."""
        return f"{self.text} ({self.varies})" if self.varies else self.text


@dataclass(frozen=True)
class Rung:
    """A check. ``check`` returns its figure or raises `RungFailed` with the evidence.

    ``remeasure`` returns the values that are cheap to measure: `make test` compares them with VERIFIED.json, so it may
    use only tools that `make test` has.

    ``subject``: patterns of the files, relative to the repository's root, that the result is about. It stands as long
    as they have not changed.
    """

    summary: str
    tools: tuple[Tool, ...]
    check: Callable[[Context], Figure]
    remeasure: Callable[[Context], Mapping[str, Value]] | None = None
    subject: tuple[str, ...] = CORE


@contextmanager
def planted(fault: str, *, shows: str) -> Iterator[None]:
    """The block runs a check on a planted fault: it has to fail with evidence that matches ``shows``."""
    try:
        yield
    except RungFailed as failure:
        if re.search(shows, failure.evidence):
            return
        raise RungFailed(f"planted fault ({fault}): failed for another reason\n{failure.evidence}") from None
    raise RungFailed(f"planted fault ({fault}): went unseen")


def all_rungs() -> dict[str, Rung]:
    """Every rung by name, in the order of the files' numbers: rungs/r10_misra.py holds ``misra``."""
    from verify import rungs

    found: dict[str, Rung] = {}
    for module in sorted(info.name for info in pkgutil.iter_modules(rungs.__path__)):
        match = NAME.fullmatch(module)
        if match is None:
            raise ValueError(f"verify/rungs/{module}.py: the name has to be rNN_NAME.py")
        rung = importlib.import_module(f"verify.rungs.{module}").RUNG
        assert isinstance(rung, Rung), module
        found[match[1]] = rung
    return found
