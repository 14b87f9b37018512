"""What `make verify` found about c_core: claims of the rungs, and the figures in c_core/VERIFIED.json."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path

from docs.markdown import escaped, paragraphs, table

__all__ = ["pages"]

HEAD = """# What was checked of the C library

`make verify` climbs a ladder of rungs: each checks one claim about `c_core` with an independent tool, and shows on a
planted fault that it can fail. The table below is `c_core/VERIFIED.json`, which is committed with the sources that it
is about; {doc}`../explanation/proved` says what the claims mean and what nobody has proved.

"""


def pages(root: Path) -> dict[str, str]:
    """One page, from the files below ``root``."""
    passed = json.loads((root / "c_core" / "VERIFIED.json").read_text(encoding="utf-8"))["rungs"]
    rows = []
    for path in sorted((root / "verify" / "rungs").glob("r[0-9]*.py")):
        claim = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
        name = re.sub(r"^r\d+_", "", path.stem)
        found = escaped(passed[name]["figure"]) if name in passed else "not told for these sources"
        rows.append((f"`{name}`", paragraphs(claim), found))
    return {"reference/verified.md": HEAD + table(("rung", "claim", "found"), rows)}
