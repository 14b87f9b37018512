"""A robot file with some values replaced, or added at its end; comments, order and everything else stay as they are."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from giveway.base.checks import finite
from giveway.base.errors import FileError
from giveway.robot.robot_file import read_robot

__all__ = ["NewValue", "changed_robot"]


@dataclass(frozen=True)
class NewValue:
    """A new value for an entry of a robot file; the unit in the file is kept.

    Attributes:
        value: in the unit of the variable tables.
        source: its source.
        provenance: given, sourced, fitted or assumed.
        confidence: high, medium or low; None: unchanged.
        note: a remark; None: unchanged.
        unit: of an entry that the file does not have yet; None: only entries that it has are changed.
    """

    value: float
    source: str
    provenance: str
    confidence: str | None = None
    note: str | None = None
    unit: str | None = None


def changed_robot(path: Path, changes: Mapping[str, NewValue]) -> str:
    """The text of the robot file ``path`` with the entries ``changes`` ("roller.coulomb_torque") replaced."""
    import tomlkit
    from tomlkit.items import AbstractTable

    robot = read_robot(path)
    document = tomlkit.parse(path.read_text(encoding="utf-8-sig"))
    stated: dict[str, float] = {}
    added: dict[str, NewValue] = {}
    for name, new in changes.items():
        if new.unit is not None and name not in robot:
            finite(name, new.value)
            added[name] = new
            continue
        if robot.follows_from(name):
            raise FileError(path, f"{name} cannot be replaced: it follows from {robot.follows_from(name)}")
        stated[name] = finite(name, new.value) / robot[name].scale
        table = document
        for key in name.split("."):
            table = table[key]
        assert isinstance(table, AbstractTable)
        table["value"] = stated[name]
        for key in ("source", "confidence", "provenance", "note"):
            words = getattr(new, key)
            if words is not None:
                table[key] = words
    text = tomlkit.dumps(document)
    _check(path, text, stated)
    return text if not added else _with_entries(path, text, added)


def _with_entries(path: Path, text: str, added: Mapping[str, NewValue]) -> str:
    """``text`` with entries at its end that it does not have."""
    lines = [text.rstrip("\n"), ""]
    for name, new in added.items():
        lines.append(f"[{name}]")
        remarks = {"unit": new.unit, "source": new.source, "confidence": new.confidence, "provenance": new.provenance}
        lines.append(f"value = {new.value!r}")
        for key, words in {**remarks, "note": new.note}.items():
            if words is not None:
                lines.append(f"{key} = {json.dumps(words, ensure_ascii=False)}")
        lines.append("")
    longer = "\n".join(lines)
    try:
        found = tomllib.loads(longer)
    except tomllib.TOMLDecodeError as error:
        reason = f"{next(iter(added))} cannot be added: {error}"
        raise FileError(path, reason, "write [controller.channels.fast_rest] as a table of its own") from None
    for name in added:
        *tables, key = name.split(".")
        inner = found
        for table in tables:
            inner = inner[table]
        del inner[key]
        while tables and not inner and not _has(tomllib.loads(text), tables):
            *tables, key = tables
            inner = found
            for table in tables:
                inner = inner[table]
            del inner[key]
    if found != tomllib.loads(text):
        raise FileError(path, "could not be changed without changing more than was wanted")
    return longer


def _has(document: Mapping[str, Any], tables: list[str]) -> bool:
    """Whether there is such a table."""
    for name in tables:
        if name not in document:
            return False
        document = document[name]
    return True


def _check(path: Path, text: str, changes: Mapping[str, float]) -> None:
    """Checks that the new text equals the old one except for ``changes``, the new values by name."""
    old, new = tomllib.loads(path.read_text(encoding="utf-8-sig")), tomllib.loads(text)
    for name, value in changes.items():
        *tables, key = name.split(".")
        before, after = old, new
        for table in tables:
            before, after = before[table], after[table]
        if after[key]["value"] != value:
            raise FileError(path, f"{name} could not be replaced")
        before[key] = after[key]
    if old != new:
        raise FileError(path, "could not be changed without changing more than was wanted")
