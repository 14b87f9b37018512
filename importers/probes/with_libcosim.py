"""libcosim's fixed-step algorithm with our SSP: it exchanges values between steps, for both models at once.

libcosimpy 0.0.6 cannot connect integer variables itself (it calls a function that its library does not have), so the
connections come from the SSP.
"""

from __future__ import annotations

import json
import sys
import zipfile
from pathlib import Path
from typing import Any

import fmpy
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave
from report import STEP_S, stage, write_trace


def main(job: dict[str, Any]) -> None:
    step_ns = round(STEP_S * 1e9)
    with stage("load"):
        # Each FMU alone first: without an SSP (FMI 3) this is all that can be done.
        alone = CosimExecution.from_step_size(step_size=step_ns)
        alone.add_local_slave(CosimLocalSlave(fmu_path=job["testbed"], instance_name="testbed"))
        folder = Path(job["trace"]).with_suffix("")
        with zipfile.ZipFile(job["ssp"]) as archive:
            archive.extractall(folder)
        execution = CosimExecution.from_ssp_file(ssp_path=str(folder), step_size=step_ns)
        references = {v.name: v.valueReference for v in fmpy.read_model_description(job["testbed"]).modelVariables}
        recorded = [references[name] for name in job["recorded"]]
        observer = CosimObserver.create_last_value()
        execution.add_observer(observer=observer)
        testbed = execution.slave_index_from_instance_name("testbed")
    rows = []

    def row(k: int) -> None:
        rows.append([k * STEP_S, *observer.last_real_values(testbed, recorded)])

    # It initialises with its first step.
    for name, steps in (("initialise", 1), ("step", 1), ("closed loop", job["steps"] - 2)):
        with stage(name):
            for _ in range(steps):
                if not execution.step():
                    raise RuntimeError(f"step {len(rows)} failed: {execution.status()}")
                row(len(rows) + 1)
            if name == "closed loop":
                write_trace(job["trace"], job["recorded"], rows)


if __name__ == "__main__":
    main(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
