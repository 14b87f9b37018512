"""Values, comments and tables as text of C."""

from __future__ import annotations

import textwrap

import numpy as np

from giveway.base.errors import one_line
from giveway.robot.variables import Value, Variable

__all__ = ["comment", "literal", "quoted", "real"]

COLUMNS = 120


def real(value: float) -> str:
    """The shortest literal of type float with the bits that the FMU makes of ``value``."""
    text = str(np.float32(value))
    return f"{text if '.' in text or 'e' in text else text + '.0'}F"


def literal(variable: Variable, value: Value) -> str:
    """The value of a parameter; counts of the C library are unsigned."""
    if variable.type == "boolean":
        return "true" if value else "false"
    return f"{int(value)}U" if variable.type == "integer" else real(float(value))


def comment(text: str, indent: str = "") -> str:
    """``text`` as a comment of one or more lines that ends with a line break; whatever it holds, it stays a comment."""
    safe = one_line(text).replace("*/", "* /").replace("/*", "/ *").replace("\\", "/")
    lines = textwrap.wrap(safe, COLUMNS - len(indent) - 6, break_long_words=False) or [""]
    return f"{indent}/* " + f"\n{indent} * ".join(lines) + " */\n"


def quoted(text: str) -> str:
    """``text`` as a string of C, ASCII."""
    plain = one_line(text).encode("ascii", "replace").decode().replace("\\", "\\\\").replace('"', '\\"')
    return f'"{plain.replace("??", "?")}"'
