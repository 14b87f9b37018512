"""The command `giveway crowd`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from giveway.base.terminal import FAILED, INTERRUPTED, print_columns, working

if TYPE_CHECKING:
    from collections.abc import Mapping

    from giveway.robot.variables import Value

__all__ = ["crowd_app"]

crowd_app = typer.Typer(name="crowd", help="Judge the reflex on many robots that are not its model.")

OUT = Path("out/crowd")
DrawOption = Annotated[
    str, typer.Option("--draw", help="tuning, or judging: another seed, not looked at while a detector is chosen.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="controller.NAME=VALUE", help="Set a parameter of the controller."),
]
ThreadsOption = Annotated[int | None, typer.Option("--threads", help="Native threads; without it: all processors.")]


@crowd_app.callback(invoke_without_command=True)
def crowd(
    context: typer.Context,
    draw: DrawOption = "tuning",
    robots: Annotated[int, typer.Option("--robots", help="Number of robots; each is hit twelve times.")] = 1000,
    only: Annotated[
        int | None, typer.Option("--only", metavar="N", help="Only hit N: its figures, traces and report.")
    ] = None,
    assignments: SetOption = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Without it: out/crowd/DRAW, or out/crowd/hit-N.")
    ] = None,
    threads: ThreadsOption = None,
) -> None:
    """Hit every robot of the crowd; a table per plant, with intervals and the worst cases, in DIR."""
    if context.invoked_subcommand is not None:
        return
    from giveway.base.errors import UnknownNameError
    from giveway.crowd.population import DRAWS

    controller = _controller(assignments)
    if draw not in DRAWS:
        raise UnknownNameError("--draw", draw, DRAWS)
    if only is not None:
        _one(draw, only, controller, out or OUT / f"hit-{only}")
    else:
        _all(draw, robots, controller, out or OUT / draw, threads)


def _controller(assignments: list[str] | None) -> Mapping[str, Value]:
    """The controller's parameters; the robots belong to the draw."""
    from giveway.base.errors import GivewayError
    from giveway.robot.variables import parse_assignments

    overrides = parse_assignments(assignments or [])
    for name, value in overrides["testbed"].items():
        raise GivewayError(f"testbed.{name}", value, "parameters of the controller; the draw decides the robots")
    return overrides["controller"]


def _all(draw: str, robots: int, controller: Mapping[str, Value], folder: Path, threads: int | None) -> None:
    from giveway.base.checks import whole
    from giveway.crowd.crowd import ROBOTS_MAX
    from giveway.crowd.crowd import crowd as work_of
    from giveway.crowd.parts import go_on
    from giveway.crowd.table import short_cells, short_header, tables, write
    from giveway.study.messages import duration, showing
    from giveway.study.native_part import default_threads

    work = work_of(draw, whole("--robots", robots, 1, ROBOTS_MAX), controller)
    with showing(work.name) as progress:
        done = go_on(work, folder, threads or default_threads(), progress)
    for group, rows in tables(done.records):
        print_columns(f"{work.name}: {group}", short_header(), [short_cells(found) for found in rows])
    simulated_h = sum(record["simulated_s"] for record in done.records) / 3600.0
    notes = [
        f"{len(done.records)} of {work.count} runs, {simulated_h:.1f} h simulated; hits of draw `{draw}`, controller: "
        f"{', '.join(f'{name} = {value}' for name, value in controller.items()) or 'as it is by default'}."
    ]
    written = write(folder, work.name, notes, work.asked, done.records)
    if done.ran:
        typer.echo(f"{done.ran} runs in {duration(done.wall_s)}: {done.ran / done.wall_s:.0f} per second")
    failed = [record for record in done.records if not record["judged"]]
    for record in failed[:10]:
        typer.echo(f"hit {record['number']}: {record['status']}: {record['message']}", err=True)
    typer.echo(f"Written: {' and '.join(str(path) for path in written)}")
    if done.interrupted:
        typer.echo("Interrupted; all parts but the one under way are kept. The same command goes on.", err=True)
        raise typer.Exit(INTERRUPTED)
    if failed:
        raise typer.Exit(FAILED)


def _one(draw: str, number: int, controller: Mapping[str, Value], folder: Path) -> None:
    """One hit: its figures as in the crowd, and the usual report of the event-exact run."""
    import json

    from giveway.base.checks import whole
    from giveway.base.files import check_output, replace_folder, write_text
    from giveway.crowd.crowd import ROBOTS_MAX, compute
    from giveway.crowd.hits import PER_ROBOT, hit
    from giveway.report import write_report
    from giveway.report.console import print_results
    from giveway.simulation import runner

    whole("--only", number, 0, ROBOTS_MAX * PER_ROBOT - 1)
    check_output(folder)
    one = hit(draw, number, controller)
    record = compute(draw, controller, [number], 1, lambda _done: None)[0]
    what = f"Robot {one.robot.number} ({one.robot.group}), {one.situation}, {one.kind}, bumper {one.bumper}."
    with working("simulation and report"):
        result = runner.run(one.scenario, None, "native")
        with replace_folder(folder) as temporary:
            result.write_into(temporary)
            write_text(temporary / "hit.json", json.dumps(record, indent=1) + "\n")
            write_report(temporary / "report.html", one.scenario.name, what, [result])
    typer.echo(what)
    print_results(one.scenario.name, {one.bumper: result})
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
    typer.echo(f"Written: {folder / 'report.html'}")


FIGURES = ("delay_ms", "direction_deg", "later_direction_deg", "place_mm", "later_place_mm")
