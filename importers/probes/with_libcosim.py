"""libcosim (FMI 2 only), its fixed-step algorithm: as ecos, it exchanges between steps, both models at once."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave
from raw_loop import BOOLEANS, INTEGERS, REALS
from report import STEP_S, stage, write_trace


def main(job: dict[str, Any]) -> None:
    import fmpy

    with stage("load"):
        models = {
            model: {v.name: v.valueReference for v in fmpy.read_model_description(job[model]).modelVariables}
            for model in ("controller", "testbed")
        }
        execution = CosimExecution.from_step_size(step_size=round(STEP_S * 1e9))
        slaves = {
            model: execution.add_local_slave(CosimLocalSlave(fmu_path=job[model], instance_name=model))
            for model in models
        }
        observer = CosimObserver.create_last_value()
        if not execution.add_observer(observer=observer):
            raise RuntimeError("the observer was refused")
    with stage("initialise"):
        for name, value in job["parameters"].items():
            model, _, variable = name.partition(".")
            if not execution.integer_initial_value(slaves[model], models[model][variable], int(value)):
                raise RuntimeError(f"{name} was refused")
        manipulator = CosimManipulator.create_override()
        execution.add_manipulator(manipulator=manipulator)
        for what, source, sink in (("sensors", "testbed", "controller"), ("commands", "controller", "testbed")):
            for names, connect in (
                (REALS, execution.connect_real_variables),
                (INTEGERS, execution.connect_integer_variables),
                (BOOLEANS, execution.connect_boolean_variables),
            ):
                for name in names[what]:
                    if connect(slaves[source], models[source][name], slaves[sink], models[sink][name]):
                        raise RuntimeError(f"{name} could not be connected")
    recorded = [models["testbed"][name] for name in job["recorded"]]
    rows = []
    with stage("step"):
        if not execution.step():
            raise RuntimeError(f"the first step failed: {execution.status().error_code}")
        rows.append([STEP_S, *observer.last_real_values(slaves["testbed"], recorded)])
    with stage("closed loop"):
        for k in range(2, job["steps"] + 1):
            if not execution.step():
                raise RuntimeError(f"step {k} failed")
            rows.append([k * STEP_S, *observer.last_real_values(slaves["testbed"], recorded)])
        write_trace(job["trace"], job["recorded"], rows)


if __name__ == "__main__":
    main(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
