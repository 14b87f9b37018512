"""Output of every probe: one line of JSON per completed stage, so that a crash shows how far it got."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

STEP_S = 1e-3


def say(stage: str, **facts: Any) -> None:
    """Stage ``stage`` is done."""
    print(json.dumps({"stage": stage, **facts}), flush=True)


@contextmanager
def stage(name: str) -> Iterator[dict[str, Any]]:
    """Reports a stage as done when its block ends; an exception is reported, too, and ends the probe."""
    facts: dict[str, Any] = {}
    try:
        yield facts
    except Exception as error:
        say(name, failed=" ".join(f"{type(error).__name__}: {error}".split())[:300])
        raise SystemExit(1) from None
    say(name, **facts)


def write_trace(path: str, names: list[str], rows: list[list[float]]) -> None:
    """Rows of (time, values) with every digit."""
    lines = [",".join(["time", *names]), *(",".join(float(value).hex() for value in row) for row in rows)]
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")
