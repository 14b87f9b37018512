"""Runs every probe on every kind of FMU, each in its own process, and judges the result."""

from __future__ import annotations

import json
import os
import signal
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["COLUMNS", "IMPORTERS", "Cell", "Importer", "run_cell", "write_reference"]

STAGES = ("load", "initialise", "step", "closed loop")
COLUMNS = ((2, "CS"), (2, "ME"), (3, "CS"), (3, "ME"))
RECORDED = ("truth.x", "truth.slider_position", "truth.contact_force", "truth.wheel_torque[1]", "energy.dissipated")
STEPS, STEP_S = 600, 1e-3
TIMEOUT_S = 180.0
PARAMETERS = {"testbed.bumper.kind": 2}
# Co-Simulation has to give the bits of our own run. In Model Exchange the probe integrates with fixed steps of 50 us
# and handles an event after the step that contains it: this method deviates by 5e-4 here.
TOLERANCES = {"CS": 0.0, "ME": 2e-3}


@dataclass(frozen=True)
class Importer:
    """One importer.

    Attributes:
        name: as the table shows it, with its version.
        probe: file below probes/.
        parallel: it exchanges the values of both models at once, so one cycle of command delay is removed from the
            testbed.
        cannot: reasons by (FMI version, interface) why it cannot; all others have to work.
        crashes: the same for combinations that are run and have to fail.
    """

    name: str
    probe: str
    parallel: bool
    cannot: dict[tuple[int, str], str]
    crashes: dict[tuple[int, str], str]


_NO_EXCHANGE = {(2, "ME"): "Co-Simulation only", (3, "ME"): "Co-Simulation only"}
IMPORTERS = (
    Importer("FMPy 0.3.32", "with_fmpy.py", False, {}, {}),
    Importer("fmuloader 0.1.2rc0", "with_fmuloader.py", False, {}, {}),
    Importer("ecos (ecospy 0.7.2)", "with_ecos.py", True, _NO_EXCHANGE, {}),
    Importer(
        "libcosim (libcosimpy 0.0.6), from our SSP", "with_libcosim.py", True, _NO_EXCHANGE, {(3, "CS"): "FMI 2 only"}
    ),
    Importer("fmu-manipulation-toolbox 2.0, container", "with_container.py", False, _NO_EXCHANGE, {}),
)


@dataclass(frozen=True)
class Cell:
    """One importer with one kind of FMU.

    Attributes:
        reached: the last stage that it completed, "" if none.
        deviation: of the closed loop from our own run, the largest of any signal relative to its peak; None if there is
            none.
        reason: why it stopped; "" if it completed all stages.
        met: whether it behaved as expected.
    """

    reached: str
    deviation: float | None
    reason: str
    met: bool

    @property
    def text(self) -> str:
        """Text for the table."""
        if self.deviation is not None and not self.reason:
            return "all; same bits" if self.deviation == 0.0 else f"all; within {self.deviation:.0e}"
        return f"to {self.reached}; {self.reason}" if self.reached else f"no: {self.reason}"


def write_reference(path: Path) -> None:
    """A run with our own master, in the format of the probes."""
    import dataclasses

    from giveway import experiments
    from giveway.simulation.master import simulate

    scenario = experiments.get("motionless").scenario("magnetic")
    record = simulate(dataclasses.replace(scenario, duration_s=STEPS * STEP_S, controller={}))
    # The parameters that the probes set; the slider is present by default.
    assert dict(scenario.parameters("testbed")) == {"slider.present": True, "bumper.kind": 2}
    columns = [record.time_s, *(record.traces[f"testbed.{name}"] for name in RECORDED)]
    np.save(path, np.column_stack(columns))


def _job(importer: Importer, version: int, interface: str, fmus: Path, work: Path) -> dict[str, Any]:
    parameters = dict(PARAMETERS)
    if importer.parallel:
        parameters["testbed.electronics.command_delay"] = 0
    return {
        "version": version,
        "interface": interface,
        "steps": STEPS,
        "recorded": RECORDED,
        "parameters": parameters,
        "controller": str(fmus / f"giveway_controller_fmi{version}.fmu"),
        "testbed": str(fmus / f"giveway_testbed_fmi{version}.fmu"),
        "ssp": str(fmus / "giveway.ssp"),
        "trace": str(work / f"{Path(importer.probe).stem}_{version}{interface}.csv"),
    }


def environment(python: Path) -> dict[str, str]:
    """The environment in which ecos finds the threading library of the importers' packages."""
    return {**os.environ, "LD_LIBRARY_PATH": str(python.parents[1] / "lib"), "PYTHONDONTWRITEBYTECODE": "1"}


def run_cell(importer: Importer, version: int, interface: str, python: Path, fmus: Path, work: Path) -> Cell:
    """Run one probe with the importers' ``python``; a crash or a time-out is a cell, too."""
    kind = (version, interface)
    if kind in importer.cannot:
        return Cell("", None, importer.cannot[kind], True)
    job = _job(importer, version, interface, fmus, work)
    trace = Path(job["trace"])
    trace.unlink(missing_ok=True)
    file = trace.with_suffix(".json")
    file.write_text(json.dumps(job), encoding="utf-8")
    probe = Path(__file__).parent / "probes" / importer.probe
    try:
        done = subprocess.run(
            [python, probe, file],
            capture_output=True, text=True, check=False, timeout=TIMEOUT_S, env=environment(python), cwd=work,
        )  # fmt: skip
        output, code = done.stdout, done.returncode
        trace.with_suffix(".log").write_text(done.stdout + done.stderr, encoding="utf-8")
    except subprocess.TimeoutExpired as error:
        output = (error.stdout or b"").decode() if isinstance(error.stdout, bytes) else (error.stdout or "")
        code = None
    reached, reason = _stages(output, code)
    deviation = None
    if not reason:
        deviation = _deviation(trace, np.load(work / "reference.npy"))
        if deviation > TOLERANCES[interface]:
            reason = f"deviates by {deviation:.1e}"
    if kind in importer.crashes:
        return Cell(reached, deviation, f"{importer.crashes[kind]} ({reason})", bool(reason))
    return Cell(reached, deviation, reason, not reason)


def _stages(output: str, code: int | None) -> tuple[str, str]:
    """The last completed stage, and why there is no later one."""
    reached = ""
    for line in output.splitlines():
        if not line.startswith('{"stage"'):
            continue
        said = json.loads(line)
        if "failed" in said:
            return reached, said["failed"]
        if said["stage"] in STAGES:
            reached = said["stage"]
    if code is None:
        return reached, f"no end within {TIMEOUT_S:g} s"
    if code < 0:
        return reached, f"crash: {signal.Signals(-code).name}"
    if reached != STAGES[-1]:
        return reached, f"ended with exit code {code}"
    return reached, ""


def _deviation(trace: Path, reference: NDArray[np.float64]) -> float:
    """Largest deviation of any signal relative to its peak; rows are matched by time."""
    lines = trace.read_text(encoding="utf-8").split()[1:]
    rows = np.array([[float.fromhex(cell) for cell in line.split(",")] for line in lines])
    wanted = reference[np.rint(rows[:, 0] / STEP_S).astype(int)]
    if len(rows) < STEPS or not np.isfinite(rows).all():
        return float("inf")
    return float((np.abs(rows[:, 1:] - wanted[:, 1:]).max(axis=0) / np.abs(reference[:, 1:]).max(axis=0)).max())
