"""The command line: every room's commands, what stands before them, and how all of them end.

A room's `command.py` is imported at every start: heavy imports happen inside its functions.
"""

from __future__ import annotations

import contextlib
import io
import logging
import os
import sys
import traceback
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, TextIO

import typer

from giveway import __version__
from giveway.base.errors import ClusterError, GivewayError, SimulationError, WriteError, one_line
from giveway.base.failures import DEBUG_VARIABLE, unforeseen
from giveway.base.output_options import with_output_options
from giveway.base.terminal import (
    DONE,
    EXIT_CODES,
    FAILED,
    INTERRUPTED,
    WRONG_INPUT,
    begin_output,
    end_output,
    is_quiet,
)
from giveway.bench.command import bench
from giveway.crowd.command import crowd_app
from giveway.detectability.command import detectability
from giveway.doctor.command import doctor
from giveway.drivetrain.command import drivetrain
from giveway.experiments.command import demo, list_experiments, reproduce, run
from giveway.firmware.command import firmware
from giveway.fitting.command import fit
from giveway.fmu_tools.command import fmu_app, ssp
from giveway.identification.command import calibrate
from giveway.own_robot.command import robot_app
from giveway.replay.command import replay
from giveway.robot.command import variables
from giveway.schemas.command import schema
from giveway.starters.command import new_app
from giveway.studio.command import studio
from giveway.study.command import optimise_designs, study_app, sweep_designs
from giveway.tuning.command import tune

__all__ = ["app", "main"]

app = typer.Typer(
    name="giveway",
    help="Collision reflexes for omnidirectional robot bases: run experiments, look at variables, measure speed.",
    epilog="Exit codes. " + ". ".join(f"{code}: {meaning}" for code, meaning in EXIT_CODES.items()) + ".",
    no_args_is_help=True,
    add_completion=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

COMMANDS: dict[str, Callable[..., None]] = {
    **{"run": run, "demo": demo, "reproduce": reproduce, "list": list_experiments, "variables": variables},
    **{"drivetrain": drivetrain, "fit": fit, "calibrate": calibrate, "bench": bench, "ssp": ssp},
    "studio": studio,
    "replay": replay,
    "detectability": detectability,
    "sweep": sweep_designs,
    "optimise": optimise_designs,
    "doctor": doctor,
    "firmware": firmware,
    "schema": schema,
    "tune": tune,
}
for name, command in COMMANDS.items():
    app.command(name)(command)
app.add_typer(study_app)
app.add_typer(crowd_app)
app.add_typer(fmu_app)
app.add_typer(new_app)
app.add_typer(robot_app)


@dataclass
class _Settings:
    """Options before the command."""

    debug: bool = False


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"giveway {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version.")
    ] = False,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Log what happens to stderr.")] = False,
    debug: Annotated[
        bool, typer.Option("--debug", envvar=DEBUG_VARIABLE, help="Show the traceback of what nobody foresaw.")
    ] = False,
) -> None:
    context.obj.debug = debug
    if verbose:
        logging.basicConfig(stream=sys.stderr, level=logging.DEBUG, format="%(name)s: %(message)s")


with_output_options(app)


def main() -> None:
    """Entry point. Wrong input gives one line on stderr and exit code 2; a run that fails exits with 1."""
    sys.exit(_main(sys.argv[1:]))


def _main(arguments: list[str]) -> int:
    settings = _Settings()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a path may contain characters that the terminal cannot show
            stream.reconfigure(errors="backslashreplace")
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _show_warning
            code = _answered(arguments, settings)
        sys.stdout.flush()
    except GivewayError as error:
        simulated = isinstance(error, SimulationError) and error.time_s > 0.0
        on_its_way = simulated or isinstance(error, ClusterError | WriteError)
        return _fail(str(error), FAILED if on_its_way else WRONG_INPUT)
    except (KeyboardInterrupt, typer.Abort):
        typer.echo("giveway: interrupted; nothing was written", err=True)
        return INTERRUPTED
    except BrokenPipeError:  # the reader of the output has closed the pipe
        _leave_stdout()
        return FAILED
    except Exception as error:
        # Typer's usage errors (missing argument, unknown option or command) print themselves.
        if hasattr(error, "format_message"):
            message = one_line(error.format_message())
            return _fail(message, WRONG_INPUT) if message else WRONG_INPUT  # none: the help was shown instead
        if settings.debug:
            traceback.print_exception(error)
        return _fail(unforeseen(error, arguments), FAILED)
    return code


def _answered(arguments: list[str], settings: _Settings) -> int:
    """Exit code of a command; errors come as exceptions, and then there is no JSON document."""
    begin_output()
    ended = False
    try:
        code = app(args=arguments, standalone_mode=False, obj=settings)
        ended = True
    except typer.Abort as abort:
        if isinstance(abort.__cause__, EOFError):  # Typer takes a file cut short for a question left unanswered
            raise abort.__cause__ from None
        raise
    finally:
        end_output(ended)
    return code if isinstance(code, int) else DONE


def _leave_stdout() -> None:
    """Stop writing to a standard output that fails, also at the end of the process."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """A warning as one line on stderr; warnings that users cannot act on go to the log."""
    if issubclass(category, FutureWarning):
        if not is_quiet():
            typer.echo(f"giveway: {one_line(str(message))}", err=True)
    else:
        logging.getLogger("giveway").debug("%s:%d: %s: %s", filename, lineno, category.__name__, message)


def _fail(message: str, code: int) -> int:
    typer.echo(f"giveway: {message}", err=True)
    return code


if __name__ == "__main__":
    main()
