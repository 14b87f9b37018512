"""fmu-manipulation-toolbox: both FMUs packed into one container FMU, which FMPy then runs.

In sequential mode the container steps its FMUs one after the other and transfers outputs between container steps.
"""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from raw_loop import BOOLEANS, INTEGERS, REALS
from report import STEP_S, stage, write_trace
from with_fmpy import FmpyFmu


def links() -> list[list[str]]:
    found = []
    for what, source, sink in (("sensors", "testbed", "controller"), ("commands", "controller", "testbed")):
        for names in (REALS, INTEGERS, BOOLEANS):
            found += [[f"{source}.fmu", name, f"{sink}.fmu", name] for name in names[what]]
    return found


def main(job: dict[str, Any]) -> None:
    from fmu_manipulation_toolbox.assembly import Assembly

    folder = Path(tempfile.mkdtemp())
    with stage("load"):
        for model in ("controller", "testbed"):
            shutil.copy(job[model], folder / f"{model}.fmu")
        starts = [
            [f"{name.partition('.')[0]}.fmu", name.partition(".")[2], value]
            for name, value in job["parameters"].items()
        ]
        layout = {
            "name": "coupled.fmu", "mt": False, "profiling": False, "sequential": True, "auto_link": False,
            "auto_input": False, "auto_output": False, "auto_local": False, "step_size": STEP_S,
            "fmu": ["controller.fmu", "testbed.fmu"], "input": [], "link": links(), "start": starts, "drop": [],
            "output": [["testbed.fmu", name, name] for name in job["recorded"]],
        }  # fmt: skip
        (folder / "coupled.json").write_text(json.dumps(layout), encoding="utf-8")
        assembly = Assembly("coupled.json", fmu_directory=folder)
        assembly.make_fmu(fmi_version=job["version"])
        container = FmpyFmu(str(folder / "coupled.fmu"), job["version"])
        container.instantiate(False)
    with stage("initialise"):
        container.initialise()
    recorded = [container.references[name] for name in job["recorded"]]
    rows = [[0.0, *container.get("real", recorded)]]
    with stage("step"):
        container.step(0.0, STEP_S)
        rows.append([STEP_S, *container.get("real", recorded)])
    with stage("closed loop"):
        for k in range(1, job["steps"]):
            container.step(k * STEP_S, STEP_S)
            rows.append([(k + 1) * STEP_S, *container.get("real", recorded)])
        write_trace(job["trace"], job["recorded"], rows)
        container.finish()
    shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
