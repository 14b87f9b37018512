"""The command `giveway studio`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["studio"]


def studio(
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Where to write the page.")] = Path(
        "out/studio.html"
    ),
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open it in the browser.")] = True,
) -> None:
    """Write the studio, one HTML file in which collisions are computed while you drag, and open it."""
    from giveway.base.errors import GivewayError
    from giveway.base.files import check_file, replace_file
    from giveway.studio.filled import studio_page

    if out.suffix != ".html":
        raise GivewayError("--out", out, "a file that ends in .html")
    check_file(out)
    with replace_file(out) as temporary:
        temporary.write_text(studio_page(), encoding="utf-8")
    typer.echo(f"{out}: {out.stat().st_size / 1e3:.0f} kB")
    if browser:
        import webbrowser

        if not webbrowser.open(out.resolve().as_uri()):
            typer.echo("No browser was found: open the file yourself.")
