"""Runs a study, part by part: each is one call of the batch library, stored as a whole before the next begins."""

from __future__ import annotations

import hashlib
import json
import platform
import shutil
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import ClusterError, FileError, GivewayError, InputFileError
from giveway.base.version import VERSION
from giveway.base.words import memory
from giveway.library.batch_library import THREADS_MAX, library
from giveway.library.work import RunningWork, Work, default_threads, result_columns
from giveway.simulation.run_warnings import Stated
from giveway.study import designs as design_module
from giveway.study.drivetrain_metrics import derived
from giveway.study.parts import choices_of
from giveway.study.results_table import NOT_CACHED, Outcomes, part_table, read_part
from giveway.study.runs import RunTable
from giveway.study.search_plan import OPTIMISED
from giveway.study.setup import Setup
from giveway.study.store import INPUT_FILES, KeyIndex, Store, catalogue_copy

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.cluster.pool import Pool

__all__ = [
    "Outcome",
    "Progress",
    "Report",
    "Runner",
    "check_disk",
    "deviations_of",
    "fingerprint_of",
    "keep_inputs",
    "load_runs",
    "manifest_of",
    "plan_runs",
    "shared_facts",
    "sweep",
    "workforce",
]

PART_S = 5.0  # of work in one part: what a kill may lose
PART_FIRST, PART_MAX = 32, 8192
WAIT_S = 0.1
DISK_SHARE = 0.9  # of the free space that a study may fill
BYTES_PER_NUMBER = 8  # metrics hardly compress


@dataclass(frozen=True)
class Progress:
    """How far a study is: runs ``done`` of ``runs``, of which ``reused`` were stored before; ``rate`` in runs/s."""

    done: int
    runs: int
    reused: int
    failed: int
    rate: float

    @property
    def left_s(self) -> float | None:
        """Time left at this rate, s; None: not known yet."""
        return (self.runs - self.done) / self.rate if self.rate > 0.0 else None


Report = Callable[[Progress], None]


@dataclass(frozen=True)
class Outcome:
    """What `sweep` did: ``stored`` of ``runs`` are in the folder, ``ran`` of them run now, ``reused`` taken over.

    ``removed``: of the study that was there before, seen from the folder.
    """

    folder: Path
    runs: int
    stored: int
    ran: int
    reused: int
    failed: int
    wall_s: float
    interrupted: bool
    removed: tuple[Path, ...] = ()


@dataclass
class _Prepared:
    """A part before it runs."""

    first: int
    values: NDArray[np.float64]
    case: NDArray[np.int64]
    keys: list[bytes]
    stated: Stated
    refused: dict[int, str]
    derived: dict[str, tuple[NDArray[np.float64], str]]


@dataclass
class _Begun:
    """A part that runs: ``fresh`` are computed as ``work``; ``copies`` (their own, whose) have what equal runs have."""

    part: _Prepared
    outcomes: Outcomes
    fresh: NDArray[np.int64]
    copies: NDArray[np.int64]
    reused: int
    work: Work | None


def plan_runs(setup: Setup) -> RunTable:
    """The table of all runs of ``setup``."""
    if setup.plan.kind == OPTIMISED:
        raise _with_line(setup, GivewayError("designs.kind", OPTIMISED, "`giveway optimise` of this file"))
    return RunTable(setup, design_module.make(setup.plan, setup.varied, setup.seed), deviations_of(setup))


def deviations_of(setup: Setup) -> NDArray[np.float64]:
    """The tolerance samples of every design, the nominal one first."""
    draws = sum(quantity.draws for quantity in setup.crowd)
    if setup.noise_seeds and not setup.tolerances and not draws:
        return np.zeros((1 + setup.tolerance_count, 0))
    sampled = (setup.tolerances, setup.tolerance_kind, setup.tolerance_count, setup.seed + 1)
    return design_module.deviations(*sampled, draws)


def check_disk(setup: Setup, count: int, folder: Path) -> None:
    """Refuse a study whose results would not fit, before anything is run."""
    columns = len(result_columns()) + len(setup.varied) + len(setup.tolerances) + 6
    columns += sum(quantity.draws for quantity in setup.crowd)
    needed = count * columns * BYTES_PER_NUMBER
    parent = folder.absolute()
    while not parent.exists():
        parent = parent.parent
    free = shutil.disk_usage(parent).free
    if needed > DISK_SHARE * free:
        searched = setup.plan.kind == OPTIMISED
        key = "optimise.designs" if searched else "designs.count" if setup.plan.count else "designs"
        allowed = f"as many as fit into {memory(DISK_SHARE * free)} of free space on the disk of {folder}"
        raise _with_line(setup, GivewayError(key, f"{count} runs ({memory(needed)})", allowed))


def _with_line(setup: Setup, error: GivewayError) -> GivewayError:
    """``error`` about a key of the study, with file and line if it came from a file."""
    if setup.text is None or setup.path is None:
        return error
    from giveway.base.toml_lines import line_of

    return InputFileError(setup.path, line_of(setup.text, error.field), error)


def sweep(
    setup: Setup,
    folder: Path | str,
    *,
    threads: int | None = None,
    progress: Report | None = None,
    dask: str | None = None,
) -> Outcome:
    """Run what is missing of ``setup`` in ``folder``.

    Ctrl-C ends it cleanly: all parts but those under way are kept, and the same call goes on from there. ``dask`` is
    the address of a scheduler whose workers run the parts, or "local": ``threads`` processes on this machine.

    Raises:
        MissingExtraError: ``dask`` needs a package that is not installed.
        GivewayError: the study cannot be run as it is; nothing was run.
        FileError: the folder holds something else, is in use, or cannot be written.
        WriteError: writing failed; the parts written before are kept.
        ClusterError: no worker is left, or the scheduler is lost; the parts written before are kept.
    """
    folder = Path(folder)
    Store.check(folder)
    design_count = setup.plan.size(setup.varied)
    expected = design_count * max(1, setup.tolerance_count) * len(setup.cases)
    check_disk(setup, expected, folder)  # before the designs are made: they may be too many for the memory as well
    table = plan_runs(setup)
    shared = shared_facts(setup)
    contexts = [case.context(shared) for case in table.cases]
    fingerprint = fingerprint_of(table, contexts)
    with workforce(threads, dask) as workers, closing(Store(folder, fingerprint)) as store:
        manifest = manifest_of(setup, table, shared, fingerprint)
        store.write_designs(table.designs, table.deviations)
        # First the manifest: without one, a folder with files in it is taken for somebody else's.
        store.write_manifest({**manifest, "complete": not store.missing(table.count)})
        keep_inputs(setup, store.folder)
        outcome = Runner(setup, contexts, store, workers, progress).run(table)
        if not outcome.interrupted:
            store.write_manifest({**manifest, "complete": True})
        return outcome


@contextmanager
def workforce(threads: int | None, dask: str | None) -> Iterator[int | Pool]:
    """Who runs the parts: native threads of this process, or the workers of a Dask scheduler."""
    from giveway.base.checks import whole

    if threads is not None:
        whole("threads", threads, 1, THREADS_MAX)
    if dask is None:
        yield default_threads() if threads is None else threads
        return
    from giveway.cluster.pool import joined
    from giveway.study.golden import golden_works

    with joined(dask, threads, golden_works()) as pool:
        yield pool


def shared_out(size: int, runs: int) -> int:
    """About ``size``, so that ``runs`` are cut into parts as long as each other."""
    return -(-runs // max(1, runs // size))


class Runner:
    """The loop over the parts."""

    def __init__(
        self,
        setup: Setup,
        contexts: list[bytes],
        store: Store,
        workers: int | Pool,
        progress: Report | None,
    ) -> None:
        """``workers``: native threads here, or those of a cluster."""
        self._setup, self._contexts, self._store = setup, contexts, store
        self._workers, self._progress = workers, progress
        self._index: KeyIndex | None = None
        self._stored = self._ran = self._reused = self._failed = 0
        self._started = time.perf_counter()
        self._before = 0  # runs that were stored when this began
        self._rate = 0.0
        self._said = 0.0

    def run(self, table: RunTable, expected: int | None = None) -> Outcome:
        """Run what is missing of ``table``; it may be called again with a longer one, up to ``expected`` runs."""
        self._table = table
        self._expected = table.count if expected is None else expected
        interrupted = False
        try:
            gaps = self._store.missing(table.count)
            self._stored = table.count - sum(end - first for first, end in gaps)
            if self._index is None:
                self._index = self._load_keys()
                self._before, self._started = self._stored, time.perf_counter()
            if isinstance(self._workers, int):
                self._run_here(gaps, self._workers)
            else:
                self._run_there(deque(gaps), self._workers)
        except KeyboardInterrupt:
            interrupted = True
        wall_s = time.perf_counter() - self._started
        # Ctrl-C may have come between the last part and its being counted.
        self._stored = self._table.count - sum(end - first for first, end in self._store.missing(self._table.count))
        found = (self._table.count, self._stored, self._ran, self._reused, self._failed)
        return Outcome(self._store.folder, *found, wall_s, interrupted, tuple(self._store.removed))

    def _run_here(self, gaps: list[tuple[int, int]], threads: int) -> None:
        """Part by part; while one runs, the following one is prepared."""
        prepared = None
        for first, end in gaps:
            while first < end:
                size = min(self._part_size(), end - first)
                if prepared is None or prepared.first != first:
                    prepared = self._prepare(first, size)
                first += len(prepared.keys)
                following = (first, min(self._part_size(), end - first)) if first < end else None
                begun = self._begin(prepared)
                prepared = self._run_fresh(begun, threads, following)
                self._end(begun)

    def _run_there(self, gaps: deque[tuple[int, int]], pool: Pool) -> None:
        """As many parts at once as the workers can have; stored in the order in which they come back."""
        under_way: dict[int, _Begun] = {}
        stored: dict[int, tuple[Path, _Begun]] = {}
        while gaps or under_way:
            left = sum(end - first for first, end in gaps)
            while gaps and (size := pool.wants(left)):
                first, end = gaps.popleft()
                size = min(self._setup.part_runs or shared_out(size, end - first), end - first)
                if first + size < end:
                    gaps.appendleft((first + size, end))
                left -= size
                begun = self._begin(self._prepare(first, size))
                if begun.work is None:
                    self._end(begun)
                else:
                    pool.submit(first, begun.work)
                    begun.work = None  # the pool has it
                    under_way[first] = begun
            for first, done in pool.wait(WAIT_S):
                if done is not None:
                    begun = under_way.pop(first)
                    begun.outcomes.take(begun.fresh, done)
                    stored[first] = (self._end(begun), begun)
                elif first in stored:
                    gaps.append(self._withdraw(*stored.pop(first)))
                else:  # of an earlier call, whose results have been used
                    raise ClusterError(
                        self._store.parts_folder,
                        f"has results of a worker that computes otherwise, from run {first} on",
                        "delete it; the same command begins anew",
                    )
            self._say(0)

    def _withdraw(self, path: Path, begun: _Begun) -> tuple[int, int]:
        """Take a stored part back; returns its runs."""
        assert self._index is not None
        path.unlink()
        self._index.discard(path)
        self._count(begun, -1)
        return begun.part.first, begun.part.first + len(begun.part.keys)

    def _load_keys(self) -> KeyIndex:
        index = KeyIndex()
        for path in self._store.all_parts():
            try:
                part = read_part(path, ["key", "status"])
            except FileError:
                if path.is_relative_to(self._store.parts_folder):
                    raise
                continue  # another study's: it is not needed
            keys, statuses = part["key"].to_pylist(), part["status"].to_pylist()
            index.add(path, [b"" if s in NOT_CACHED else key for key, s in zip(keys, statuses, strict=True)])
        return index

    def _part_size(self) -> int:
        if self._setup.part_runs:
            return self._setup.part_runs
        return int(np.clip(PART_S * self._rate, PART_FIRST, PART_MAX))

    def _prepare(self, first: int, size: int) -> _Prepared:
        """Values and keys of the runs from ``first`` on."""
        table = self._table
        design, sample, case = table.split(np.arange(first, first + size))
        values = np.empty((size, len(table.columns.names)))
        keys, refused, stated = [b""] * size, {}, Stated.nothing(size)
        for number in range(len(table.cases)):
            mine = np.flatnonzero(case == number)
            if not mine.size:
                continue
            rows = table.rows(design[mine], sample[mine], number)
            values[mine] = rows.values
            stated.put(mine, rows.stated)
            for index, key in zip(mine.tolist(), table.keys(self._contexts, rows, number), strict=True):
                keys[index] = key
            for row, message in rows.refused.items():
                index = int(mine[row])
                refused[index] = message
                # A refused run may have the values of a possible one: its slider was never placed.
                keys[index] = hashlib.blake2b(keys[index] + message.encode(), digest_size=len(keys[index])).digest()
        found = derived(table.derived, table.drivetrain, values, stated)
        return _Prepared(first, values, case, keys, stated, refused, found)

    def _begin(self, part: _Prepared) -> _Begun:
        """What of a part has to be run, and what is known of the rest."""
        outcomes = Outcomes(len(part.keys))
        for index, message in part.refused.items():
            outcomes.refuse(index, message)
        reused = self._take_stored(part, outcomes)
        first_of: dict[bytes, int] = {}
        fresh, twins, twins_of = [], [], []
        for index, key in enumerate(part.keys):
            if index in part.refused or index in reused:
                continue
            if key in first_of:
                twins.append(index)
                twins_of.append(first_of[key])
            else:
                first_of[key] = index
                fresh.append(index)
        where = np.array(fresh, dtype=np.int64)
        work = None
        if fresh:
            setup = self._setup
            work = self._table.work(part.values[where], part.case[where], setup.method, setup.plant_step_s)
        part.values = np.empty((0, 0))  # large, and not needed any more
        copies = np.array([twins, twins_of], dtype=np.int64)
        return _Begun(part, outcomes, where, copies, len(reused) + len(twins), work)

    def _end(self, begun: _Begun) -> Path:
        """Store a part whose runs are done."""
        assert self._index is not None
        part, outcomes = begun.part, begun.outcomes
        outcomes.copy(*begun.copies)
        stored = part_table(self._table, part.first, part.keys, outcomes, part.stated, part.derived)
        path = self._store.write_part(part.first, stored)
        keys = [b"" if s in NOT_CACHED else key for key, s in zip(part.keys, outcomes.status, strict=True)]
        self._index.add(path, keys)
        self._count(begun, 1)
        self._say(0, force=True)
        return path

    def _count(self, begun: _Begun, sign: int) -> None:
        self._stored += sign * len(begun.part.keys)
        self._ran += sign * len(begun.fresh)
        self._reused += sign * begun.reused
        self._failed += sign * sum(status != "ok" for status in begun.outcomes.status)

    def _take_stored(self, part: _Prepared, outcomes: Outcomes) -> set[int]:
        """Results that are there already, from whichever part."""
        assert self._index is not None
        found = self._index.find(part.keys)
        taken: set[int] = set()
        for number in np.unique(found[found[:, 0] >= 0, 0]):
            where = np.flatnonzero(found[:, 0] == number)
            where = where[[int(index) not in part.refused for index in where]]
            path, rows = self._index.files[int(number)], found[where, 1]
            # The index compares halves of keys.
            try:
                keys = read_part(path, ["key"])["key"].take(rows).to_pylist()
                same = np.array([part.keys[i] == key for i, key in zip(where, keys, strict=True)], dtype=bool)
                outcomes.take_stored(where[same], path, rows[same])
            except FileError:
                if path.is_relative_to(self._store.parts_folder):
                    raise
                continue  # another study was deleted meanwhile
            taken.update(where[same].tolist())
        return taken

    def _run_fresh(self, begun: _Begun, threads: int, following: tuple[int, int] | None) -> _Prepared | None:
        """Run a part; meanwhile prepare the ``following`` one (first run, number of runs)."""
        if begun.work is None:
            return None
        started = time.perf_counter()
        running = RunningWork(begun.work)
        try:
            running.start(threads)
            prepared = self._prepare(*following) if following is not None else None
            done = False
            while not done:
                done, runs_done = running.wait(WAIT_S)
                self._say(runs_done)
        finally:
            running.finish()
        self._rate = len(begun.work) / max(time.perf_counter() - started, 1e-6)
        begun.outcomes.take(begun.fresh, running.done())
        return prepared

    def _say(self, under_way: int, force: bool = False) -> None:
        now = time.perf_counter()
        if self._progress is None or (now - self._said < WAIT_S and not force):
            return
        self._said = now
        done = self._stored + under_way
        rate = (done - self._before) / max(now - self._started, 1e-6)
        self._progress(Progress(done, self._expected, self._reused, self._failed, rate))


def shared_facts(setup: Setup) -> dict[str, Any]:
    """What decides every run, besides its own numbers: the code and the method."""
    models = library().models
    return {
        "giveway": VERSION,
        "library_sha256": next(iter(models.values())).sha256,
        "tokens": {name: one.token for name, one in models.items()},
        "method": setup.method,
        "plant_step_s": setup.plant_step_s,
        "metrics": [name for name, _ in result_columns()],
    }


def fingerprint_of(table: RunTable, contexts: list[bytes]) -> str:
    """Hash of everything that decides the results of the study, and in which order they lie."""
    found = hashlib.sha256()
    names = [one.quantity.name for one in table.varied] + [one.quantity.name for one in table.tolerances]
    names += [name for name, _ in table.robot_draws()] + [
        f"{one.quantity.name} itself" for one in table.tolerances if one.replaces
    ]
    found.update(json.dumps([names, [case.case.name for case in table.cases], table.noise_seeds]).encode())
    for part in (*contexts, table.designs.tobytes(), table.deviations.tobytes()):
        found.update(hashlib.sha256(part).digest())
    for case in table.cases:
        found.update(case.base.tobytes() + repr(case.case.hit).encode())
    if table.derived:
        told = [table.derived, table.drivetrain.load, table.drivetrain.servo_delay]
        found.update(json.dumps(told).encode())
    for choice in choices_of(table.varied):  # a design has the number of its part, which may be another one by now
        stated = {name: (column.unit, column.cells) for name, column in choice.catalogue.columns.items()}
        found.update(json.dumps([choice.name, choice.parts, choice.count, stated]).encode())
        found.update(json.dumps([[one.quantity.name, one.values.tolist()] for one in choice.settings]).encode())
        found.update(json.dumps([[one.quantity.name, one.column, one.sense] for one in choice.limits]).encode())
    return found.hexdigest()


def manifest_of(setup: Setup, table: RunTable, shared: dict[str, Any], fingerprint: str) -> dict[str, Any]:
    """What the folder says about itself."""
    import importlib.metadata

    return {
        "name": setup.name,
        "study": _portable(setup),
        "fingerprint": fingerprint,
        "designs": len(table.designs),
        "tolerance_samples": table.samples,
        "collisions": [case.case.name for case in table.cases],
        "runs": table.count,
        "seed": setup.seed,
        "method": setup.method,
        "plant_step_s": setup.plant_step_s,
        "designs_sha256": hashlib.sha256(table.designs.tobytes()).hexdigest(),
        "library": {key: value for key, value in shared.items() if key != "metrics"},
        "versions": {
            "giveway": shared["giveway"],
            "python": platform.python_version(),
            **{name: importlib.metadata.version(name) for name in ("numpy", "scipy", "SALib", "pyarrow")},
        },
        "platform": platform.platform(),
    }


def _portable(setup: Setup) -> dict[str, Any]:
    """The document of the study, with its paths into the study's folder."""
    document = json.loads(json.dumps(setup.document))
    if "robot" in document.get("scenario", {}):
        document["scenario"]["robot"] = INPUT_FILES[0]
    if _measured_bumper(document.get("scenario", {})):
        document["scenario"]["bumper"]["file"] = INPUT_FILES[2]
    if document.get("designs", {}).get("kind") == "csv":
        document["designs"]["file"] = INPUT_FILES[1]
    for index, parts in enumerate(document.get("parts", [])):
        parts["catalogue"] = catalogue_copy(index, parts["catalogue"])
    assert isinstance(document, dict)
    return document


def _measured_bumper(scenario: dict[str, Any]) -> str | None:
    """The path of the table that the bumper's law is, as written."""
    bumper = scenario.get("bumper")
    return bumper.get("file") if isinstance(bumper, dict) else None


def keep_inputs(setup: Setup, folder: Path) -> None:
    """Copies of the files that the study names: the folder must be complete by itself."""
    from giveway.base.files import write_text

    for source, name in _input_files(setup):
        text = source.read_text(encoding="utf-8-sig")
        if not (folder / name).is_file() or (folder / name).read_text(encoding="utf-8") != text:
            write_text(folder / name, text)


def _input_files(setup: Setup) -> Iterator[tuple[Path, str]]:
    robot = setup.cases[0].scenario.robot
    if robot is not None:
        yield Path(robot), INPUT_FILES[0]
    measured = _measured_bumper(setup.document["scenario"])
    if measured is not None:
        yield setup.folder / measured, INPUT_FILES[2]
    if setup.plan.kind == "csv":
        yield setup.folder / setup.document["designs"]["file"], INPUT_FILES[1]
    for index, parts in enumerate(setup.document.get("parts", [])):
        yield setup.folder / parts["catalogue"], catalogue_copy(index, parts["catalogue"])


def load_runs(folder: Path | str) -> tuple[Setup, RunTable, dict[str, Any]]:
    """The study in a folder that `sweep` wrote, its runs, and its manifest."""
    from giveway.study.store import MANIFEST_FILE, PARTS, read_designs, read_manifest
    from giveway.study.study_file import check

    folder = Path(folder)
    manifest = read_manifest(folder)
    try:
        setup = check(manifest["study"], folder, manifest["name"])
    except FileError:
        raise
    except GivewayError as error:
        raise FileError(folder / MANIFEST_FILE, f"is of another version of giveway: {error}") from None
    return setup, RunTable(setup, *read_designs(folder / PARTS / manifest["fingerprint"][:16])), manifest
