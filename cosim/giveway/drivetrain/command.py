"""The command `giveway drivetrain`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from giveway.base.options import RobotOption
from giveway.base.terminal import print_columns, print_written, progress_bars, working

if TYPE_CHECKING:
    from giveway.drivetrain.frequency_response import Sweep

__all__ = ["drivetrain"]


def drivetrain(
    plot: Annotated[bool, typer.Option("--plot", help="Draw Bode diagrams, margins, steps and poles.")] = False,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="PATH", help="Folder, or FILE.png, .svg or .json. With --plot: out/drivetrain."),
    ] = None,
    robot: RobotOption = None,
    load: Annotated[str, typer.Option("--load", help="base, wheel, locked, or an inertia in kg m2.")] = "base",
    delay: Annotated[int, typer.Option("--servo-delay", metavar="TICKS", help="Servo ticks of 0.5 ms, 0 to 64.")] = 0,
    sweep: Annotated[bool, typer.Option("--sweep", help="Measure the FMU's response with sines, too.")] = False,
) -> None:
    """Linearise the drivetrain: poles, bandwidth of the sensed torque, margins of the 2 kHz servo."""
    from giveway.drivetrain import model
    from giveway.drivetrain.analysis import analyse, table_rows

    if out is None and plot:
        out = Path("out/drivetrain")
    found = model.read(robot, load, delay)
    if out is not None:
        from giveway.drivetrain.pictures import check_results, write_results

        check_results(out)
    if sweep:
        from giveway.drivetrain.frequency_response import check_load

        check_load(found[0])
    current = model.senses_current(robot)
    with working("linear model"):
        analysis = analyse(*found, current)
    sweeps: list[Sweep] = []
    if sweep:
        from giveway.drivetrain.frequency_response import deviations, measurable, measure_all

        friction = model.gear_friction(robot)
        with progress_bars([f"{case}, {source}" for case, source in measurable(analysis, friction)]) as progress:
            sweeps = measure_all(
                analysis, friction, progress=lambda case, source, share: progress(f"{case}, {source}", share)
            )
    title = model.describe(robot, load, *found)
    print_columns(title, ("", *analysis.cases), table_rows(analysis))
    if sweep:
        header = ("", "points", "largest in gain", "in phase")
        print_columns("Deviation of the FMU from the linear model", header, deviations(analysis, sweeps))
    if out is not None:
        with working("picture"):
            written = write_results(out, title, analysis, sweeps)
        print_written(*written)
