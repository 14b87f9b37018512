"""Climbs the ladder: two rungs at a time, one line per rung as it ends, results as JSON."""

from __future__ import annotations

import json
import shutil
import time
import traceback
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from giveway.base.files import write_text

from verify.context import Context, Tool, kill_all
from verify.rung import Figure, Rung, RungFailed
from verify.sources import core_hash, subject_hash

__all__ = ["Outcome", "climb", "hashes", "standing", "verified", "write_summary"]

SCHEMA_VERSION = 2
VERIFIED = Path("c_core/VERIFIED.json")
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
    """Run the rungs; print a line for each as it ends, and its evidence if it failed."""
    outcomes = []
    with ThreadPoolExecutor(AT_A_TIME) as pool:
        running: list[Future[Outcome]] = [pool.submit(_run, root, name, rung, path) for name, rung in rungs.items()]
        try:
            for future in as_completed(running):
                outcome = future.result()
                print(outcome.line, flush=True)
                if outcome.figure is None:
                    print(f"\n{outcome.name} failed:\n{outcome.evidence}", flush=True)
                outcomes.append(outcome)
        except BaseException:
            for future in running:
                future.cancel()
            kill_all()
            raise
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


def write_summary(root: Path, outcomes: list[Outcome], seconds: float) -> Path:
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
        "c_core_sha256": core_hash(root),
        "seconds": round(seconds, 1),
        "rungs": rungs,
    }
    write_text(path, _json(document))
    return path


def hashes(root: Path, rungs: Mapping[str, Rung]) -> dict[str, str]:
    """Of the sources that each rung is about."""
    return {name: subject_hash(root, rung.subject) for name, rung in rungs.items()}


def verified(root: Path, outcomes: list[Outcome], rungs: Mapping[str, Rung], before: Mapping[str, str]) -> Path:
    """c_core/VERIFIED.json: the figures of every rung, with the hash of what it is about. `make test` holds it current.

    Results of other rungs stay if they are about the same sources as now, so that a rung can be climbed alone; a rung
    that failed is removed. ``rungs``: all of them; ``before``: their `hashes` when the climb began.
    """
    now = hashes(root, rungs)
    if changed := [outcome.name for outcome in outcomes if now[outcome.name] != before[outcome.name]]:
        raise RungFailed(f"sources changed while they were being verified, climb again: {', '.join(changed)}")
    stored = _stored(root)
    failed = {outcome.name for outcome in outcomes if outcome.figure is None}
    found = {name: stored["rungs"][name] for name in _standing(stored, now) if name not in failed} | {
        outcome.name: {
            "figure": outcome.figure.text,
            "values": dict(outcome.figure.values),
            "sources_sha256": now[outcome.name],
        }
        for outcome in outcomes
        if outcome.figure is not None
    }
    tools = stored["tools"] | {name: version for outcome in outcomes for name, version in outcome.versions.items()}
    document = {
        "schema_version": SCHEMA_VERSION,
        "c_core_sha256": core_hash(root),
        "rungs": {name: found[name] for name in rungs if name in found},
        "tools": dict(sorted(tools.items())),
    }
    path = root / VERIFIED
    write_text(path, _json(document))
    return path


def standing(root: Path, rungs: Mapping[str, Rung]) -> list[str]:
    """The rungs whose results in c_core/VERIFIED.json are about the sources as they are now."""
    return _standing(_stored(root), hashes(root, rungs))


def _standing(stored: Mapping[str, Any], now: Mapping[str, str]) -> list[str]:
    return [name for name, result in stored["rungs"].items() if result["sources_sha256"] == now.get(name)]


def _stored(root: Path) -> dict[str, Any]:
    path = root / VERIFIED
    document: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    return document if document.get("schema_version") == SCHEMA_VERSION else {"rungs": {}, "tools": {}}


def _json(document: Mapping[str, object]) -> str:
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"
