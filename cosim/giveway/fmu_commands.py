"""The commands `giveway fmu check`, `info` and `run`: for any FMU, not only ours."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from giveway.terminal import print_columns, progress_bar

__all__ = ["fmu_app"]

FOUND = 1  # exit code of a check that found a fault

fmu_app = typer.Typer(
    name="fmu",
    help="Check, describe and run an FMU: anybody's, FMI 2 or 3.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
FileArgument = Annotated[Path, typer.Argument(metavar="FILE.fmu", help="The FMU.")]


@fmu_app.command()
def check(
    file: Annotated[list[Path], typer.Argument(metavar="FILE.fmu...", help="The FMUs.")],
    strict: Annotated[bool, typer.Option("--strict", help="Notes count as faults.")] = False,
) -> None:
    """Look for what importers trip over; exits with 1 if there is a fault, and names each."""
    from giveway.fmu_check import CHECKS, check_fmu

    failed = False
    for path in file:
        found = check_fmu(path)
        faults = sum(finding.fault for finding in found)
        for finding in found:
            typer.echo(f"{path.name}: {finding}")
        typer.echo(f"{path.name}: {len(CHECKS)} checks, {faults} faults, {len(found) - faults} notes")
        failed = failed or faults > 0 or (strict and bool(found))
    if failed:
        raise typer.Exit(FOUND)


@fmu_app.command()
def info(
    file: FileArgument,
    variables: Annotated[bool, typer.Option("--variables", help="List the variables, too.")] = False,
    grep: Annotated[str, typer.Option("--grep", metavar="TEXT", help="Only variables with TEXT in them.")] = "",
) -> None:
    """Say what an FMU is: interfaces, platforms, variables."""
    from giveway.fmu_info import VARIABLE_HEADER, describe, variable_rows

    print_columns(file.name, ("", ""), describe(file))
    if variables or grep:
        rows = variable_rows(file, grep)
        print_columns(f"{len(rows)} variables", VARIABLE_HEADER, rows)


@fmu_app.command()
def run(
    file: FileArgument,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="FILE.csv or FILE.html; without it: out/NAME.html.")
    ] = None,
    stop: Annotated[float | None, typer.Option("--stop", metavar="S", help="Simulated time in s.")] = None,
    step: Annotated[float | None, typer.Option("--step", metavar="S", help="Communication step in s.")] = None,
    assignments: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="Set an input or a parameter.")
    ] = None,
    interface: Annotated[
        str | None, typer.Option("--interface", help="cs or me; without it: cs if there is one.")
    ] = None,
) -> None:
    """Run an FMU from its start values over FMPy; traces and plots."""
    from giveway.fmu_run import check_run_output, run_fmu, write_run

    out = Path("out") / f"{file.stem}.html" if out is None else out
    check_run_output(out)
    with progress_bar("simulating") as progress:
        found = run_fmu(file, interface, stop, step, assignments, progress)
    write_run(out, found)
    typer.echo(
        f"{found.interface}: {len(found.traces)} rows of {len(found.units)} variables to {found.traces['time'][-1]:g} s"
    )
    typer.echo(f"Written: {out}")
