"""The committed list of mutants that no test sees, each with the reason why no test can or has to."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from verify.failure import RungFailed
from verify.mutation.mutants import Key, Mutant

__all__ = ["LIST", "entries", "read", "wrong"]

LIST = "verify/mutation/survivors.toml"
FIELDS = {"file": str, "function": str, "line": str, "change": str, "nth": int}


def read(root: Path, listed: str = LIST) -> dict[Key, str]:
    """The reason of every mutant in the list, a file below ``root``; `RungFailed` if an entry is not one."""
    document = tomllib.loads((root / listed).read_text(encoding="utf-8"))
    reasons: dict[Key, str] = {}
    for group in document.get("reason", []):
        why = group.get("why", "")
        if not (isinstance(why, str) and why.strip()):
            raise RungFailed(f"{listed}: a group without a reason: {group}")
        for entry in group.get("mutants", []):
            key = _key(entry, listed)
            if key in reasons:
                raise RungFailed(f"{listed}: listed twice: {_entry(key)}")
            reasons[key] = why
    return reasons


def _key(entry: Mapping[str, Any], listed: str) -> Key:
    if {name: type(value) for name, value in entry.items()} != FIELDS:
        raise RungFailed(f"{listed}: an entry has exactly {', '.join(FIELDS)}: {entry}")
    return Key(**entry)


def wrong(
    reasons: Mapping[Key, str], everything: Iterable[Mutant], killed: Iterable[Mutant], survived: Iterable[Mutant]
) -> list[str]:
    """The errors of the list; for mutants that were not tried it only checks that they still exist."""
    existing = {mutant.key for mutant in everything}
    unlisted = [mutant.key for mutant in survived if mutant.key not in reasons]
    dead = [mutant.key for mutant in killed if mutant.key in reasons]
    gone = [key for key in reasons if key not in existing]
    return [
        *_section("survived, and not listed: test it, or list it with a reason", unlisted),
        *_section("listed, but killed: take it off the list", dead),
        *_section("listed, but there is no such mutant any more: take it off the list", gone),
    ]


def _section(heading: str, keys: Iterable[Key]) -> list[str]:
    lines = entries(keys)
    return [f"{len(lines)} {heading}", *lines] if lines else []


def entries(keys: Iterable[Key]) -> list[str]:
    """In the form of the list."""
    return [_entry(key) for key in sorted(keys)]


def _entry(key: Key) -> str:
    # A JSON string is also a TOML string.
    values = (f"{name} = {json.dumps(getattr(key, name))}" for name in FIELDS)
    return f"    {{ {', '.join(values)} }},"
