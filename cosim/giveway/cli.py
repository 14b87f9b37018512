"""The command line: a thin skin over the Python interface. Heavy imports happen inside the commands."""

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
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TextIO

import typer

from giveway import __version__
from giveway.base.errors import GivewayError, SimulationError, UnknownNameError, WriteError, one_line
from giveway.base.failures import DEBUG_VARIABLE, unforeseen
from giveway.base.terminal import INTERRUPTED, print_columns, print_results, progress_bars, working
from giveway.fmu_tools.command import fmu_app
from giveway.scenario.scenario import BUMPERS
from giveway.study.command import study_app, sweep_designs

if TYPE_CHECKING:
    from giveway.drivetrain.frequency_response import Sweep
    from giveway.scenario.scenario import Scenario
    from giveway.simulation.master import Progress
    from giveway.simulation.result import Result

__all__ = ["app", "main"]

FAILED, WRONG_INPUT = 1, 2  # exit codes
DEFAULT_BUMPER = "magnetic"

app = typer.Typer(
    name="giveway",
    help="Collision reflexes for omnidirectional robot bases: run experiments, look at variables, measure speed.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

app.add_typer(study_app)
app.add_typer(fmu_app)

SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="MODEL.NAME=VALUE", help="Set a parameter of an FMU; see `giveway variables`."),
]
FmiOption = Annotated[int, typer.Option("--fmi", help="FMI version of the FMUs: 3 or 2.")]
SeedOption = Annotated[int | None, typer.Option("--seed", help="Seed of the sensor noise.")]
RobotOption = Annotated[Path | None, typer.Option("--robot", metavar="FILE", help="Robot file (TOML).")]


@dataclass
class _Settings:
    """Options that stand before the command."""

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


@app.command()
def run(
    what: Annotated[
        str,
        typer.Argument(
            metavar="EXPERIMENT|FILE", help="Name of an experiment (`giveway list`), or a scenario file (TOML)."
        ),
    ],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for traces, manifest and report.")],
    bumper: Annotated[
        str | None,
        typer.Option("--bumper", help="none, spring or magnetic. Without it: magnetic, or what the scenario has."),
    ] = None,
    assignments: SetOption = None,
    fmi: FmiOption = 3,
    duration: Annotated[float | None, typer.Option("--duration", metavar="S", help="Simulated time in s.")] = None,
    seed: SeedOption = None,
    robot: RobotOption = None,
) -> None:
    """Run one experiment, or your own scenario, with one bumper; writes traces, metrics, manifest and a report."""
    import giveway
    from giveway.base.files import check_output, replace_folder

    scenario, summary = _scenario(what, bumper, robot)
    scenario = _changed(scenario, assignments, fmi, duration, seed)
    check_output(out)
    with progress_bars(("simulation", "report")) as progress:
        result = giveway.run(scenario, _share_of(progress, "simulation"))
        progress("report", 0.0)
        from giveway.report import write_report

        with replace_folder(out) as folder:
            result.write_into(folder)
            write_report(folder / "report.html", scenario.name, summary, [result])
        progress("report", 1.0)
    print_results(scenario.name, {scenario.bumper: result})
    if result.judgement is not None:
        typer.echo(str(result.judgement))
    typer.echo(f"Written: {out / 'report.html'}")
    if result.interrupted:
        typer.echo(f"Interrupted at t = {result.manifest['simulated_s']:.3f} s; what was computed is kept.", err=True)
        raise typer.Exit(INTERRUPTED)


@app.command()
def demo(
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for report, summary and runs.")] = Path(
        "out/demo"
    ),
    fmi: FmiOption = 3,
    seed: SeedOption = None,
) -> None:
    """Run the paper's experiment 5.2 with all three bumpers; table, report.html, overview.png, summary.json."""
    import giveway
    from giveway import experiments
    from giveway.base.files import check_output, replace_folder
    from giveway.simulation.summary import write_summary

    check_output(out)
    name = "motionless"
    results: dict[str, Result] = {}
    experiment = experiments.get(name)
    titles = {bumper: f"bumper {bumper}" for bumper in experiment.bumpers}
    with progress_bars((*titles.values(), "report")) as progress:
        for bumper, title in titles.items():
            scenario = _changed(experiment.scenario(bumper), None, fmi, None, seed)
            results[bumper] = giveway.run(scenario, _share_of(progress, title))
            if results[bumper].interrupted:
                raise KeyboardInterrupt
        progress("report", 0.0)
        from giveway.report import write_picture, write_report

        with replace_folder(out) as folder:
            for bumper, result in results.items():
                (folder / bumper).mkdir()
                result.write_into(folder / bumper)
            write_report(folder / "report.html", name, experiment.summary, list(results.values()))
            write_picture(folder / "overview.png", list(results.values()))
            write_summary(folder / "summary.json", results)
        progress("report", 1.0)
    print_results(name, results)
    typer.echo(f"Written: {out / 'report.html'}, {out / 'overview.png'} and {out / 'summary.json'}")


@app.command()
def reproduce(
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for table.json and report.html.")] = Path(
        "out/reproduce"
    ),
    only: Annotated[list[str] | None, typer.Option("--only", metavar="NAME", help="Only this experiment.")] = None,
    reduced: Annotated[bool, typer.Option("--reduced", help="Fewer and shorter runs, as in the tests.")] = False,
    threads: Annotated[int, typer.Option("--threads", help="Native threads, 1 to 256.")] = 2,
) -> None:
    """Run every experiment of the paper: one table (paper, ours, target), table.json and an HTML report."""
    from giveway.base.files import check_output, replace_folder
    from giveway.experiments.reproduction.reproduce import HEADER, chosen, table_rows, write_table
    from giveway.experiments.reproduction.reproduce import reproduce as run_all

    names = [experiment.name for experiment in chosen(only or ())]
    check_output(out)
    with progress_bars(names) as progress:
        found = run_all(names, not reduced, threads, progress)
    from giveway.experiments.reproduction.page import write_report

    with replace_folder(out) as folder:
        write_table(folder / "table.json", found)
        write_report(folder / "report.html", found)
    print_columns("The paper, reproduced", HEADER, table_rows(found))
    for chapter, row in found.rows():
        if row.met is False:
            typer.echo(f"MISS {chapter.experiment.name}: {row.quantity}: {row.reason or 'reason not yet known'}")
    typer.echo(f"{found.count(True)} targets met, {found.count(False)} missed")
    typer.echo(f"Written: {out / 'report.html'} and {out / 'table.json'}")
    if found.interrupted:
        typer.echo(f"Interrupted; not run: {', '.join(found.interrupted)}. What was found is kept.", err=True)
        raise typer.Exit(INTERRUPTED)
    if found.failed:
        raise typer.Exit(FAILED)


@app.command("list")
def list_experiments() -> None:
    """List the experiments."""
    from giveway import experiments

    for experiment in experiments.all_experiments().values():
        bumpers = f" Bumpers: {', '.join(experiment.bumpers)}." if experiment.bumpers else ""
        typer.echo(f"{experiment.name}: {experiment.summary}{bumpers}")


@app.command()
def variables(
    model: Annotated[str, typer.Argument(help="controller, testbed, drivetrain or bumper.")],
    grep: Annotated[str, typer.Option("--grep", metavar="TEXT", help="Only names or descriptions with TEXT.")] = "",
) -> None:
    """List the variables of an FMU: what can be set, its range and unit, and what comes out."""
    from giveway.base.words import counted
    from giveway.robot.variables import table

    wanted = grep.lower()
    chosen = [v for v in table(model) if wanted in v.name.lower() or wanted in v.description.lower()]
    rows = [(v.name, v.causality, "" if v.start is None else f"{v.start}", v.allowed, v.description) for v in chosen]
    print_columns(
        f"{counted(len(chosen), 'variable')} of {model}", ("name", "kind", "start", "allowed", "meaning"), rows
    )


@app.command()
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
    with working("linear model"):
        analysis = analyse(*found)
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
        typer.echo(f"Written: {' and '.join(str(path) for path in written)}")


@app.command()
def fit(
    out: Annotated[Path, typer.Option("--out", metavar="FILE.toml", help="Robot file to write; may be the one read.")],
    robot: RobotOption = None,
    samples: Annotated[int, typer.Option("--samples", help="Points of the box to start from, 1 to 65536.")] = 1024,
) -> None:
    """Fit the robot's open parameters to the paper's results; writes the robot file and its residuals beside it."""
    import json

    from giveway.base import native
    from giveway.base.files import check_file, replace_files
    from giveway.fitting import record
    from giveway.fitting.quantities import Bench
    from giveway.fitting.search import STAGES, search

    residuals = out.with_suffix(".fit.json")
    for path in (out, residuals):
        check_file(path)
    before = native.robot() if robot is None else robot
    bench = Bench(before)
    try:
        with progress_bars(STAGES) as progress:
            found = search(bench, progress, samples)
    except KeyboardInterrupt:
        raise typer.Abort from None  # Typer itself would end without a word
    text = record.robot_text(before, found, residuals.name)
    command = " ".join(
        ("giveway fit", *([f"--robot {robot}"] if robot else []), f"--out {out}", f"--samples {samples}")
    )
    with replace_files(out, residuals) as (new_robot, new_residuals):
        new_robot.write_text(text, encoding="utf-8")
        new_residuals.write_text(json.dumps(record.record(found, command), indent=2) + "\n", encoding="utf-8")
    print_columns("Targets; residuals in tolerances", record.TARGET_HEADER, record.target_rows(found))
    print_columns("Parameters; deviations in factors", record.PARAMETER_HEADER, record.parameter_rows(found))
    typer.echo(f"Singular values: {', '.join(f'{value:.2f}' for value in found.singular_values)}")
    typer.echo(f"Written: {out} and {residuals}")


@app.command()
def calibrate(
    logs: Annotated[
        list[Path], typer.Argument(metavar="LOG.csv...", help="Logs of free motion: arcs, without contact.")
    ],
    robot: Annotated[Path, typer.Option("--robot", metavar="FILE", help="Robot file (TOML) of the robot of the logs.")],
    out: Annotated[Path, typer.Option("--out", metavar="NEW.toml", help="The new robot file; NEW.png lies beside it.")],
) -> None:
    """Fit the roller friction to logs of wheel angles and torques; write a new robot file and a residual plot."""
    from giveway.identification.command import calibrate_robot, table_rows

    calibration, written = calibrate_robot(logs, robot, out)
    title = f"Roller friction (28) from {', '.join(log.name for log in calibration.logs)}"
    print_columns(title, ("", "value", "95 % interval", "unit"), table_rows(calibration))
    typer.echo(f"Written: {' and '.join(str(path) for path in written)}")


@app.command()
def bench(
    repeats: Annotated[int, typer.Option("--repeats", help="Runs to measure, 1 to 100.")] = 5,
    fmi: FmiOption = 3,
    scale: Annotated[
        bool, typer.Option("--scale", help="Only: does the cost grow with the designs, to a million?")
    ] = False,
) -> None:
    """Measure speed: a co-simulated second over FMPy, runs per second, cost and error of the integration methods."""
    from giveway.base.checks import whole
    from giveway.bench import collisions as bench_batch
    from giveway.bench.co_simulation import measure
    from giveway.bench.solvers import HEADER, measure_solvers

    whole("--repeats", repeats, 1, 100)
    if scale:
        title = "Random collisions of 0.6 s over fixed steps, all threads"
        counts, found_rows = bench_batch.SCALE_COUNTS, []
        try:
            with progress_bars([bench_batch.scale_name(count) for count in counts]) as progress:
                for row in bench_batch.scale(counts, progress):
                    found_rows.append(row)
        except KeyboardInterrupt:
            raise typer.Abort from None
        finally:
            print_columns(title, bench_batch.SCALE_HEADER, found_rows)
        return
    with working("co-simulation over FMPy"):
        rows = [(row.name, f"{row.minimum_ms:.1f}", f"{row.median_ms:.1f}") for row in measure(repeats, fmi)]
    title = f"1 s of co-simulation at 1 ms over FMPy, FMI {fmi}, best and median of {repeats}"
    print_columns(title, ("part", "min (ms)", "median (ms)"), rows)
    title = f"Collisions of {bench_batch.SIMULATED_S:g} s with metrics, best and median of {repeats}"
    with working("collisions per second"):
        measured = bench_batch.measure(repeats)
    print_columns(title, bench_batch.HEADER, measured)
    with working("fixed steps against event-exact"):
        found, lines = bench_batch.accuracy()
    print_columns("Fixed steps against event-exact, random collisions", bench_batch.ACCURACY_HEADER, found)
    typer.echo("\n".join(["Detected on another tick:", *lines] if lines else ["All detected on the same tick."]))
    title = "Integration methods on stiffer designs: 1 s of the testbed FMU alone at relative tolerance 1e-6"
    with working("integration methods"):
        cells = [measurement.cells for measurement in measure_solvers(repeats, fmi)]
    print_columns(title, HEADER, cells)


@app.command()
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
    typer.echo(f"Written: {out}")


app.command("sweep")(sweep_designs)


def _scenario(what: str, bumper: str | None, robot: Path | None) -> tuple[Scenario, str]:
    """The scenario of an experiment or of a file, and a sentence about it."""
    from giveway import experiments

    if what.endswith(".toml") or "/" in what:
        from giveway.scenario.scenario_file import read_scenario

        if bumper is not None and bumper not in BUMPERS:
            raise UnknownNameError("--bumper", bumper, BUMPERS)
        return read_scenario(what, bumper=bumper, robot=robot), f"A scenario from the file {Path(what).name}."
    chosen = experiments.get(what)
    if bumper is None:
        bumper = DEFAULT_BUMPER if DEFAULT_BUMPER in chosen.bumpers or not chosen.bumpers else chosen.bumpers[0]
    elif chosen.bumpers and bumper not in chosen.bumpers:
        raise UnknownNameError("--bumper", bumper, chosen.bumpers)
    return chosen.scenario(bumper, robot=robot), chosen.summary


def _changed(
    scenario: Scenario, assignments: list[str] | None, fmi: int, duration: float | None, seed: int | None
) -> Scenario:
    """``scenario`` with the command line's changes, all of it checked before anything runs."""
    import dataclasses

    from giveway.robot.variables import parse_assignments

    overrides = parse_assignments(assignments or [])
    scenario = dataclasses.replace(
        scenario,
        duration_s=scenario.duration_s if duration is None else duration,
        testbed={**scenario.testbed, **overrides["testbed"]},
        controller={**scenario.controller, **overrides["controller"]},
        fmi_version=fmi,
        seed=scenario.seed if seed is None else seed,
    )
    for model in overrides:
        scenario.parameters(model)
    return scenario


def _share_of(progress: Callable[[str, float], None], name: str) -> Progress:
    """What a simulation reports (simulated time and duration, s) as the share of the bar ``name``."""
    return lambda now_s, duration_s: progress(name, now_s / duration_s)


def main() -> None:
    """Entry point. Wrong input is one line on stderr and exit code 2; a run that fails on its way exits with 1."""
    sys.exit(_main(sys.argv[1:]))


def _main(arguments: list[str]) -> int:
    settings = _Settings()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a path may hold what the terminal cannot show
            stream.reconfigure(errors="backslashreplace")
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _show_warning
            code = app(args=arguments, standalone_mode=False, obj=settings)
        sys.stdout.flush()
    except GivewayError as error:
        on_its_way = isinstance(error, WriteError) or (isinstance(error, SimulationError) and error.time_s > 0.0)
        return _fail(str(error), FAILED if on_its_way else WRONG_INPUT)
    except (KeyboardInterrupt, typer.Abort):
        typer.echo("giveway: interrupted; nothing was written", err=True)
        return INTERRUPTED
    except BrokenPipeError:  # whoever read the output has read enough
        _leave_stdout()
        return FAILED
    except Exception as error:
        # Typer's usage errors (missing argument, unknown option or command) know how to say themselves.
        if hasattr(error, "format_message"):
            message = one_line(error.format_message())
            return _fail(message, WRONG_INPUT) if message else WRONG_INPUT  # none: the help was shown instead
        if settings.debug:
            traceback.print_exception(error)
        return _fail(unforeseen(error, arguments), FAILED)
    return code if isinstance(code, int) else 0


def _leave_stdout() -> None:
    """Nothing more goes to a standard output that does not take it, at the end of the process neither."""
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
    """A warning as one line on stderr; what a user can do nothing about goes to the log."""
    if issubclass(category, FutureWarning):
        typer.echo(f"giveway: {one_line(str(message))}", err=True)
    else:
        logging.getLogger("giveway").debug("%s:%d: %s: %s", filename, lineno, category.__name__, message)


def _fail(message: str, code: int) -> int:
    typer.echo(f"giveway: {message}", err=True)
    return code


if __name__ == "__main__":
    main()
