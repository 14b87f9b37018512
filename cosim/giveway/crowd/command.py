"""The command `giveway crowd`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from giveway.base.options import RobotOption, ThreadsOption, refuse_stated
from giveway.base.terminal import FAILED, INTERRUPTED, print_columns, print_written, working

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from giveway.crowd.parts import Record
    from giveway.robot.variables import Value
    from giveway.scenario.scenario import Scenario

__all__ = ["crowd_app", "ended_early"]

crowd_app = typer.Typer(name="crowd", help="Judge the reflex on many robots that are not its model.")

OUT, CURVES = Path("out/crowd"), Path("out/curves")
DrawOption = Annotated[
    str, typer.Option("--draw", help="tuning, or judging: another seed, not looked at while a detector is chosen.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="controller.NAME=VALUE", help="Set a parameter of the controller."),
]
SetAnyOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="MODEL.NAME=VALUE", help="Set a parameter of every controller, or of every robot (testbed.*)."
    ),
]
ImuOption = Annotated[bool, typer.Option("--imu", help="Of robots with accelerometer and gyro.")]


@crowd_app.callback(invoke_without_command=True)
def crowd(
    context: typer.Context,
    draw: DrawOption = "tuning",
    robots: Annotated[int, typer.Option("--robots", help="Number of robots; each is hit twelve times.")] = 1000,
    only: Annotated[
        int | None, typer.Option("--only", metavar="N", help="Only hit N: its figures, traces and report.")
    ] = None,
    group: Annotated[
        str | None, typer.Option("--group", help="Only the planar, tipping or single rollers robots among them.")
    ] = None,
    situations: Annotated[
        list[str] | None,
        typer.Option("--situation", help="Only hits at rest, in motion, starting, stopping or reacting; repeat it."),
    ] = None,
    imu: Annotated[
        bool | None,
        typer.Option("--imu/--no-imu", help="Only robots with accelerometer and gyro, or without; else both."),
    ] = None,
    calibrated: Annotated[
        bool, typer.Option("--calibrated", help="Controllers know what `giveway calibrate` finds for their robots.")
    ] = False,
    assignments: SetAnyOption = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Without it: out/crowd/DRAW, or out/crowd/hit-N.")
    ] = None,
    threads: ThreadsOption = None,
    robot: RobotOption = None,
) -> None:
    """Hit every robot of the crowd; a table per plant, with intervals and the worst cases, in DIR."""
    if context.invoked_subcommand is not None:
        refuse_stated(context, f"behind `{context.invoked_subcommand}`")
        return
    from giveway.base.errors import GivewayError, UnknownNameError
    from giveway.crowd.population import DRAWS

    controller, same = _controller_and_robots(assignments)
    if draw not in DRAWS:
        raise UnknownNameError("--draw", draw, DRAWS)
    if calibrated and same:
        raise GivewayError("--calibrated", same, "no testbed.* beside it: its logs are of the robots as drawn")
    if calibrated:
        from giveway.crowd.calibrated import refuse_current

        refuse_current(robot)
    _check_imu(robot, imu)
    base = OUT if robot is None else OUT / robot.stem
    if only is not None:
        refuse_stated(context, "only without --only", ("--robots", "--group", "--situation", "--threads"))
        folder = out or base / (f"hit-{only}-imu" if imu else f"hit-{only}")
        _one(draw, only, controller, calibrated, bool(imu), robot, same, folder)
    else:
        folder = out or base / (f"{draw}-calibrated" if calibrated else draw)
        imus = (False, *([True] if _has_imu(robot) else [])) if imu is None else (imu,)
        _all(draw, robots, group, situations, imus, controller, calibrated, robot, same, folder, threads)


def _has_imu(robot: Path | None) -> bool:
    """Whether the robot file states an accelerometer and gyro, which robots of the crowd may then have."""
    from giveway.robot.robot_file import read_robot

    return robot is None or not read_robot(robot).does_without("imu.height")


def _check_imu(robot: Path | None, imu: bool | None) -> None:
    from giveway.base.errors import GivewayError

    if imu and not _has_imu(robot):
        raise GivewayError("--imu", robot, "robot files with the entries imu.*")


def _controller(assignments: list[str] | None) -> Mapping[str, Value]:
    """The controller's parameters; the robots belong to the draw."""
    from giveway.base.errors import GivewayError
    from giveway.robot.variables import parse_assignments

    overrides = parse_assignments(assignments or [])
    for name, value in overrides["testbed"].items():
        raise GivewayError(f"testbed.{name}", value, "parameters of the controller; the draw decides the robots")
    return overrides["controller"]


def _controller_and_robots(assignments: list[str] | None) -> tuple[Mapping[str, Value], Mapping[str, Value]]:
    """Parameters of the controllers, and those of the testbed that all robots have alike."""
    from giveway.crowd.population import check_same
    from giveway.robot.variables import parse_assignments

    overrides = parse_assignments(assignments or [])
    check_same(overrides["testbed"])
    return overrides["controller"], overrides["testbed"]


def _threads(threads: int | None) -> int:
    from giveway.base.checks import whole
    from giveway.library.batch_library import THREADS_MAX
    from giveway.library.work import default_threads

    return default_threads() if threads is None else whole("--threads", threads, 1, THREADS_MAX)


def _all(
    draw: str,
    robots: int,
    group: str | None,
    situations: Sequence[str] | None,
    imus: Sequence[bool],
    controller: Mapping[str, Value],
    calibrated: bool,
    robot: Path | None,
    same: Mapping[str, Value],
    folder: Path,
    threads: int | None,
) -> None:
    from giveway.base.checks import whole
    from giveway.base.errors import UnknownNameError
    from giveway.crowd.crowd import ROBOTS_MAX
    from giveway.crowd.crowd import crowd as work_of
    from giveway.crowd.parts import go_on
    from giveway.crowd.population import GROUPS
    from giveway.crowd.table import TARGET_HEADER, short_cells, short_header, tables, target_rows, write
    from giveway.study.messages import duration, showing

    whole("--robots", robots, 1, ROBOTS_MAX)
    if group is not None and group not in GROUPS:
        raise UnknownNameError("--group", group, GROUPS)
    threads = _threads(threads)
    records: list[Record] = []
    found, notes = (
        _calibrate(draw, robots, robot, folder.with_name(f"{folder.name}-of-robots"), threads)
        if calibrated
        else (None, [])
    )
    interrupted = False
    for imu in imus:
        work = work_of(draw, robots, controller, found, group, imu, robot, same, situations)
        with showing(work.name) as progress:
            done = go_on(work, folder / "imu" if imu else folder, threads, progress)
        if done.ran:
            typer.echo(
                f"{work.name}: {done.ran} runs in {duration(done.wall_s)}: {done.ran / done.wall_s:.0f} per second"
            )
        records += done.records
        interrupted = done.interrupted
        if interrupted:
            break
    title = f"crowd, {draw} draw{', calibrated' if calibrated else ''}{f', {robot.stem}' if robot else ''}"
    for table, rows in tables(records):
        print_columns(f"{title}: {table}", short_header(), [short_cells(row) for row in rows])
        if targets := target_rows(table, rows):
            print_columns(f"Targets: {table}", TARGET_HEADER, targets)
    simulated_h = sum(record["simulated_s"] for record in records) / 3600.0
    settings = "".join(
        f" --set {model}.{name}={value}"
        for model, values in (("controller", controller), ("testbed", same))
        for name, value in values.items()
    )
    whose = f" --robot {robot}" if robot else ""
    again = f"giveway crowd --draw {draw} --only N{' --calibrated' if calibrated else ''}{whose}{settings}"
    notes = [
        *notes,
        f"{len(records)} runs, {simulated_h:.1f} h simulated. One of them again, with its report: `{again}`, with "
        "`--imu` if its table is of robots with an IMU.",
    ]
    written = write(folder, title, notes, records)
    failed, over = ended_early(records)
    if over:
        typer.echo(f"{over} runs ended when the robot tipped over; they count until then")
    for record in failed[:10]:
        typer.echo(f"hit {record['number']}: {record['status']}: {record['message']}", err=True)
    print_written(*written)
    if interrupted:
        typer.echo("Interrupted; all parts but the one under way are kept. The same command goes on.", err=True)
        raise typer.Exit(INTERRUPTED)
    if failed:
        raise typer.Exit(FAILED)


def ended_early(records: Sequence[Record]) -> tuple[list[Record], int]:
    """The runs that could not be judged, and the number of those that count until the robot tipped over."""
    failed = [record for record in records if not record["judged"]]
    return failed, sum(record["status"] == "failed" for record in records if record["judged"])


def _calibrate(
    draw: str, robots: int, robot: Path | None, folder: Path, threads: int
) -> tuple[dict[int, dict[str, Value]], list[str]]:
    """What the controllers believe after the calibration, and a sentence about it."""
    from giveway.crowd.calibrated import beliefs, calibrations
    from giveway.crowd.parts import go_on
    from giveway.study.messages import showing

    work = calibrations(draw, robots, robot)
    with showing(work.name) as progress:
        done = go_on(work, folder, threads, progress)
    if done.interrupted:
        typer.echo("Interrupted; the calibrations so far are kept. The same command goes on.", err=True)
        raise typer.Exit(INTERRUPTED)
    refused = [record for record in done.records if record["message"]]
    for record in refused[:3]:
        typer.echo(f"robot {record['number']}: not calibrated: {record['message']}", err=True)
    note = f"Each of {robots} robots calibrated by the real identification on logs of its own; {len(refused)} refused."
    return beliefs(done.records), [note]


def _one(
    draw: str,
    number: int,
    controller: Mapping[str, Value],
    calibrated: bool,
    imu: bool,
    robot: Path | None,
    same: Mapping[str, Value],
    folder: Path,
) -> None:
    """One hit: its figures as in the crowd, and the usual report of the event-exact run."""
    from giveway.base.checks import whole
    from giveway.base.files import check_output
    from giveway.crowd.crowd import ROBOTS_MAX, compute
    from giveway.crowd.hits import PER_ROBOT, hit

    whole("--only", number, 0, ROBOTS_MAX * PER_ROBOT - 1)
    check_output(folder)
    if calibrated:
        from giveway.crowd.calibrated import beliefs
        from giveway.crowd.calibrated import compute as calibrate

        whose = number // PER_ROBOT
        controller = {**beliefs(calibrate(draw, [whose], 1, lambda _done: None, robot))[whose], **controller}
    one = hit(draw, number, controller, imu=imu, file=robot, same=same)
    record = compute(draw, controller, [number], 1, lambda _done: None, imu=imu, robot=robot, same=same)[0]
    what = f"Robot {one.robot.number} ({one.robot.table}), {one.situation}, {one.kind}, bumper {one.bumper}."
    _report(one.scenario, what, record, folder)
    rows = [
        (
            f"{contact['start_s']:.4f}",
            contact["verdict"],
            f"{contact['impulse_ns']:.2f}",
            *("-" if contact[name] is None else f"{contact[name]:.1f}" for name in FIGURES),
        )
        for contact in (record["judged"] or {"contacts": []})["contacts"]
    ]
    print_columns("Contacts, as the crowd judges them", ("from, s", "verdict", "impulse, N s", *FIGURES), rows)
    if record["judged"]:
        for name in ("detections_s", "false_s", "towards_s"):
            typer.echo(f"{name}: {', '.join(f'{time:.3f}' for time in record['judged'][name]) or 'none'}")
    if record["lifts"]:
        typer.echo("Wheels: " + ", ".join(f"{name} {value:g}" for name, value in record["lifts"].items()))
    print_written(folder / "report.html")


def _report(scenario: Scenario, what: str, record: Mapping[str, object], folder: Path) -> None:
    """The usual report of the event-exact run in ``folder``, and the record of the crowd's run beside it."""
    import json

    from giveway.base.files import replace_folder, write_text
    from giveway.report import write_report
    from giveway.report.console import print_results
    from giveway.simulation import runner

    with working("simulation and report"):
        result = runner.run(scenario, None, "native")
        with replace_folder(folder) as temporary:
            result.write_into(temporary)
            write_text(temporary / "record.json", json.dumps(record, indent=1) + "\n")
            write_report(temporary / "report.html", scenario.name, what, [result])
    typer.echo(what)
    print_results(scenario.name, {scenario.bumper: result})


FIGURES = ("delay_ms", "direction_deg", "later_direction_deg", "place_mm", "later_place_mm")


@crowd_app.command("endurance")
def endurance(
    context: typer.Context,
    hours: Annotated[
        float | None, typer.Option("--hours", help="Planar; the other plants drive in proportion. Without it: 300.")
    ] = None,
    group: Annotated[str | None, typer.Option("--group", help="Only planar, tipping or single rollers.")] = None,
    draw: DrawOption = "tuning",
    only: Annotated[int | None, typer.Option("--only", metavar="N", help="Only run N of the group.")] = None,
    imu: ImuOption = False,
    assignments: SetOption = None,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for tables and runs.")] = Path(
        "out/endurance"
    ),
    threads: ThreadsOption = None,
    robot: RobotOption = None,
) -> None:
    """Drive for hours without contact: false alarms per hour with their upper bound. Goes on where it stopped."""
    from giveway.base.checks import finite
    from giveway.base.errors import UnknownNameError
    from giveway.crowd.endurance import HOURS

    if group is not None and group not in HOURS:
        raise UnknownNameError("--group", group, HOURS)
    share = 1.0 if hours is None else finite("--hours", hours, 1e-3, 1e5, "h") / HOURS["planar"]
    controller = _controller(assignments)
    _check_imu(robot, imu)
    out = out if robot is None else out / robot.stem
    if only is not None:
        refuse_stated(context, "only without --only", ("--hours", "--threads"))
        _one_drive(draw, group or "planar", only, imu, controller, robot, out)
        return
    groups = [group] if group else list(HOURS)
    _endure(draw, groups, share, imu, controller, robot, out / "imu" if imu else out, threads)


def _endure(
    draw: str,
    groups: list[str],
    share: float,
    imu: bool,
    controller: Mapping[str, Value],
    robot: Path | None,
    out: Path,
    threads: int | None,
) -> None:
    import json

    from giveway.base.files import write_text
    from giveway.crowd.endurance import HOURS, RUN_S, endurance, rates
    from giveway.crowd.parts import go_on
    from giveway.study.messages import duration, showing

    threads = _threads(threads)
    found = {}
    interrupted = False
    for group in groups:
        work = endurance(draw, group, share * HOURS[group], controller, imu, robot)
        with showing(work.name) as progress:
            done = go_on(work, out / group.replace(" ", "-"), threads, progress)
        found[group] = {"asked": dict(work.asked), **rates(done.records)}
        if done.ran:
            speed = done.ran * RUN_S / done.wall_s
            typer.echo(f"{group}: {done.ran} runs in {duration(done.wall_s)}, {speed:.0f} times as fast as time")
        interrupted = done.interrupted
        if interrupted:
            break
    names = ("hours", "runs", "failed", "false alarms", "runs with one", "per hour", "per hour, upper 95 % bound")
    rows = [
        (group, *("-" if one[name] is None else f"{one[name]:g}" for name in names)) for group, one in found.items()
    ]
    print_columns("Motion without contact", ("", *names), rows)
    for group, one in found.items():
        if one["worst"]:
            typer.echo(f"{group}: most alarms in {', '.join(f'{n} ({count})' for n, count in one['worst'])}")
    path = out / "table.json"
    write_text(path, json.dumps({"schema_version": 1, "draw": draw, "groups": found}, indent=1) + "\n")
    print_written(path)
    if interrupted:
        typer.echo("Interrupted; all parts but the one under way are kept. The same command goes on.", err=True)
        raise typer.Exit(INTERRUPTED)
    if any(one["failed"] for one in found.values()):
        raise typer.Exit(FAILED)


def _one_drive(
    draw: str,
    group: str,
    number: int,
    imu: bool,
    controller: Mapping[str, Value],
    robot: Path | None,
    out: Path,
) -> None:
    from giveway.base.checks import whole
    from giveway.base.files import check_output
    from giveway.crowd.endurance import compute, drive

    whole("--only", number, 0, 2**31 - 1)
    folder = out / f"{group.replace(' ', '-')}{'-imu' if imu else ''}-run-{number}"
    check_output(folder)
    _, scenario = drive(draw, group, number, controller, imu, robot)
    record = compute(draw, group, controller, [number], 1, lambda _done: None, imu, robot)[0]
    _report(scenario, f"Free motion of robot {number} ({group}): {record['detections']} false alarms.", record, folder)
    print_written(folder / "report.html")


@crowd_app.command("curves")
def curves(
    draw: DrawOption = "tuning",
    robots: Annotated[int, typer.Option("--robots", help="Number of robots; each is hit nine times.")] = 80,
    hours: Annotated[float, typer.Option("--hours", help="Of free motion, for the false alarms.")] = 2.0,
    group: Annotated[
        str, typer.Option("--group", help="Only the planar, tipping or single rollers robots.")
    ] = "planar",
    assignments: SetOption = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Without it: out/curves, or out/curves/ROBOT.")
    ] = None,
    threads: ThreadsOption = None,
    robot: RobotOption = None,
) -> None:
    """Detectors compared: delay of hits against false alarms per hour. Goes on where it stopped."""
    from giveway.base.checks import finite, whole
    from giveway.base.errors import UnknownNameError
    from giveway.crowd.crowd import ROBOTS_MAX
    from giveway.crowd.population import DRAWS, GROUPS

    controller = _controller(assignments)
    if draw not in DRAWS:
        raise UnknownNameError("--draw", draw, DRAWS)
    if group not in GROUPS:
        raise UnknownNameError("--group", group, GROUPS)
    whole("--robots", robots, 1, ROBOTS_MAX)
    finite("--hours", hours, 1e-3, 1e5, "h")
    folder = out or (CURVES if robot is None else CURVES / robot.stem)
    _curves(draw, group, robots, hours, controller, robot, folder, _threads(threads))


def _curves(
    draw: str,
    group: str,
    robots: int,
    hours: float,
    controller: Mapping[str, Value],
    robot: Path | None,
    out: Path,
    threads: int,
) -> None:
    from giveway.crowd.curves.result import write
    from giveway.crowd.curves.work import hits_work, quiet_work
    from giveway.crowd.parts import go_on
    from giveway.study.messages import duration, showing

    found = []
    for work, name in (
        (quiet_work(draw, group, hours, controller, robot), "free-motion"),
        (hits_work(draw, group, robots, controller, robot), "hits"),
    ):
        with showing(work.name) as progress:
            done = go_on(work, out / name, threads, progress)
        if done.ran:
            typer.echo(f"{work.name}: {done.ran} of {work.count} runs in {duration(done.wall_s)}")
        for record in [record for record in done.records if record["message"]][:3]:
            typer.echo(f"{work.name}: run {record['number']}: {record['message']}", err=True)
        found.append(done)
        if done.interrupted:
            break
    if found[-1].interrupted:
        typer.echo("Interrupted; all parts but the one under way are kept. The same command goes on.", err=True)
        raise typer.Exit(INTERRUPTED)
    quiet, hits = found
    sizes = (
        f"{len(hits.records)} hits, {sum(one['simulated_s'] for one in quiet.records) / 3600.0:.3g} h without contact"
    )
    settings = "".join(f", {name} = {value}" for name, value in controller.items())
    whose = "" if robot is None else f" of {robot.stem}"
    about = f"{group} robots{whose} of draw `{draw}`, {sizes}{settings}"
    tables, paths = write(out, about, hits.records, quiet.records)
    for title, header, rows in tables:
        print_columns(title, header, rows)
    print_written(*paths)
