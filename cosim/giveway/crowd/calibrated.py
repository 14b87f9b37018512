"""What `giveway calibrate` finds for each robot of the crowd: the real identification, on simulated logs of its arcs.

The logs are those of the experiment `roller_calibration`, driven by the robot as it is, its zero errors and noise
included; the identification believes the robot file, as the controller does. A robot whose logs are refused keeps the
file's numbers.
"""

from __future__ import annotations

import dataclasses
import functools
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any

from giveway import batch
from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.crowd.crowd import robot_asked
from giveway.crowd.parts import Interrupted, Record, Work
from giveway.crowd.population import DRAWS, robot
from giveway.experiments.roller_calibration import ARCS, RECORDED, arc_scenario, log_of
from giveway.robot.robot_file import read_robot
from giveway.scenario.arcs import REST_S, WheelArc

if TYPE_CHECKING:
    from pathlib import Path

    from giveway.robot.variables import Value
    from giveway.scenario.scenario import Scenario

__all__ = ["beliefs", "calibrations", "compute", "refuse_current"]

PART = 8
# Rollers that differ leave residuals of a whole swing, and `giveway calibrate` asks for many of these; zeros that drift
# forbid long logs. So the swings are shorter than the experiment's.
PERIODS, FREQUENCY_HZ = 12, 0.2
LOG_EVERY = 10  # ticks: 100 Hz
ROLLERS = "bristle rollers"
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}  # small matrices: more threads only wait


def refuse_current(file: Path | None) -> None:
    """Refuse robots by motor current: their logs cannot say what is the rollers' friction."""
    if file is not None and read_robot(file).motor_current:
        raise GivewayError(
            "--calibrated",
            file,
            "robots with torque sensors: by motor current the gears' friction, several times the rollers', is in the "
            "logs, and the fit would take it for theirs",
        )


def calibrations(draw: str, robots: int, file: Path | None = None) -> Work:
    """The work of calibrating the first ``robots`` robots of ``draw``, which differ from the robot file ``file``."""
    refuse_current(file)
    asked: dict[str, Any] = {"draw": draw, "seed": DRAWS[draw]}
    if file is not None:
        asked["robot"] = robot_asked(file)
    code = ("population.py", "../robot/population.py", "calibrated.py", "parts.py")
    name = f"calibration, {draw} draw" + ("" if file is None else f", {file.stem}")

    def run(numbers: Sequence[int], threads: int, progress: Callable[[int], None]) -> list[Record]:
        return compute(draw, numbers, threads, progress, file)

    return Work(name, asked, robots, PART, run, code)


def beliefs(records: Sequence[Record]) -> dict[int, dict[str, Value]]:
    """By robot: what its controller believes after the calibration."""
    return {record["number"]: record["controller"] for record in records}


def compute(
    draw: str, numbers: Sequence[int], threads: int, progress: Callable[[int], None], file: Path | None = None
) -> list[Record]:
    """Calibrate the robots ``numbers`` in ``threads`` processes."""
    refuse_current(file)
    scenarios = [_arc(draw, number, arc, file) for number in numbers for arc in ARCS]
    table = batch.Prepared(scenarios, traces=RECORDED).run(threads=threads, method="fixed-step")
    if table.attrs["interrupted"]:
        raise Interrupted
    columns = {name: table[name].values[:, ::LOG_EVERY] for name in RECORDED}
    jobs = []
    for index in range(len(numbers)):
        runs = range(len(ARCS) * index, len(ARCS) * (index + 1))
        failed = [str(table["message"].values[run]) for run in runs if table["status"].values[run] != "ok"]
        jobs.append((failed, [{name: values[run] for name, values in columns.items()} for run in runs]))
    found = []
    identify = functools.partial(_identify, file or native.robot())
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(ONE_THREAD)
    try:
        with ProcessPoolExecutor(threads, mp_context=get_context("spawn")) as pool:
            for number, result in zip(numbers, pool.map(identify, jobs), strict=True):
                found.append({"number": number, **result})
                progress(len(found))
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})
    return found


def _arc(draw: str, number: int, arc: str, file: Path | None) -> Scenario:
    whose = robot(draw, number, file=file)
    scenario = arc_scenario(arc, ROLLERS, read_robot(file or native.robot()), seed=1 + number)
    # The wheels stay on the floor: a log of a base that tips is the same, and takes longer.
    own = {name: value for name, value in whose.testbed.items() if name != "base.tipping"}
    assert isinstance(scenario.plan, WheelArc)
    longer_s, quicker = REST_S + PERIODS / FREQUENCY_HZ, dataclasses.replace(scenario.plan, frequency_hz=FREQUENCY_HZ)
    settings = {**scenario.testbed, **own}
    return dataclasses.replace(scenario, duration_s=longer_s, plan=quicker, testbed=settings, robot=file)


def _identify(whose: Path, job: tuple[list[str], list[Mapping[str, Any]]]) -> dict[str, Any]:
    """Fit one robot's logs, in a process of its own."""
    import numpy as np
    import xarray

    from giveway.identification.roller_friction import calibrate

    failed, runs = job
    if failed:
        return {"controller": {}, "message": failed[0]}
    file = read_robot(whose)
    names = list(runs[0])
    rows = len(runs[0][names[0]])
    table = xarray.Dataset(
        {name: (("run", "time"), np.stack([run[name] for run in runs])) for name in names},
        coords={"time": np.arange(rows) * 1e-3 * LOG_EVERY},
    )
    try:
        fit = calibrate([log_of(arc, table, run, file) for run, arc in enumerate(ARCS)], file)
    except GivewayError as error:
        return {"controller": {}, "message": str(error)}
    values = {
        "friction.coulomb_torque": fit.coulomb_torque_nm.value,
        "friction.tanh_slope": fit.tanh_slope_s_rad.value,
    }
    return {"controller": values, "message": ""}
