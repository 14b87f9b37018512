"""What shows itself in Jupyter."""

from __future__ import annotations

import importlib

__all__ = ["ShownInNotebooks"]


class ShownInNotebooks:
    """Gives a class the HTML that notebooks show instead of its ``repr``."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        # By its name: the room stands above all those whose results it shows.
        page = importlib.import_module("giveway.notebook.page")
        return str(page.html_of(self))
