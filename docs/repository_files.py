"""{file}`examples/trolley.toml`: a link to a file of the repository, which becomes a part of the site."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

__all__ = ["setup"]

ROOT = Path(__file__).parents[1]


def setup(app: Any) -> dict[str, bool]:
    """Sphinx calls it."""
    app.add_role("file", _file, override=True)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _file(
    name: str, rawtext: str, text: str, lineno: int, inliner: Any, options: Any = None, content: Any = None
) -> tuple[list[Any], list[Any]]:
    from docutils import nodes
    from sphinx.addnodes import download_reference

    path = ROOT / text
    if not path.is_file():
        return [], [inliner.reporter.error(f"the repository has no file {text}", line=lineno)]
    env = inliner.document.settings.env
    target = os.path.relpath(path, Path(env.doc2path(env.docname)).parent)
    return [download_reference("", "", nodes.literal(text, text), reftarget=target, refdoc=env.docname)], []
