"""`python -m verify.second_simulator`: the formulas, then the table. The last line is JSON; progress goes to stderr.

Run it from the repository with build/verify/tools/bin/second-simulator-python.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "cosim")]

from giveway.robot.robot_file import read_robot  # noqa: E402
from giveway.robot.variables import parse_assignments, table  # noqa: E402

from verify.second_simulator import closed_form  # noqa: E402
from verify.second_simulator.electronics import compile_drives  # noqa: E402
from verify.second_simulator.faults import FAULTS  # noqa: E402
from verify.second_simulator.loop import simulate  # noqa: E402
from verify.second_simulator.mjcf import FRICTION, SecondRobot, build  # noqa: E402
from verify.second_simulator.situations import Case, cases  # noqa: E402
from verify.second_simulator.table import judged_record, markdown  # noqa: E402

STEP_S = 0.25e-3
BUILT = ROOT / "build" / "verify" / "second_simulator_drives"


def main(words: Sequence[str] | None = None) -> int:
    asked = _arguments(words)
    settings = parse_assignments(asked.set)
    testbed, controller = _parameters(asked.robot, settings.get("testbed", {})), settings.get("controller", {})
    if asked.robot is not None:
        controller = {**table("controller").robot_values(read_robot(asked.robot)), **controller}
    drives = compile_drives(BUILT)
    if asked.xml:
        asked.xml.write_text(build(testbed, "magnetic", asked.step).xml, encoding="utf-8")
    findings = []
    if not asked.no_formulas:
        findings = closed_form.check_all(testbed, drives, asked.step, asked.fault)
        for finding in findings:
            print(finding.line(), flush=True)
    chosen = [] if asked.formulas_only else cases(testbed, controller, asked.seed, asked.quick)
    chosen = [case for case in chosen if asked.only in case.name]
    if asked.exchanged:
        chosen = [replace(case, run=replace(case.run, wiring=(1, 0, 2))) for case in chosen]
    records = _run_all(chosen, testbed, controller, drives, asked)
    if records:
        print(markdown(records, bool(controller.get("imu.use", 0))))
    document = {
        "step_s": asked.step,
        "seed": asked.seed,
        "formulas": {one.name: [one.found, one.expected, one.share, one.holds] for one in findings},
        "records": records,
    }
    if asked.out:
        asked.out.parent.mkdir(parents=True, exist_ok=True)
        asked.out.write_text(json.dumps(document) + "\n", encoding="utf-8")
    wrong = [one.name for one in findings if not one.holds]
    print(json.dumps({"wrong": wrong, "runs": len(records)}))
    return 1 if wrong else 0


def _arguments(words: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m verify.second_simulator", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="some cases of every kind")
    parser.add_argument("--set", action="append", default=[], metavar="MODEL.NAME=VALUE", help="as of `giveway run`")
    parser.add_argument("--robot", type=Path, help="robot file; default: that of the FMUs")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--step", type=float, default=STEP_S, help="of MuJoCo, s; divides 0.5 ms")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--only", default="", help="cases whose name contains this")
    parser.add_argument("--formulas-only", action="store_true")
    parser.add_argument("--no-formulas", action="store_true")
    parser.add_argument("--fault", choices=FAULTS, help="plant it before the formulas are checked")
    parser.add_argument("--exchanged", action="store_true", help="plant a fault: two torque sensors are exchanged")
    parser.add_argument("--out", type=Path, help="JSON file with a record per run")
    parser.add_argument("--traces", type=Path, help="folder for the traces of every run, .npz")
    parser.add_argument("--friction", choices=FRICTION, default=FRICTION[0], help="of the rollers: see mjcf.py")
    parser.add_argument("--xml", type=Path, help="where to write the model, for MuJoCo's viewer")
    return parser.parse_args(words)


def _parameters(robot: Path | None, overrides: Mapping[str, Any]) -> dict[str, Any]:
    variables = table("testbed")
    values: dict[str, Any] = {one.name: one.start for one in variables.select("parameter")}
    if robot is not None:
        values |= variables.robot_values(read_robot(robot))
    return values | dict(overrides)


def _run_all(
    chosen: Sequence[Case],
    testbed: Mapping[str, Any],
    controller: Mapping[str, Any],
    drives: Path,
    asked: argparse.Namespace,
) -> list[dict[str, Any]]:
    started = time.monotonic()
    work = [(number, case, testbed, controller, drives, asked) for number, case in enumerate(chosen)]
    records = []
    with ProcessPoolExecutor(asked.jobs) as pool:
        for record in pool.map(_run_one, work) if asked.jobs > 1 else map(_run_one, work):
            records.append(record)
            detections = ", ".join(f"{at:.3f}" for at in record["judged"]["detections_s"])
            elapsed = time.monotonic() - started
            print(
                f"{len(records)}/{len(work)} {elapsed:.0f} s: {record['name']}: {detections}",
                file=sys.stderr,
                flush=True,
            )
    return records


_models: dict[tuple[str, float], SecondRobot] = {}


def _run_one(work: tuple[Any, ...]) -> dict[str, Any]:
    number, case, testbed, controller, drives, asked = work
    key = case.bumper, asked.step
    folder = asked.traces
    if key not in _models:
        _models[key] = build(testbed, case.bumper, asked.step, asked.friction)
    traces = simulate(_models[key], drives, case.run)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        name = case.name.translate({ord(" "): "_", ord("/"): "_per_", ord(","): None})
        np.savez_compressed(folder / f"{number:03d}_{name}.npz", **dict[str, Any](traces))
    record: dict[str, Any] = case.record(number, judged_record(traces, testbed, controller))
    record["peak_n"] = float(traces["testbed.truth.contact_force"].max())
    return record


if __name__ == "__main__":
    sys.exit(main())
