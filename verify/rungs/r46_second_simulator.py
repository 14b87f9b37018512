"""The controller FMU on a robot of another simulator (MuJoCo), every roller a body: formulas hold, hits are noticed,
and nothing is while nobody touches it."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

from verify.context import Context, Tool
from verify.rung import Figure, Rung, RungFailed, planted
from verify.second_simulator.faults import FAULTS

PYTHON = Tool("second-simulator-python", package="build/verify/second-simulator-installed")
CC, CXX = Tool("gcc"), Tool("g++")
ONE_HIT = "rest, side 0 +0 cm"  # with each bumper
ONE_START = "start and stop, +60 deg"
TOUCHY = ("--set", "controller.channels.noise_multiple=2", "--set", "controller.channels.fast_creep=2")
UNEVEN = ("--friction", "each")
STEP_S = 0.25e-3
# Halving the step may move a detection by a tick of the controller and the noise that it sees then, and the peak by
# what a method of first order does; the magnet lets go within a few steps.
DELAY_MS, PEAK_SHARE = 2.0, {"none": 0.01, "spring": 0.01, "magnetic": 0.05}
LATEST_MS = 30.0  # of a hit at rest: found within 7 to 16 ms
WRONG_DEG = 30.0


def check(context: Context) -> Figure:
    formulas = _formulas(context)
    for number, (fault, (_, finding, _)) in enumerate(FAULTS.items()):
        with planted(fault, shows=rf"{re.escape(finding)}.*WRONG"):
            _formulas(context, f"fault{number}", "--fault", fault)
    coarse, fine = (
        _records(context, f"step{number}", "--only", ONE_HIT, "--step", str(step))
        for number, step in enumerate((STEP_S, 0.5 * STEP_S))
    )
    _converged(coarse, fine)
    _noticed(coarse)
    with planted("two torque sensors exchanged", shows="deg wrong"):
        _noticed(_records(context, "exchanged", "--only", ONE_HIT, "--exchanged"))
    records = _records(context, "table", "--quick")
    _noticed(records)
    seconds = _nothing_found(records)
    with planted("thresholds that are too low", shows="nobody touched it"):
        _nothing_found(_records(context, "touchy", "--quick", "--only", ONE_START, *TOUCHY))
    uneven = _uneven(context)
    hits = [record for record in records if record["kind"] == "free"]
    again = sum(bool(record["judged"]["false_s"]) for record in hits)
    return Figure(
        f"{formulas} formulas hold, step halved; {_at_rest(records)} hits at rest all noticed; "
        f"no alarm in {seconds:.0f} s untouched; {len(FAULTS) + 2} planted faults seen",
        {
            "formulas": formulas,
            "hits_at_rest": _at_rest(records),
            "untouched_s": round(seconds),
            "faults": len(FAULTS) + 2,
        },
        varies=f"{again} of {len(hits)} runs with hits have a detection without contact; {uneven}",
    )


def _uneven(context: Context) -> str:
    """Rollers that have all of their friction each: every hit at rest is noticed, and what the detector does about
    ripple spares half of the detections without contact at least."""
    expected = _records(context, "uneven", "--quick", *UNEVEN)
    ignored = _records(context, "ignored", "--quick", *UNEVEN, "--set", "controller.channels.ripple=0")
    _noticed(expected)
    found, without = (sum(len(record["judged"]["false_s"]) for record in records) for records in (expected, ignored))
    if 2 * found > without:
        raise RungFailed(f"uneven rollers: {found} detections without contact; not expected they make {without}")
    return f"uneven rollers make {found} such detections; not expected they make {without}"


def _formulas(context: Context, name: str = "formulas", *options: str) -> int:
    """How many formulas hold; `RungFailed` if one does not."""
    out = _run(context, name, "--formulas-only", *options)
    return len(out["formulas"])


def _records(context: Context, name: str, *options: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = _run(context, name, "--no-formulas", *options)["records"]
    return found


def _run(context: Context, name: str, *options: str) -> dict[str, Any]:
    out = context.work / f"{name}.json"
    answer = context.run(
        context.which(PYTHON),
        "-m",
        "verify.second_simulator",
        "--out",
        out,
        *options,
        cwd=context.root,
        timeout_s=1200.0,
        memory_gib=None,
    )
    (context.work / f"{name}.txt").write_text(answer.stdout)
    document: dict[str, Any] = json.loads(Path(out).read_text())
    return document


def _is_at_rest(record: dict[str, Any]) -> bool:
    return bool(record["situation"] == "rest" and record["kind"] == "free")


def _at_rest(records: list[dict[str, Any]]) -> int:
    return sum(_is_at_rest(record) for record in records)


def _first(record: dict[str, Any]) -> dict[str, Any]:
    """The verdict on the hit itself."""
    contact: dict[str, Any] = record["judged"]["contacts"][0]
    return contact


def _converged(coarse: list[dict[str, Any]], fine: list[dict[str, Any]]) -> None:
    for one, other in zip(filter(_is_at_rest, coarse), filter(_is_at_rest, fine), strict=True):
        late = abs((_first(one)["delay_ms"] or math.inf) - (_first(other)["delay_ms"] or 0.0))
        higher = abs(one["peak_n"] / other["peak_n"] - 1.0)
        if late > DELAY_MS or higher > PEAK_SHARE[one["bumper"]]:
            found = f"{late:.1f} ms of {DELAY_MS}, {100.0 * higher:.2f} % of {100.0 * PEAK_SHARE[one['bumper']]} %"
            raise RungFailed(f"{one['name']}: half the step changes delay and peak by {found}")


def _noticed(records: list[dict[str, Any]]) -> None:
    """Every hit at rest is noticed, in time and from the side it comes from."""
    wrong = []
    for record in filter(_is_at_rest, records):
        hit = _first(record)
        if hit["verdict"] != "noticed" or hit["delay_ms"] > LATEST_MS:
            wrong.append(f"{record['name']}: {hit['verdict']} after {hit['delay_ms']} ms")
        elif hit["direction_deg"] > WRONG_DEG and record["name"].startswith(ONE_HIT):
            wrong.append(f"{record['name']}: direction {hit['direction_deg']:.0f} deg wrong")
    if wrong:
        raise RungFailed("\n".join(wrong))


def _nothing_found(records: list[dict[str, Any]]) -> float:
    """For how many seconds nobody touched the robot, and it found nothing."""
    quiet = [record for record in records if record["kind"] == "nothing"]
    wrong = [
        f"{record['name']}: found something after {record['judged']['detections_s']} s, nobody touched it"
        for record in quiet
        if record["judged"]["detections_s"]
    ]
    if wrong:
        raise RungFailed("\n".join(wrong))
    return sum(float(record["simulated_s"]) for record in quiet)


RUNG = Rung("the reflexes in MuJoCo", (PYTHON, CC, CXX), check)
