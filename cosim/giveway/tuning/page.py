"""The report of `giveway tune` as one self-contained HTML page: its tables and sentences."""

from __future__ import annotations

import html

from giveway.report.page import page
from giveway.tuning.told import Table, remarks, tables
from giveway.tuning.tuned import Tuned

__all__ = ["page_text"]


def page_text(tuned: Tuned) -> str:
    """The whole page; it needs no script's data."""
    parts = [f"<h1>Thresholds of {html.escape(tuned.robot)}</h1>"]
    logs = ", ".join(f"{name} ({digits})" for name, digits in tuned.logs)
    parts.append(f"<p>From {html.escape(logs)}</p>")
    parts += [_table(one) for one in tables(tuned)]
    parts.append("<ul>" + "".join(f"<li>{html.escape(line)}</li>" for line in remarks(tuned)) + "</ul>")
    return page("report", f"Thresholds of {tuned.robot}", {"figures": []}, body="\n".join(parts))


def _table(one: Table) -> str:
    title, header, rows = one
    head = "".join(f'<th scope="col">{html.escape(cell)}</th>' if cell else "<td></td>" for cell in header)
    lines = "".join(
        f'<tr><th scope="row">{html.escape(first)}</th>'
        + "".join(f"<td>{html.escape(cell)}</td>" for cell in others)
        + "</tr>"
        for first, *others in rows
    )
    return (
        f'<section class="card wide"><h2>{html.escape(title)}</h2><div class="scroll" tabindex="0"><table>'
        f"<thead><tr>{head}</tr></thead><tbody>{lines}</tbody></table></div></section>"
    )
