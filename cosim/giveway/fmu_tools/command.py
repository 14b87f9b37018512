"""The commands `giveway fmu check`, `info` and `run`, for any FMU, and `giveway ssp`, for ours."""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from typing import Annotated

import typer

from giveway.base.errors import GivewayError
from giveway.base.options import RobotOption
from giveway.base.terminal import FAILED, print_columns, print_document, print_written, progress_bar, wants_json
from giveway.fmu_tools.limits import Limits

__all__ = ["fmu_app", "ssp"]

LONGEST_TABLE = 2000  # rows
SCHEMA_VERSION = 1  # of `fmu check --json`

fmu_app = typer.Typer(
    name="fmu",
    help="Check, describe and run an FMU: anybody's, FMI 2 or 3.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
FileArgument = Annotated[Path, typer.Argument(metavar="FILE.fmu", help="The FMU.")]
UnpackedOption = Annotated[
    float, typer.Option("--max-unpacked", metavar="MB", help="Refuse an FMU that unpacks to more.")
]
EntriesOption = Annotated[
    int, typer.Option("--max-entries", metavar="N", help="Refuse an FMU of more files and folders.")
]
XmlOption = Annotated[float, typer.Option("--max-xml", metavar="MB", help="Refuse more XML of FMI's own, unpacked.")]
ElementsOption = Annotated[int, typer.Option("--max-elements", metavar="N", help="Refuse more elements in that XML.")]
DEFAULT = Limits()


@fmu_app.command()
def check(
    file: Annotated[list[Path], typer.Argument(metavar="FILE.fmu...", help="The FMUs.")],
    strict: Annotated[bool, typer.Option("--strict", help="Warnings and notes count as faults.")] = False,
    unpacked: UnpackedOption = DEFAULT.unpacked_mb,
    entries: EntriesOption = DEFAULT.entries,
    xml: XmlOption = DEFAULT.xml_mb,
    elements: ElementsOption = DEFAULT.xml_elements,
) -> None:
    """Look for what importers trip over; exits with 1 if there is a fault, and names each.

    A fault: an importer may refuse the file, or read something else than was meant. A warning: legal, but there are
    importers or machines that cannot take it. A note: legal and usual, and worth a look.
    """
    from giveway.fmu_tools.check import CHECKS, Severity, check_fmu

    limits = Limits(unpacked, entries, xml, elements)
    failed = False
    documents = []
    for path in file:
        found = check_fmu(path, limits)
        counts = {s: sum(finding.severity is s for finding in found) for s in Severity}
        if wants_json():
            findings = [{"check": f.check, "severity": f.severity.value, "text": f.text} for f in found]
            totals = {f"{severity.value}s": count for severity, count in counts.items()}
            documents.append({"file": str(path), **totals, "findings": findings})
        else:
            for finding in found:
                typer.echo(f"{path.name}: {finding}")
            totals_text = ", ".join(f"{count} {severity.value}s" for severity, count in counts.items())
            typer.echo(f"{path.name}: {len(CHECKS)} checks, {totals_text}")
        failed = failed or counts[Severity.FAULT] > 0 or (strict and bool(found))
    if wants_json():
        print_document({"schema_version": SCHEMA_VERSION, "files": documents})
    if failed:
        raise typer.Exit(FAILED)


@fmu_app.command()
def info(
    file: FileArgument,
    variables: Annotated[bool, typer.Option("--variables", help="List the variables, too.")] = False,
    grep: Annotated[str, typer.Option("--grep", metavar="TEXT", help="Only variables with TEXT in them.")] = "",
    unpacked: UnpackedOption = DEFAULT.unpacked_mb,
    entries: EntriesOption = DEFAULT.entries,
    xml: XmlOption = DEFAULT.xml_mb,
    elements: ElementsOption = DEFAULT.xml_elements,
) -> None:
    """Say what an FMU is: interfaces, platforms, variables."""
    from giveway.fmu_tools.info import VARIABLE_HEADER, describe, variable_rows

    limits = Limits(unpacked, entries, xml, elements)
    facts, description = describe(file, limits)
    print_columns(file.name, ("", ""), facts)
    if variables or grep:
        found = variable_rows(description, grep)
        first = list(islice(found, LONGEST_TABLE + 1))
        if wants_json():
            print_columns(f"Variables of {file.name}", VARIABLE_HEADER, [*first, *found])
        elif len(first) <= LONGEST_TABLE:
            print_columns(f"{len(first)} variables", VARIABLE_HEADER, first)
        else:  # the layout of a whole table takes much time and memory
            for row in (VARIABLE_HEADER, *first):
                typer.echo("  ".join(row))
            for row in found:
                typer.echo("  ".join(row))


@fmu_app.command()
def run(
    file: FileArgument,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="FILE.csv or FILE.html; without it: out/NAME.html.")
    ] = None,
    stop: Annotated[float | None, typer.Option("--stop", metavar="S", help="Simulated time at the end in s.")] = None,
    step: Annotated[float | None, typer.Option("--step", metavar="S", help="Communication step in s.")] = None,
    assignments: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="Set an input or a parameter.")
    ] = None,
    inputs: Annotated[
        Path | None,
        typer.Option("--input", metavar="FILE.csv", help="Inputs over time: a column time \\[s], then one per input."),
    ] = None,
    plot: Annotated[
        list[str] | None,
        typer.Option("--plot", metavar="NAME", help="Draw this instead of all outputs; * and ? stand for any text."),
    ] = None,
    interface: Annotated[
        str | None, typer.Option("--interface", help="cs or me; without it: cs if there is one.")
    ] = None,
    time_limit: Annotated[
        float | None, typer.Option("--time-limit", metavar="S", help="End the run after this time of the wall, in s.")
    ] = None,
    max_steps: Annotated[int, typer.Option("--max-steps", metavar="N", help="Refuse a run of more steps.")] = 2_000_000,
    unpacked: UnpackedOption = DEFAULT.unpacked_mb,
    entries: EntriesOption = DEFAULT.entries,
    xml: XmlOption = DEFAULT.xml_mb,
    elements: ElementsOption = DEFAULT.xml_elements,
) -> None:
    """Run an FMU from its start values over FMPy, in a process of its own; traces and plots.

    A file that is unsafe to unpack or that cannot be read is refused.
    """
    from giveway.fmu_tools.page import write_run
    from giveway.fmu_tools.run import FmuStoppedError, check_run_output, run_fmu

    out = Path("out") / f"{file.stem}.html" if out is None else out
    check_run_output(out)
    try:
        with progress_bar("simulating") as progress:
            found = run_fmu(
                file, interface, stop, step, assignments, progress, inputs=inputs, plot=plot or (),
                limits=Limits(unpacked, entries, xml, elements), time_limit_s=time_limit, most_steps=max_steps,
            )  # fmt: skip
    except FmuStoppedError as error:
        raise _failed(error) from None
    write_run(out, found)
    if found.note:
        typer.echo(f"Note: {found.note}")
    typer.echo(
        f"{found.interface}: {len(found.traces)} rows of {len(found.units)} variables to {found.traces['time'][-1]:g} s"
    )
    print_written(out)
    if found.stopped:
        raise _failed(found.stopped)


def _failed(message: GivewayError | str) -> typer.Exit:
    typer.echo(f"giveway: {message}", err=True)
    return typer.Exit(FAILED)


def ssp(
    out: Annotated[Path, typer.Option("--out", metavar="FILE.ssp", help="File to write.")],
    robot: RobotOption = None,
    sequential: Annotated[
        bool, typer.Option("--sequential", help="For a tool that exchanges in our order: keeps the command delay.")
    ] = False,
) -> None:
    """Write controller and testbed as a System Structure Package (SSP 1.0), with a parameter set for each bumper."""
    from giveway.fmu_tools.ssp import write_ssp
    from giveway.robot.robot_file import read_robot

    write_ssp(out, None if robot is None else read_robot(robot), sequential=sequential)
    print_written(out)
