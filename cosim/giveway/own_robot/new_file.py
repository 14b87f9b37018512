"""The text of a new robot file: every entry with a comment, and with what it is based on."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator
from typing import TYPE_CHECKING

from giveway.base import native
from giveway.own_robot.estimates import ENTRIES, Entry, Known
from giveway.own_robot.measured import QUESTIONS
from giveway.robot.variables import table

if TYPE_CHECKING:
    from giveway.own_robot.measured import Measured

__all__ = ["robot_text"]

DIGITS, WIDTH = 3, 120
HEAD = """\
#:schema robot.schema.json
# Every number of this robot with its unit, source and confidence, as `giveway robot new` wrote it: look through what
# `giveway robot check` lists, replace each estimate by a better number, and say where that comes from.
# provenance: given (you measured it), sourced (found in a data sheet), fitted (to measurements), assumed (estimated).
# Numbers in brackets, (28), are equations of Kim, Llado, Sentis, Auton Robot 40:325 (2016).
"""


def robot_text(asked: Measured) -> str:
    """The file for what was asked; all else is estimated, and says so."""
    known = Known(asked)
    lines = [HEAD, "schema_version = 1", "", "[robot]", f"name = {_quoted(asked.name)}"]
    for part in ENTRIES:
        if part.imu and not asked.imu:
            continue
        lines += ["", f"# --- {part.heading}", *(f"# {line}" for line in part.remark.splitlines())]
        for entry in part.entries:
            if entry.by_current not in (None, known.by_current):
                continue
            lines += ["", *_lines(entry, known)]
    return "\n".join(lines) + "\n"


def _lines(entry: Entry, known: Known) -> Iterator[str]:
    given = bool(entry.asked) and getattr(known.asked, entry.asked.replace("-", "_")) is not None
    value = entry.value(known)
    question = QUESTIONS.get(entry.asked)
    about = question.text if question is not None and question.unit and entry.unit else _description(entry.name)
    yield from (f"# {line}" for line in textwrap.wrap(about, WIDTH - 2))
    yield f"[{entry.name}]"
    yield f"value = {_number(value, given)}"
    if entry.unit:
        yield f"unit = {_quoted(entry.unit)}"
    if given:
        yield 'source = "stated to giveway robot new"'
        yield 'confidence = "medium"'
        yield 'provenance = "given"'
        return
    yield f"source = {_quoted('estimate of giveway robot new: ' + entry.rule if entry.rule else 'giveway robot new')}"
    yield 'confidence = "low"'
    yield 'provenance = "assumed"'


def _description(name: str) -> str:
    """What the FMUs' tables say about an entry."""
    for model in native.MODELS[::-1]:
        variables = table(model)
        for variable in variables:
            if variables.robot_name(variable) == name:
                return variable.description
    return ""


def _number(value: object, exact: bool) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, int | list):
        return str(value)
    assert isinstance(value, float)
    return repr(value if exact else float(f"{value:.{DIGITS}g}"))


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
