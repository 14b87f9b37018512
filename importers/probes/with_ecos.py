"""ecos: both FMUs and their connections, stepped together.

It exchanges values before each step, for both models at once (Jacobi): a command reaches the testbed one cycle later
than in our order. With a command delay of zero instead of one cycle in the testbed it is the same loop.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

from ecospy import EcosSimulation, EcosSimulationStructure
from ecospy.lib import EcosLib
from raw_loop import BOOLEANS, INTEGERS, REALS
from report import STEP_S, stage, write_trace


def structure_of(job: dict[str, Any], connected: bool = True) -> Any:
    structure = EcosSimulationStructure()
    structure.add_model("controller", job["controller"])
    structure.add_model("testbed", job["testbed"])
    if connected:
        for what, source, sink in (("sensors", "testbed", "controller"), ("commands", "controller", "testbed")):
            for name in REALS[what]:
                structure.make_real_connection(f"{source}::{name}", f"{sink}::{name}")
            for name in INTEGERS[what]:
                structure.make_int_connection(f"{source}::{name}", f"{sink}::{name}")
            for name in BOOLEANS[what]:
                structure.make_bool_connection(f"{source}::{name}", f"{sink}::{name}")
    values = {name.replace(".", "::", 1): int(value) for name, value in job["parameters"].items()}
    structure.add_parameter_set("initial", values)
    return structure


def main(job: dict[str, Any]) -> None:
    with stage("load"):
        structure = structure_of(job)
        simulation = EcosSimulation(step_size=STEP_S, structure=structure)
    with stage("initialise"):
        if not simulation.init(parameter_set="initial"):
            raise RuntimeError(EcosLib.get_last_error())
    names = [f"testbed::{name}" for name in job["recorded"]]

    def row(k: int) -> list[float]:
        return [k * STEP_S, *(simulation.get_real(name) for name in names)]

    rows = [row(0)]
    with stage("step"):
        simulation.step(1)
        rows.append(row(1))
    with stage("closed loop"):
        for k in range(2, job["steps"] + 1):
            simulation.step(1)
            rows.append(row(k))
        write_trace(job["trace"], job["recorded"], rows)
    with stage("speed") as facts:
        facts["seconds"] = [timed(job) for _ in range(job.get("repeats", 0))]
    simulation.terminate()
    simulation.free()


def timed(job: dict[str, Any]) -> float:
    """Wall time of one run, from instances to their end, as the other masters are timed."""
    with structure_of(job) as structure, EcosSimulation(step_size=STEP_S, structure=structure) as simulation:
        started = time.perf_counter()
        simulation.init(parameter_set="initial")
        simulation.step(job["steps"])
        simulation.terminate()
        return time.perf_counter() - started


if __name__ == "__main__":
    main(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
