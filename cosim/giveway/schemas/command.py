"""The command `giveway schema`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from giveway.base.terminal import print_document, print_written

__all__ = ["schema"]


def schema(
    kind: Annotated[
        str | None,
        typer.Argument(
            metavar="[KIND]", help="scenario, study, robot, variables or summary; left out: all of them, with --out."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Write KIND.schema.json there, instead of to stdout.")
    ] = None,
) -> None:
    """JSON Schema of the files: editors complete and underline by it (the line `#:schema KIND.schema.json`)."""
    import json

    from giveway.base.errors import GivewayError
    from giveway.base.files import check_file, write_text
    from giveway.schemas.documents import KINDS, document, file_name

    if kind is None and out is None:
        raise GivewayError("KIND", "nothing", f"{', '.join(KINDS)}; or --out, for all of them")
    found = {one: document(one) for one in ([kind] if kind is not None else KINDS)}
    if out is None:
        print_document(next(iter(found.values())))
        return
    paths = {one: out / file_name(one) for one in found}
    for path in paths.values():
        check_file(path)
    out.mkdir(parents=True, exist_ok=True)
    for one, path in paths.items():
        write_text(path, json.dumps(found[one], indent=1) + "\n")
    print_written(*paths.values())
