"""The results as a file, and as the table in docs/site/reference/importers.md."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from docs.markdown import replaced

__all__ = ["BEGIN", "END", "HEADER", "markdown", "put_into", "read_results", "rows_of", "write_results"]

SCHEMA_VERSION = 1
BEGIN, END = "<!-- table: make importers -->", "<!-- end of table -->"
HEADER = ("importer", "FMI 2 CS", "FMI 2 ME", "FMI 3 CS", "FMI 3 ME")

Results = Mapping[str, Mapping[str, Mapping[str, Any]]]
"""Per importer and column: text, reached, deviation, reason, met."""


def rows_of(results: Results) -> list[tuple[str, ...]]:
    """The table's rows, under `HEADER`."""
    return [(name, *(str(cells[column]["text"]) for column in HEADER[1:])) for name, cells in results.items()]


def markdown(results: Results) -> str:
    """The table with its two marks."""
    lines = [BEGIN, *(f"| {' | '.join(row)} |" for row in (HEADER, ("---",) * len(HEADER), *rows_of(results))), END]
    return "\n".join(lines)


def put_into(page: str, results: Results) -> str:
    """``page`` with the table in place of the one between the marks."""
    return replaced(page, BEGIN, END, markdown(results))


def write_results(path: Path, results: Results) -> None:
    document = {"schema_version": SCHEMA_VERSION, "made_by": "make importers", "results": results}
    path.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


def read_results(path: Path) -> Results:
    document = json.loads(path.read_text(encoding="utf-8"))
    if document["schema_version"] != SCHEMA_VERSION:
        raise SystemExit(f"importers: {path} has schema version {document['schema_version']}, not {SCHEMA_VERSION}")
    results: Results = document["results"]
    return results
