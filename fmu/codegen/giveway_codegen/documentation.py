"""documentation/index.html of an FMU: what it is and a table of its variables."""

from __future__ import annotations

from html import escape

from .table import Group, Table, Variable

__all__ = ["page"]

_STYLE = """body{font:15px/1.4 sans-serif;margin:2em auto;max-width:75em;padding:0 1em}
table{border-collapse:collapse}td,th{border-bottom:1px solid #ccc;padding:.2em .8em .2em 0;text-align:left}
td.number{text-align:right;font-variant-numeric:tabular-nums}"""


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


def page(table: Table, version: str) -> str:
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
<p>Co-Simulation{exchange}; any communication step size, made for {table.step_size} s. Inputs are held constant over a
step and outputs are valid at its end. {_feedthrough(table)} Ranges are inclusive; a value outside its range, or not
finite, is refused with a message. Parameters can be set until initialisation ends.</p>
{chr(10).join(sections)}
</body>
</html>
"""
