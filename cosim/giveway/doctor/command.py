"""The command `giveway doctor`."""

from __future__ import annotations

import dataclasses

import typer

from giveway.base.terminal import FAILED, print_columns, print_document, wants_json

__all__ = ["doctor"]

SCHEMA_VERSION = 1  # of `giveway doctor --json`


def doctor() -> None:
    """Say what is installed here, and whether a run has the bits it should have; exit code 1 if something is wrong."""
    from giveway.doctor.findings import WRONG, examine

    found = list(examine())
    if wants_json():
        findings = [dataclasses.asdict(one) for one in found]
        print_document({"schema_version": SCHEMA_VERSION, "findings": findings})
    else:
        rows = [(one.about, one.state, one.found, one.advice) for one in found]
        print_columns("giveway on this machine", ("", "state", "found", "what to do"), rows)
    if any(one.state == WRONG for one in found):
        raise typer.Exit(FAILED)
