"""`python -m importers.bench`: coupled runs per second of the C master, ecos and our FMPy loop; for `make bench`."""

from __future__ import annotations

import argparse
import dataclasses
import json
import re
import subprocess
import sys
import time
from pathlib import Path

from giveway import experiments
from giveway.base import native
from giveway.base.terminal import print_columns
from giveway.simulation.fmu import open_fmu
from giveway.simulation.master import simulate

from importers.matrix import environment

ROOT = Path(__file__).parents[1]
STEPS = 1000
PARAMETERS = {"testbed.bumper.kind": 2, "controller.supervisor.after_settled": 0}
TARGETS = {"C master": "100 runs/s (goal 150)", "testbed": "8 ms (goal 5)", "controller": "1 ms"}


def c_master(program: Path, repeats: int) -> dict[str, float]:
    """Best times in ms: "run", "controller" and "testbed" (time inside the FMUs' steps, from separate runs)."""
    folders = [open_fmu(native.fmu(model, 3)).folder for model in native.MODELS]
    words = [f"{name}={value}" for name, value in PARAMETERS.items()]
    found: dict[str, float] = {}
    for options in ([], ["--profile"]):
        command: list[str | Path] = [program, *folders, "--repeat", str(repeats), *options, *words]
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        numbers = [float(number) for number in re.findall(r"([\d.]+) ms (?:for|in)", said)]
        if options:
            found["controller"] = numbers[1]
            found["testbed"] = float(re.findall(r"steps, ([\d.]+) ms", said)[0])
        else:
            found["run"] = numbers[0]
    return found


def fmpy_loop(repeats: int) -> float:
    """Best time of a whole run with our own master, ms."""
    scenario = dataclasses.replace(experiments.get("motionless").scenario("magnetic"), duration_s=1e-3 * STEPS)
    simulate(scenario)
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        simulate(scenario)
        times.append(time.perf_counter() - started)
    return 1e3 * min(times)


def ecos(python: Path, version: int, repeats: int) -> float:
    """Best time of a run in ecos, from its initialisation to its end, ms."""
    work = ROOT / "build/importers/work"
    work.mkdir(parents=True, exist_ok=True)
    job = {
        "controller": str(native.fmu("controller", version)),
        "testbed": str(native.fmu("testbed", version)),
        "steps": STEPS, "recorded": ["truth.x"], "repeats": repeats, "trace": str(work / "bench.csv"),
        "parameters": {**PARAMETERS, "testbed.electronics.command_delay": 0},
    }  # fmt: skip
    file = work / "bench.json"
    file.write_text(json.dumps(job), encoding="utf-8")
    probe = ROOT / "importers/probes/with_ecos.py"
    done = subprocess.run(
        [python.absolute(), probe, file], check=True, capture_output=True, text=True, env=environment(python.absolute())
    )
    (line,) = (line for line in done.stdout.splitlines() if '"speed"' in line)
    seconds: list[float] = json.loads(line)["seconds"]
    return 1e3 * min(seconds)


def main() -> int:
    parser = argparse.ArgumentParser(prog="importers.bench")
    parser.add_argument("--repeats", type=int, default=20)
    parser.add_argument("--python", type=Path, default=ROOT / "build/importers/tools/bin/python")
    parser.add_argument("--c-master", type=Path, default=ROOT / "build/examples/c_master/c_master")
    options = parser.parse_args()
    inside = c_master(options.c_master, options.repeats)
    times = {
        "C master (examples/c_master), FMI 3": inside["run"],
        "ecos, FMI 3": ecos(options.python, 3, options.repeats),
        "ecos, FMI 2": ecos(options.python, 2, options.repeats),
        "our master over FMPy, FMI 3": fmpy_loop(options.repeats),
    }
    rows = [
        (name, f"{ms:.2f}", f"{1e3 / ms:.1f}", TARGETS["C master"] if "C m" in name else "")
        for name, ms in times.items()
    ]
    title = f"Coupled runs of 1 s of collision at 1 ms on one core, best of {options.repeats}"
    print_columns(title, ("master", "ms", "runs/s", "target"), rows)
    parts = [(f"{model} FMU", f"{inside[model]:.2f}", TARGETS[model]) for model in ("testbed", "controller")]
    print_columns("Inside the FMUs' steps, 1 s of that, called from C", ("", "ms", "target"), parts)
    return 0


if __name__ == "__main__":
    sys.exit(main())
