"""Self-contained HTML pages: what web/ bundles, filled with data.

A page needs no network and no server. It runs no script but its own: the policy in its head names that script's hash,
and allows WebAssembly, but no ``eval``.
"""

from __future__ import annotations

import base64
import functools
import gzip
import hashlib
import html
import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base import native

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["packed", "page"]

_KINDS = {"f": "f8", "i": "i4", "u": "u1", "b": "u1"}
_ESCAPES = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}


def page(name: str, title: str, data: Mapping[str, Any], *, body: str = "", engine: bool = False) -> str:
    """The whole text of an HTML page.

    Args:
        name: of the bundle, ``page_NAME.js`` and ``page_NAME.css``.
        title: plain text.
        data: what the script reads: numbers (finite), texts, lists, mappings; arrays by `packed`.
        body: HTML of ours that stands in ``<main>``, without scripts.
        engine: with the batch library, so that the page can compute runs.
    """
    script = native.file(f"page_{name}.js").read_text(encoding="utf-8").replace("</script", "<\\/script")
    style = native.file(f"page_{name}.css").read_text(encoding="utf-8")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = (
        f"default-src 'none'; script-src 'sha256-{digest}' 'wasm-unsafe-eval'; worker-src blob:; "
        "style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'"
    )
    parts = [
        "<!doctype html>",
        '<html lang="en">',
        "<head>",
        '<meta charset="utf-8">',
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{html.escape(title)}</title>",
        f"<style>{style}</style>",
        "</head>",
        "<body>",
        f'<main id="page">{body}</main>',
        f'<script type="application/json" id="data">{_json(data)}</script>',
    ]
    if engine:
        parts.append(f'<script type="application/octet-stream" id="engine">{_library()}</script>')
    return "\n".join([*parts, f"<script>{script}</script>", "</body>", "</html>", ""])


def packed(values: NDArray[Any], *, single: bool = False) -> str:
    """An array as the text that the pages' ``unpacked`` reads; ``single``: with 32 bits instead of 64."""
    kind = "f4" if single and values.dtype.kind == "f" else _KINDS[values.dtype.kind]
    converted = np.ascontiguousarray(values, dtype=f"<{kind}")
    return f"{kind}:{base64.b64encode(converted.tobytes()).decode()}"


def _json(data: Mapping[str, Any]) -> str:
    """It stands in HTML: nothing in it may end the script, or begin a comment."""
    text = json.dumps(data, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
    for letter, instead in _ESCAPES.items():
        text = text.replace(letter, instead)
    return text


@functools.cache
def _library() -> str:
    """giveway_batch.wasm, compressed, as text."""
    return base64.b64encode(gzip.compress(native.file("giveway_batch.wasm").read_bytes(), 9, mtime=0)).decode()
