"""documentation/index.html of an FMU: what it is, its equations and a table of its variables. Needs no network."""

from __future__ import annotations

from html import escape
from pathlib import Path

from .errors import TableError
from .mathml import mathml
from .table import Group, Table, Variable

__all__ = ["page"]

_STYLE = """body{font:15px/1.4 sans-serif;margin:2em auto;max-width:75em;padding:0 1em}
table{border-collapse:collapse}td,th{border-bottom:1px solid #ccc;padding:.2em .8em .2em 0;text-align:left}
td.number{text-align:right;font-variant-numeric:tabular-nums}
math{font-size:115%}math[display=block]{width:max-content;margin:.6em 0 .6em 2em}"""


def _number(value: object) -> str:
    return "" if value is None else escape(str(value).lower())


def _row(group: Group, variable: Variable) -> str:
    origin = f"; start value: {variable.robot_path} of the robot file" if variable.robot_path else ""
    cells = [
        f"<td><code>{escape(variable.name)}</code></td>",
        f"<td>{group.type}</td>",
        f"<td>{escape(group.unit or '')}</td>",
        *(f'<td class="number">{_number(value)}</td>' for value in (variable.start, group.minimum, group.maximum)),
        f"<td>{escape(group.description + origin)}</td>",
        f'<td class="number">{variable.reference}</td>',
    ]
    return f"<tr>{''.join(cells)}</tr>"


def _feedthrough(table: Table) -> str:
    inputs = {group.name for group in table.groups if group.causality == "input"}
    direct = [g.name for g in table.groups if g.causality == "output" and inputs & set(g.dependencies or ())]
    if not direct:
        return "No output follows an input within the same instant."
    names = ", ".join(f"<code>{escape(name)}</code>" for name in direct)
    return f"Within the same instant, outputs that follow inputs are {names}."


def _words(text: str) -> str:
    """A paragraph's text; text between grave accents is mathematics."""
    parts = text.split("`")
    return "".join(mathml(part, "inline") if i % 2 else escape(part) for i, part in enumerate(parts))


def _equations(path: Path | None) -> str:
    """Sections of a text file: headings start with ``#``, equations with four blanks, the rest are paragraphs."""
    if path is None:
        return ""
    parts: list[str] = []
    for block in path.read_text(encoding="utf-8").split("\n\n"):
        lines = block.strip("\n").splitlines()
        try:
            if block.startswith("#"):
                parts.append(f"<h2>{escape(block.lstrip('# '))}</h2>")
            elif lines and lines[0].startswith("    "):
                parts += [mathml(line) for line in lines]
            elif lines:
                parts.append(f"<p>{_words(' '.join(lines))}</p>")
        except ValueError as error:
            raise TableError(f"{path}: {lines[0].strip()!r}: {error}") from error
    return "\n".join(parts) + "\n"


def page(table: Table, version: str, equations: Path | None = None) -> str:
    """The page; ``equations`` is a text file (see `_equations`)."""
    titles = ("Name", "Type", "Unit", "Start", "Minimum", "Maximum", "Meaning", "Reference")
    sections = []
    for causality in ("input", "output", "parameter", "local"):
        rows = [_row(group, variable) for group, variable in table.scalars if group.causality == causality]
        if rows:
            head = "".join(f"<th>{title}</th>" for title in titles)
            body = "\n".join(rows)
            title = "States, derivatives, event indicators" if causality == "local" else f"{causality.capitalize()}s"
            sections.append(f"<h2>{title}</h2>\n<table>\n<tr>{head}</tr>\n{body}\n</table>")
    exchange = " and Model Exchange" if table.has_equations else ""
    return f"""<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><title>giveway {table.name}</title><style>{_STYLE}</style></head>
<body>
<h1>giveway {table.name} {escape(version)}</h1>
<p>{escape(table.description)}.</p>
<p>Co-Simulation{exchange}; variable communication step size, made for {table.step_size} s. Inputs are held constant
over a step and outputs are valid at its end. {_feedthrough(table)} Ranges are inclusive; a value outside its range, or
not finite, is refused with a message. Parameters can be set until initialisation ends.</p>
{_equations(equations)}{chr(10).join(sections)}
<p>Licences: <a href="licenses/license.txt">licenses/license.txt</a>.</p>
</body>
</html>
"""
