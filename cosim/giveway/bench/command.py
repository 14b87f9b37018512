"""The command `giveway bench`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from giveway.base.options import FmiOption, refuse_stated
from giveway.base.terminal import INTERRUPTED, print_columns, progress_bars, working

__all__ = ["bench"]

OPTIONS = {
    "": ("--repeats", "--fmi"),
    "--tune": ("--minutes", "--false-alarms"),
    "--optimum": ("--sample", "--runs", "--seeds", "--out"),
}  # of each measurement; "": of the one without an option


def bench(
    context: typer.Context,
    repeats: Annotated[int, typer.Option("--repeats", help="Runs to measure, 1 to 100.")] = 5,
    fmi: FmiOption = 3,
    scale: Annotated[
        bool, typer.Option("--scale", help="Only: what a study and Dask cost beside the runs, and a million designs.")
    ] = False,
    probability: Annotated[
        bool, typer.Option("--probability", help="Only: do intervals of rare probabilities hold what is known?")
    ] = False,
    tune: Annotated[
        int | None,
        typer.Option("--tune", metavar="ROBOTS", help="Only: do thresholds tuned on logs keep what they promise?"),
    ] = None,
    minutes: Annotated[float, typer.Option("--minutes", help="Logs of each of these robots, 1 to 60.")] = 6.0,
    false_alarms: Annotated[
        str, typer.Option("--false-alarms", metavar="RATE", help="What they are tuned for, as of `giveway tune`.")
    ] = "60/h",
    optimum: Annotated[
        Path | None,
        typer.Option("--optimum", metavar="STUDY.toml", help="Only: what a search finds, against an even sample."),
    ] = None,
    sample: Annotated[int, typer.Option("--sample", help="Runs of the even sample.")] = 200_000,
    runs: Annotated[int, typer.Option("--runs", help="Runs of each search.")] = 2000,
    seeds: Annotated[int, typer.Option("--seeds", help="Searches, each with a seed of its own.")] = 10,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Where their runs are stored.")] = Path(
        "out/bench/optimum"
    ),
) -> None:
    """Measure speed: a co-simulated second over FMPy, runs per second, cost and error of the integration methods."""
    from giveway.base.checks import whole
    from giveway.bench import collisions
    from giveway.bench.co_simulation import measure
    from giveway.bench.solvers import HEADER, measure_solvers
    from giveway.tuning.command import rate_of

    whole("--repeats", repeats, 1, 100)
    _check_measurement(context, {"--scale": scale, "--probability": probability, "--tune": tune, "--optimum": optimum})
    if scale:
        _measure_sweeps()
        title = "Random collisions of 0.6 s over fixed steps, all threads"
        counts, found_rows = collisions.SCALE_COUNTS, []
        try:
            with progress_bars([collisions.scale_name(count) for count in counts]) as progress:
                for row in collisions.scale(counts, progress):
                    found_rows.append(row)
        except KeyboardInterrupt:
            raise typer.Abort from None
        finally:
            print_columns(title, collisions.SCALE_HEADER, found_rows)
        return
    if probability:
        _measure_probabilities()
        return
    if tune is not None:
        _judge_tuning(tune, minutes, rate_of(false_alarms))
        return
    if optimum is not None:
        _compare_searches(optimum, out, sample, runs, seeds)
        return
    with working("co-simulation over FMPy"):
        rows = [(row.name, f"{row.minimum_ms:.1f}", f"{row.median_ms:.1f}") for row in measure(repeats, fmi)]
    title = f"1 s of co-simulation at 1 ms over FMPy, FMI {fmi}, best and median of {repeats}"
    print_columns(title, ("part", "min (ms)", "median (ms)"), rows)
    title = f"Collisions of {collisions.SIMULATED_S:g} s with metrics, best and median of {repeats}"
    with working("collisions per second"):
        measured = collisions.measure(repeats)
    print_columns(title, collisions.HEADER, measured)
    with working("fixed steps against event-exact"):
        found, lines = collisions.accuracy()
    print_columns("Fixed steps against event-exact, random collisions", collisions.ACCURACY_HEADER, found)
    typer.echo("\n".join(["Detected on another tick:", *lines] if lines else ["All detected on the same tick."]))
    title = "Integration methods on stiffer designs: 1 s of the testbed FMU alone at relative tolerance 1e-6"
    with working("integration methods"):
        cells = [measurement.cells for measurement in measure_solvers(repeats, fmi)]
    print_columns(title, HEADER, cells)


def _check_measurement(context: typer.Context, chosen: Mapping[str, object]) -> None:
    """One measurement at a time, and its own options: GivewayError names one that would be left aside."""
    stated = [name for name, value in chosen.items() if value is not None and value is not False]
    asked = stated[0] if stated else ""
    refuse_stated(context, f"only without {asked}", stated[1:])
    for measurement, options in OPTIONS.items():
        if measurement != asked:
            refuse_stated(context, f"only with {measurement}" if measurement else f"only without {asked}", options)


def _measure_sweeps() -> None:
    from giveway.bench import sweeps
    from giveway.library.work import default_threads

    threads = default_threads()
    with progress_bars(sweeps.names(threads)) as progress:
        found = sweeps.measure(progress=progress)
    title = f"{sweeps.DESIGNS:,} bumpers, runs of 0.6 s over fixed steps, median of {sweeps.ROUNDS}"
    print_columns(title, sweeps.HEADER, found.rows())
    typer.echo("\n".join(found.in_words(threads)))


def _judge_tuning(robots: int, minutes: float, per_hour: float) -> None:
    """Logs of each robot of the judging draw, as many fresh ones, and its hits."""
    import time

    from giveway.base.checks import whole
    from giveway.library.work import default_threads
    from giveway.tuning.judged import HEADER, ROBOTS_MAX, judge, rows

    whole("--tune", robots, 1, ROBOTS_MAX)
    cpu_s = time.process_time()
    with progress_bars(["robots"]) as progress:
        found = judge("judging", robots, minutes, per_hour, default_threads(),
                      lambda done: progress("robots", done / robots))  # fmt: skip
    print_columns("Thresholds tuned on logs of robots of the crowd", HEADER, rows(found, per_hour))
    for one in [one for one in found if not one.holds]:
        told = one.refused or f"{one.alarms} alarms, foretold {one.fewest} to {one.most}"
        typer.echo(f"robot {one.number}: {told}")
    typer.echo(f"{(time.process_time() - cpu_s) / 60.0:.1f} minutes of one core")


def _measure_probabilities() -> None:
    from giveway.bench import known_probabilities as known

    ours, theirs = "subset simulation", "OpenTURNS"
    rows: list[tuple[str, ...]] = []
    try:
        with progress_bars((ours, theirs)) as progress:
            rows += known.measure(known.REPEATS, lambda share: progress(ours, share))
            rows += known.openturns_rows(known.REPEATS, lambda share: progress(theirs, share))
    except KeyboardInterrupt:
        raise typer.Abort from None
    print_columns(
        f"Limits that are exceeded with P = {known.PROBABILITY:g}, {known.REPEATS} repeats", known.HEADER, rows
    )


def _compare_searches(study: Path, out: Path, sample: int, runs: int, seeds: int) -> None:
    from giveway.bench import known_fronts
    from giveway.bench.optimum import HEADER, Comparison, compare, names, shares_in_words

    found: list[Comparison] = []
    known = "known fronts"
    try:
        with progress_bars([*names(seeds), known]) as progress:
            found.extend(compare(study, out, sample, runs, seeds, progress))
            rows = list(known_fronts.measure(sample, runs, seeds, lambda share: progress(known, share)))
    except KeyboardInterrupt:
        typer.echo("Interrupted; what is stored is kept. The same command goes on from there.", err=True)
        raise typer.Exit(INTERRUPTED) from None
    print_columns(f"Searches of {study}", HEADER, [one.cells for one in found])
    typer.echo(shares_in_words(found, sample, runs))
    print_columns(f"Searches of problems whose fronts are known, median of {seeds} seeds", known_fronts.HEADER, rows)
