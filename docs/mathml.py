"""Formulas as MathML, which browsers draw themselves: no script and no fonts, so it works from a file."""

from __future__ import annotations

from typing import Any

__all__ = ["setup"]


def setup(app: Any) -> dict[str, bool]:
    """Sphinx calls it: the renderer is chosen by `html_math_renderer`."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _inline(page: Any, node: Any) -> None:
    _put(page, node, "inline")


def _block(page: Any, node: Any) -> None:
    page.body.append(page.starttag(node, "div", CLASS="math-block"))
    for part in node.astext().split("\n\n"):
        page.body.append("<p>")
        page.body.append(_markup(part, "block"))
        page.body.append("</p>\n")
    page.body.append("</div>\n")
    _skip()


def _put(page: Any, node: Any, display: str) -> None:
    page.body.append(_markup(node.astext(), display))
    _skip()


def _markup(text: str, display: str) -> str:
    from latex2mathml.converter import convert

    return str(convert(text.strip(), display=display))


def _skip() -> None:
    from docutils import nodes

    raise nodes.SkipNode
