"""The commands `giveway run`, `demo`, `reproduce` and `list`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from giveway.base.errors import GivewayError, UnknownNameError
from giveway.base.options import FmiOption, RobotOption, refuse_stated
from giveway.base.terminal import FAILED, INTERRUPTED, print_columns, print_written, progress_bars, wants_json
from giveway.robot.presets import DEFAULT, check_preset
from giveway.scenario.scenario import BUMPERS

if TYPE_CHECKING:
    from collections.abc import Callable

    from giveway.scenario.scenario import Scenario
    from giveway.simulation.master import Progress
    from giveway.simulation.result import Result
    from giveway.simulation.runner import Engine

__all__ = ["demo", "list_experiments", "reproduce", "run"]

DEFAULT_BUMPER = "magnetic"
FMU = "fmu"  # of --controller and of --engine

SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="MODEL.NAME=VALUE", help="Set a parameter of an FMU; see `giveway variables`."),
]
EngineOption = Annotated[
    str, typer.Option("--engine", help="fmu, or native: the same bits without FMUs, several times as fast.")
]
PresetOption = Annotated[
    str | None, typer.Option("--preset", help="The controller's reflex: default, or paper for that of the paper.")
]
SeedOption = Annotated[int | None, typer.Option("--seed", help="Seed of the sensor noise.")]


def run(
    context: typer.Context,
    what: Annotated[
        str,
        typer.Argument(
            metavar="EXPERIMENT|FILE", help="Name of an experiment (`giveway list`), or a scenario file (TOML)."
        ),
    ],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for traces, manifest and report.")],
    bumper: Annotated[
        str | None,
        typer.Option("--bumper", help="none, spring, magnetic, foam ...; left out: magnetic, or the scenario's."),
    ] = None,
    assignments: SetOption = None,
    fmi: FmiOption = 3,
    duration: Annotated[float | None, typer.Option("--duration", metavar="S", help="Simulated time in s.")] = None,
    seed: SeedOption = None,
    robot: RobotOption = None,
    engine: EngineOption = "fmu",
    preset: PresetOption = None,
    controller: Annotated[
        str,
        typer.Option(
            "--controller",
            metavar="fmu|host|qemu|DEVICE",
            help="What controls: the FMU, or its firmware here, in qemu, or on a board at a serial line.",
        ),
    ] = FMU,
    log: Annotated[
        Path | None,
        typer.Option("--log", metavar="FILE", help="Also the controller's inputs, as .csv, .parquet or .mcap."),
    ] = None,
) -> None:
    """Run one experiment, or your own scenario, with one bumper; writes traces, metrics, manifest and a report."""
    from giveway.base.files import check_output, replace_folder
    from giveway.replay.run_log import check_log_path, write_log
    from giveway.report.console import print_results
    from giveway.simulation import runner

    chosen = _engine(context, engine)
    scenario, summary = _scenario(what, bumper, robot, preset)
    scenario = _changed(scenario, assignments, fmi, duration, seed)
    check_output(out)
    if log is not None:
        check_log_path(log)
    opened = None
    if controller != FMU:
        if chosen != FMU:
            raise GivewayError("--controller", controller, f"only with --engine {FMU}")
        from giveway.firmware.in_the_loop import controller_of

        opened = controller_of(scenario, controller)
    with progress_bars(("simulation", "report")) as progress:
        result = runner.run(scenario, _share_of(progress, "simulation"), chosen, opened)
        progress("report", 0.0)
        from giveway.report import write_report

        with replace_folder(out) as folder:
            result.write_into(folder)
            write_report(folder / "report.html", scenario.name, summary, [result])
        if log is not None:
            write_log(log, result)
        progress("report", 1.0)
    print_results(scenario.name, {scenario.bumper: result})
    if result.judgement is not None:
        typer.echo(str(result.judgement))
    print_written(out / "report.html", *([] if log is None else [log]))
    if result.interrupted:
        typer.echo(f"Interrupted at t = {result.manifest['simulated_s']:.3f} s; what was computed is kept.", err=True)
        raise typer.Exit(INTERRUPTED)


def demo(
    context: typer.Context,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for report, summary and runs.")] = Path(
        "out/demo"
    ),
    fmi: FmiOption = 3,
    seed: SeedOption = None,
    engine: EngineOption = "fmu",
    preset: PresetOption = None,
    robot: RobotOption = None,
) -> None:
    """Run the paper's experiment 5.2 with all three bumpers; table, report.html, overview.png, summary.json."""
    from giveway import experiments
    from giveway.base.files import check_output, replace_folder
    from giveway.report.console import print_results
    from giveway.simulation import runner
    from giveway.simulation.summary import write_summary

    chosen = _engine(context, engine)
    check_output(out)
    name = "motionless"
    results: dict[str, Result] = {}
    check_preset(preset or DEFAULT, "--preset")
    experiment = experiments.get(name, preset or DEFAULT)
    titles = {bumper: f"bumper {bumper}" for bumper in experiment.bumpers}
    with progress_bars((*titles.values(), "report")) as progress:
        for bumper, title in titles.items():
            scenario = _changed(experiment.scenario(bumper, robot=robot), None, fmi, None, seed)
            results[bumper] = runner.run(scenario, _share_of(progress, title), chosen)
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
    print_written(*(out / name for name in ("report.html", "overview.png", "summary.json")))


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
    for line in found.summary():
        typer.echo(line)
    print_written(out / "report.html", out / "table.json")
    if found.interrupted:
        typer.echo(f"Interrupted; not run: {', '.join(found.interrupted)}. What was found is kept.", err=True)
        raise typer.Exit(INTERRUPTED)
    if found.failed:
        raise typer.Exit(FAILED)


def list_experiments() -> None:
    """List the experiments."""
    from giveway import experiments

    if wants_json():
        found = experiments.all_experiments().values()
        rows = [(one.name, one.summary, ", ".join(one.bumpers), str(one.is_single_run)) for one in found]
        print_columns("Experiments", ("name", "summary", "bumpers", "single run"), rows)
        return
    for experiment in experiments.all_experiments().values():
        bumpers = f" Bumpers: {', '.join(experiment.bumpers)}." if experiment.bumpers else ""
        robots = "" if experiment.is_single_run else " Of Trikey alone, several runs: `giveway reproduce`."
        typer.echo(f"{experiment.name}: {experiment.summary}{bumpers}{robots}")


def _engine(context: typer.Context, name: str) -> Engine:
    from giveway.simulation.runner import ENGINES

    for engine in ENGINES:
        if name == engine:
            if engine != FMU:
                refuse_stated(context, f"only with --engine {FMU}", ("--fmi",))
            return engine
    raise UnknownNameError("--engine", name, ENGINES)


def _scenario(what: str, bumper: str | None, robot: Path | None, preset: str | None) -> tuple[Scenario, str]:
    """The scenario of an experiment or of a file, and a sentence about it."""
    from giveway import experiments

    if preset is not None:
        check_preset(preset, "--preset")
    if what.endswith(".toml") or "/" in what:
        from giveway.scenario.scenario_file import read_scenario

        if bumper is not None and bumper not in BUMPERS:
            raise UnknownNameError("--bumper", bumper, BUMPERS)
        scenario = read_scenario(what, bumper=bumper, robot=robot, preset=preset)
        return scenario, f"A scenario from the file {Path(what).name}."
    names = experiments.all_experiments()
    if what not in names:
        raise UnknownNameError("experiment", what, [*names, "the path of a scenario file (TOML)"])
    chosen = experiments.get(what)
    if bumper is None:
        bumper = DEFAULT_BUMPER if DEFAULT_BUMPER in chosen.bumpers or not chosen.bumpers else chosen.bumpers[0]
    elif chosen.bumpers:
        # An experiment that has the paper's three can also be run with any other.
        allowed = tuple(BUMPERS) if chosen.bumpers == experiments.PAPER_BUMPERS else chosen.bumpers
        if bumper not in allowed:
            raise UnknownNameError("--bumper", bumper, allowed)
    return chosen.scenario(bumper, robot=robot, preset=preset or DEFAULT), chosen.summary


def _changed(
    scenario: Scenario, assignments: list[str] | None, fmi: int, duration: float | None, seed: int | None
) -> Scenario:
    """``scenario`` with the command line's changes, all of it checked before anything runs."""
    import dataclasses

    from giveway.base.toml_sections import renamed
    from giveway.robot.variables import parse_assignments
    from giveway.scenario.plan_limits import check_plan_of
    from giveway.scenario.scenario_file import PLAN_KEYS

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
    with renamed("plan", **PLAN_KEYS):
        check_plan_of(scenario)
    return scenario


def _share_of(progress: Callable[[str, float], None], name: str) -> Progress:
    """Converts a simulation's progress (simulated time and duration, s) to the share of the bar ``name``."""
    return lambda now_s, duration_s: progress(name, now_s / duration_s)
