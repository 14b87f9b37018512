"""Climbs the ladder: two rungs at a time, one line per rung as it ends, results as JSON."""

from __future__ import annotations

import json
import shutil
import time
import traceback
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from giveway.base.files import write_text

from verify.context import Context, Tool, kill_all
from verify.rung import Figure, Rung, RungFailed
from verify.sources import core_hash

__all__ = ["Outcome", "climb", "verified", "write_summary"]

SCHEMA_VERSION = 1
AT_A_TIME = 2


@dataclass(frozen=True)
class Outcome:
    name: str
    figure: Figure | None  # None: failed
    evidence: str
    seconds: float
    versions: Mapping[str, str]

    @property
    def line(self) -> str:
        result = self.figure.words if self.figure else self.evidence.splitlines()[0]
        return f"{'ok' if self.figure else 'FAILED':<7}{self.name:<14}{self.seconds:6.1f} s  {result}"


def climb(root: Path, rungs: Mapping[str, Rung], path: str) -> list[Outcome]:
    """Run the rungs; print a line for each as it ends and the evidence of those that failed."""
    outcomes = []
    with ThreadPoolExecutor(AT_A_TIME) as pool:
        running: list[Future[Outcome]] = [pool.submit(_run, root, name, rung, path) for name, rung in rungs.items()]
        try:
            for future in as_completed(running):
                outcome = future.result()
                print(outcome.line, flush=True)
                outcomes.append(outcome)
        except BaseException:
            for future in running:
                future.cancel()
            kill_all()
            raise
    for outcome in outcomes:
        if outcome.figure is None:
            print(f"\n{outcome.name} failed:\n{outcome.evidence}")
    order = list(rungs)
    return sorted(outcomes, key=lambda outcome: order.index(outcome.name))


def _run(root: Path, name: str, rung: Rung, path: str) -> Outcome:
    work = root / "build" / "verify" / "work" / name
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    context = Context(root, work, path)
    start = time.perf_counter()
    figure = None
    evidence = ""
    versions: dict[str, str] = {}
    try:
        versions = {tool.name: _version(context, tool) for tool in rung.tools}
        figure = rung.check(context)
    except RungFailed as failure:
        evidence = failure.evidence
    except Exception:  # an error in the rung itself must not hide the results of the other rungs
        evidence = traceback.format_exc()
    return Outcome(name, figure, evidence, time.perf_counter() - start, versions)


def _version(context: Context, tool: Tool) -> str:
    answer = context.run(context.which(tool), *tool.version, memory_gib=None)
    return next((line.strip() for line in (answer.stdout + answer.stderr).splitlines() if line.strip()), "")


def write_summary(root: Path, outcomes: list[Outcome], sources: str, seconds: float) -> Path:
    """out/verify/summary.json: what this run found, in ``seconds`` altogether."""
    path = root / "out" / "verify" / "summary.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    rungs = [
        {
            "name": outcome.name,
            "passed": outcome.figure is not None,
            "figure": outcome.figure.words if outcome.figure else None,
            "values": dict(outcome.figure.values) if outcome.figure else {},
            "evidence": outcome.evidence or None,
            "seconds": round(outcome.seconds, 1),
            "tools": dict(outcome.versions),
        }
        for outcome in outcomes
    ]
    document = {
        "schema_version": SCHEMA_VERSION,
        "sources_sha256": sources,
        "seconds": round(seconds, 1),
        "rungs": rungs,
    }
    write_text(path, _json(document))
    return path


def verified(root: Path, outcomes: list[Outcome], sources: str, order: Sequence[str]) -> Path:
    """c_core/VERIFIED.json: the sources that climbed every rung, with the figures. `make test` holds it current.

    Results of other rungs for the same sources are kept, so that a new rung can be climbed alone; a rung that failed is
    removed. ``order``: the names of all rungs.
    """
    if core_hash(root) != sources:
        raise RungFailed("c_core changed while it was being verified: run `make verify` again")
    path = root / "c_core" / "VERIFIED.json"
    before = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    if before.get("sources_sha256") != sources:
        before = {"rungs": {}, "tools": {}}
    failed = {outcome.name for outcome in outcomes if outcome.figure is None}
    rungs = {name: found for name, found in before["rungs"].items() if name not in failed} | {
        outcome.name: {"figure": outcome.figure.text, "values": dict(outcome.figure.values)}
        for outcome in outcomes
        if outcome.figure is not None
    }
    tools = before["tools"] | {name: version for outcome in outcomes for name, version in outcome.versions.items()}
    document = {
        "schema_version": SCHEMA_VERSION,
        "sources_sha256": sources,
        "rungs": {name: rungs[name] for name in order if name in rungs},
        "tools": dict(sorted(tools.items())),
    }
    write_text(path, _json(document))
    return path


def _json(document: Mapping[str, object]) -> str:
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"
