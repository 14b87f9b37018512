"""The commands `giveway sweep` and `giveway study`."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from giveway.base.options import DaskOption, ThreadsOption, refuse_stated
from giveway.base.terminal import (
    INTERRUPTED,
    print_columns,
    print_document,
    print_written,
    progress_bars,
    wants_json,
    working,
)

if TYPE_CHECKING:
    from giveway.study.answers import Answers
    from giveway.study.tolerance_indices import Indices

__all__ = ["optimise_designs", "study_app", "sweep_designs"]

QUICK_S = 1.0  # nobody needs to be told of what takes less

study_app = typer.Typer(name="study", help="Show a study, and export its designs.", no_args_is_help=True)


def sweep_designs(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY.toml", help="Study file; see `examples/studies/magnetic_latch.toml`.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder of the study. Without it: out/studies/STUDY.")
    ] = None,
    threads: ThreadsOption = None,
    dask: DaskOption = None,
    check: Annotated[
        bool, typer.Option("--check", help="Check the study and say how many runs it has; run nothing.")
    ] = False,
) -> None:
    """Run a study of many designs, or go on with it; then tables, Pareto front, traces and a report in DIR."""
    from giveway.study import messages, study_file
    from giveway.study.engine import plan_runs
    from giveway.study.engine import sweep as run_study

    setup = study_file.read(study)
    folder = Path("out/studies") / study.stem if out is None else out
    if check:
        typer.echo(messages.sizes(setup, plan_runs(setup)))
        return
    with messages.showing(setup.name) as progress:
        outcome = run_study(setup, folder, threads=threads, progress=progress, dask=dask)
    typer.echo(messages.overview(setup, outcome))
    if outcome.interrupted:
        again = _again("sweep", study, out, dask)
        _interrupted(f"what is stored is kept. `{again}` goes on from there.")
    _write_and_print(folder, threads)


def _again(command: str, study: Path, out: Path | None, dask: str | None) -> str:
    """The command that goes on."""
    options = ("" if out is None else f" --out {out}") + ("" if dask is None else f" --dask {dask}")
    return f"giveway {command} {study}{options}"


def _interrupted(words: str) -> NoReturn:
    typer.echo(f"Interrupted; {words}", err=True)
    raise typer.Exit(INTERRUPTED)


def _write_and_print(folder: Path, threads: int | None) -> None:
    """How sure, traces of the best, report and tables of a study whose runs are all there."""
    from giveway.study import messages
    from giveway.study.certainty import make_sure
    from giveway.study.sure import wanted

    try:
        found = _load(folder)
        if wanted(found):
            with messages.showing(messages.SURE) as progress:
                make_sure(found, threads, progress)
        with progress_bars((messages.CHOSEN, messages.REPORT)) as report_progress:
            written = messages.write_all(found, progress=report_progress)
    except KeyboardInterrupt:
        _interrupted(f"all runs are stored. `giveway study show {folder}` shows the answers.")
    _print_answers(found)
    print_written(*written)


def optimise_designs(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY.toml", help="Study file; see `examples/studies/spring_and_magnet.toml`.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder of the search. Without it: out/optima/STUDY.")
    ] = None,
    threads: ThreadsOption = None,
    dask: DaskOption = None,
    check: Annotated[bool, typer.Option("--check", help="Check the study and say how many runs it may take.")] = False,
) -> None:
    """Search the best designs of a study, or go on with it; then what `giveway sweep` gives, too (needs pymoo)."""
    from giveway.study import messages, optimum, study_file

    setup = study_file.read(study, search=True)
    optimum.check_search(setup)
    folder = Path("out/optima") / study.stem if out is None else out
    if check:
        typer.echo(messages.search_sizes(setup))
        return
    goes_on = f"what is stored is kept. `{_again('optimise', study, out, dask)}` goes on from there."
    try:
        with messages.showing(setup.name) as progress:
            found = optimum.optimise(setup, folder, threads=threads, progress=progress, dask=dask)
    except KeyboardInterrupt:  # between two generations, where nothing runs
        _interrupted(goes_on)
    typer.echo(messages.overview(setup, found.outcome))
    if found.outcome.interrupted:
        _interrupted(goes_on)
    _write_and_print(folder, threads)


@study_app.command("show")
def study_show(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that `giveway sweep` wrote.")],
) -> None:
    """Show the first answers of a study, also while it runs or after it was interrupted; writes its report."""
    from giveway.study import messages

    found = _load(folder)
    _print_answers(found)
    with working(messages.REPORT) as progress:
        written = messages.write_all(found, simulate_chosen=False, progress=lambda _name, share: progress(share))
    print_written(*written)


@study_app.command("compare")
def study_compare(
    first: Annotated[Path, typer.Argument(metavar="A", help="Folder of a study.")],
    second: Annotated[Path, typer.Argument(metavar="B", help="Folder of another one.")],
) -> None:
    """Compare two studies: what was asked otherwise, the recommended designs side by side, and their margins."""
    from giveway.study import compare

    found = compare.compare(_load(first), _load(second))
    if wants_json():
        print_document({"schema_version": 1, **found.document()})
        return
    print_columns(
        "Compared", ("", "study", ""), [(x, *rest) for x, *rest in zip("AB", found.names, found.titles, strict=True)]
    )
    print_columns("What was asked otherwise", compare.ASKED_HEADER, found.asked or [("nothing", "", "")])
    print_columns("Recommended designs", compare.RECOMMENDED_HEADER, found.recommended)
    if found.margins:
        print_columns("Margins", compare.MARGIN_HEADER, found.margin_rows())


@study_app.command("evidence")
def study_evidence(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that `giveway sweep` wrote.")],
    design: Annotated[
        int | None, typer.Option("--design", metavar="N", help="Without it: the recommended design.")
    ] = None,
    speeds: Annotated[
        str | None, typer.Option("--speeds", metavar="A,B", help="Contact speeds, m/s; without it: around the study's.")
    ] = None,
    masses: Annotated[
        str | None, typer.Option("--masses", metavar="A,B", help="Test masses, kg; without it: around the study's.")
    ] = None,
    threads: Annotated[
        int | None, typer.Option("--threads", help="Native threads; without it: all processors.")
    ] = None,
) -> None:
    """Forces, pressure and travel of a design over speed, place and mass, worst within tolerances, as HTML and CSV."""
    from giveway.study import messages
    from giveway.study.evidence import NOTICE, evidence
    from giveway.study.evidence_page import summary, write_evidence

    found = _load(folder)
    wanted = {"speeds": _numbers("--speeds", speeds), "masses": _numbers("--masses", masses)}
    try:
        with messages.showing("evidence") as progress:
            told = evidence(found, design, threads=threads, progress=progress, **wanted)
    except KeyboardInterrupt:
        _interrupted("what is stored is kept; the same command goes on from there.")
    written = write_evidence(found, told)
    header, *rows = summary(told)
    print_columns(f"Design {told.design}: worst case by speed", header, rows)
    typer.echo(NOTICE)
    print_written(*written)


def _numbers(option: str, text: str | None) -> list[float] | None:
    from giveway.base.errors import GivewayError

    try:
        return None if text is None else [float(word) for word in text.split(",")]
    except ValueError:
        raise GivewayError(option, text, "numbers with commas between them, such as 0.25,0.5") from None


@study_app.command("sure")
def study_sure(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that `giveway sweep` wrote.")],
    design: Annotated[
        int | None, typer.Option("--design", metavar="N", help="Without it: the recommended design.")
    ] = None,
    method: Annotated[
        str | None, typer.Option("--method", help="subset or plain sampling; without it: as the study says.")
    ] = None,
    runs: Annotated[
        int | None, typer.Option("--runs", help="At most so many samples; without it: as the study says.")
    ] = None,
    indices: Annotated[
        int | None, typer.Option("--indices", help="Base samples of the Sobol' indices; 0: none; as the study says.")
    ] = None,
    threads: ThreadsOption = None,
) -> None:
    """How probable it is, within the tolerances, that a design exceeds a limit, and what decides it."""
    from giveway.base.checks import whole
    from giveway.study import certainty, messages, sure, tolerance_indices
    from giveway.study.frames import best_design
    from giveway.study.sure_plan import INDICES_MAX

    found = _load(folder)
    number = best_design(found) if design is None else found.check_design(design)
    plan = sure.plan_with(found.setup.sure, runs, method)
    count = plan.indices if indices is None else whole("--indices", indices, 0, INDICES_MAX)
    if indices:
        tolerance_indices.several_inputs(found.setup)
    told = None
    try:
        with messages.showing(messages.SURE) as progress:
            sure.probability(found, number, plan, threads=threads, progress=progress)
            if count and tolerance_indices.has_several_inputs(found.setup):
                told = tolerance_indices.indices(found, number, count, threads=threads, progress=progress)
    except KeyboardInterrupt:
        _interrupted("what is stored is kept; the same command goes on from there.")
    print_columns(f"Design {number}", (found.setup.name, ""), certainty.probability_lines(found, number))
    if told is not None:
        _print_indices(told)


def _print_indices(told: Indices) -> None:
    from giveway.study import certainty

    if told.found:
        print_columns(certainty.index_title(told), certainty.INDEX_HEADER, certainty.index_rows(told))
        typer.echo(certainty.INDEX_NOTE)
    if told.reason:
        typer.echo(f"What decides is not known of all: {told.reason}.")


@study_app.command("run")
def study_run(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that `giveway sweep` wrote.")],
    design: Annotated[int, typer.Option("--design", metavar="N", help="Number of the design.")],
) -> None:
    """Simulate one design again, event-exact and with traces, in DIR/chosen/design-N."""
    from giveway.report.console import print_results
    from giveway.study.chosen import simulate
    from giveway.study.store import CHOSEN

    found = _load(folder)
    found.check_design(design)
    with working(f"design {design}"):
        results = simulate(found.setup, found.runs, folder, design)
    for name, result in results.items():
        print_results(f"design {design}, {name}", {result.manifest["scenario"]["bumper"]: result})
    print_written(folder / CHOSEN / f"design-{design}")


@study_app.command("export")
def study_export(
    context: typer.Context,
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that `giveway sweep` wrote.")],
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="FILE.ssv, FILE.toml (for `giveway run`) or FILE.csv.")
    ],
    design: Annotated[
        int | None, typer.Option("--design", metavar="N", help="Without it: the table of all, as CSV.")
    ] = None,
    collision: Annotated[
        str | None, typer.Option("--collision", metavar="NAME", help="Of FILE.ssv or FILE.toml; without it: the first.")
    ] = None,
    model: Annotated[str, typer.Option("--model", help="Whose SSV: testbed, controller or bumper.")] = "testbed",
) -> None:
    """Export a design: parameters for an FMU (SSV 1.0), a scenario file, or a list of values."""
    from giveway.base.files import check_file
    from giveway.study.export import export_design, export_table

    check_file(out)
    for option, kinds in (("--collision", (".ssv", ".toml")), ("--model", (".ssv",))):
        if out.suffix not in kinds:
            refuse_stated(context, f"only if --out ends in {' or '.join(kinds)}", (option,))
    found = _load(folder)
    if design is None:
        export_table(found, out)
    else:
        export_design(found, design, out, collision=collision, model=model)
    print_written(out)


@study_app.command("gallery")
def study_gallery(
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the pictures.")] = Path("docs"),
    studies: Annotated[Path, typer.Option("--studies", metavar="DIR", help="Folder for the runs.")] = Path(
        "out/studies"
    ),
    examples: Annotated[Path, typer.Option("--examples", metavar="DIR", help="Where the study files are.")] = Path(
        "examples/studies"
    ),
) -> None:
    """Run the example studies and draw the pictures of them on the page of studies."""
    from giveway.study import messages
    from giveway.study.gallery import draw_all

    for path, sentence in draw_all(examples, studies, out, messages.showing):
        typer.echo(f"{path}: {sentence}")


def _load(folder: Path) -> Answers:
    """The answers of the study in ``folder``; a large one takes a while to read, which is said."""
    from giveway.study import answers

    name = "reading the runs"
    began = time.monotonic()
    with progress_bars((name,)) as progress:

        def say(share: float) -> None:
            if time.monotonic() - began > QUICK_S:
                progress(name, share)

        return answers.load(folder, say)


def _print_answers(found: Answers) -> None:
    from giveway.study import certainty, tables
    from giveway.study.advice import MARGIN_HEADER, advice

    first = advice(found)
    print_columns(first.title, (found.setup.name, ""), first.lines)
    if first.margins:
        print_columns("Margins", MARGIN_HEADER, first.margins)
    print_columns(f"{found.setup.name}: {tables.counts(found)}", tables.goal_header(found), tables.design_rows(found))
    if told := tables.search_in_words(found):
        typer.echo(told)
    if (shares := certainty.recommended_indices(found)) is not None:
        _print_indices(shares)
    if misfits := tables.misfit_rows(found):
        print_columns("Parts that do not fit", tables.MISFIT_HEADER, misfits)
    rows = tables.sensitivity_rows(found)
    if rows:
        print_columns("What decides", tables.sensitivity_header(found), rows)
    if reason := found.sensitivities().reason:
        typer.echo(f"What decides is not known: {reason}.")
