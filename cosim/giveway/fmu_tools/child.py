"""The process in which `giveway fmu run` runs an FMU: however it ends, the caller reads its results from files.

Started by `fmu_process` with a folder as its only argument. It reads FOLDER/job.json, updates FOLDER/status (simulated
time, and the present FMI call), and writes FOLDER/traces.npy and, last, FOLDER/result.json. Its printed output comes
from the FMU.
"""

from __future__ import annotations

import contextlib
import json
import mmap
import os
import struct
import sys
from pathlib import Path
from typing import Any

from giveway.simulation.fmi2_callbacks import fmi2_callbacks

__all__ = ["STATUS_BYTES", "main", "read_status"]

_STATUS = struct.Struct("<d120s")
STATUS_BYTES = _STATUS.size
_LOADING = "loading the library"
_UNLOADING = "unloading the library"
_LEAVING = "the library's own functions at the end of the process"


def read_status(content: bytes) -> tuple[float, str]:
    """Simulated time in s, and the FMI call in progress."""
    time_s, doing = _STATUS.unpack(content)
    return time_s, doing.rstrip(b"\0").decode("utf-8", "replace")


class _Status:
    """A memory-mapped file that survives any end of this process."""

    def __init__(self, path: Path, time_s: float) -> None:
        with path.open("r+b") as file:
            self._memory = mmap.mmap(file.fileno(), STATUS_BYTES)
        self.time_s = time_s
        self.set("starting")

    def set(self, doing: str) -> None:
        self._memory[:] = _STATUS.pack(self.time_s, doing.encode()[:120])


def main() -> None:
    with contextlib.suppress(ImportError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    folder = Path(sys.argv[1])
    job = json.loads((folder / "job.json").read_text(encoding="utf-8"))
    status = _Status(folder / "status", job["start_s"])
    try:
        _run(folder, job, status)
    except Exception as error:  # FMPy raises its own and plain Exceptions
        sys.stdout.flush()
        (folder / "result.json").write_text(json.dumps({"error": str(error)}), encoding="utf-8")
        os._exit(0)  # the instance is in an unknown state
    status.set(_LEAVING)


def _run(folder: Path, job: dict[str, Any], status: _Status) -> None:
    import fmpy
    import numpy as np
    from fmpy import fmi2, fmi3

    unpacked = folder / "fmu"
    description = fmpy.read_model_description(str(unpacked), validate=False)
    kind, is_fmi3 = job["interface"], str(description.fmiVersion).startswith("3")
    interface = description.coSimulation if kind == "CoSimulation" else description.modelExchange
    classes = {
        ("CoSimulation", False): fmi2.FMU2Slave,
        ("CoSimulation", True): fmi3.FMU3Slave,
        ("ModelExchange", False): fmi2.FMU2Model,
        ("ModelExchange", True): fmi3.FMU3Model,
    }
    status.set(_LOADING)
    fmu = classes[kind, is_fmi3](
        guid=description.guid, modelIdentifier=interface.modelIdentifier, unzipDirectory=str(unpacked)
    )
    _watch(fmu, status)
    if is_fmi3:
        fmu.instantiate(logMessage=_print_message)
    else:
        fmu.instantiate(callbacks=fmi2_callbacks(_log))

    def stepped(time_s: float, _recorder: object) -> bool:
        status.time_s = time_s
        return True

    traces = fmpy.simulate_fmu(
        str(unpacked), validate=False, start_time=job["start_s"], stop_time=job["stop_s"],
        output_interval=job["step_s"], fmi_type=kind, start_values=job["values"], output=job["output"],
        input=np.load(folder / "input.npy") if job["has_input"] else None, step_finished=stepped,
        model_description=description, fmu_instance=fmu,
    )  # fmt: skip
    with (folder / "traces.npy").open("wb") as file:
        np.save(file, np.asarray(traces), allow_pickle=False)
    (folder / "result.json").write_text(json.dumps({"error": None}), encoding="utf-8")
    # After this a crash loses no data.
    (fmu.fmi3FreeInstance if is_fmi3 else fmu.fmi2FreeInstance)(fmu.component)
    status.set(_UNLOADING)
    fmu.freeLibrary()


def _watch(fmu: Any, status: _Status) -> None:
    """Record the name of each FMI call before it: FMPy makes all calls through one method."""
    call = fmu._call

    def watched(name: str, *arguments: Any) -> Any:
        status.set(name)
        return call(name, *arguments)

    fmu._call = watched


def _print_message(_environment: object, _status: int, _category: bytes, text: bytes) -> None:
    print(text.decode("utf-8", "replace"), flush=True)


def _log(_environment: object, _instance: bytes, status: int, category: bytes, text: bytes) -> None:
    _print_message(None, status, category, text)
