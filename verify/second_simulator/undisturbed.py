"""`python -m verify.second_simulator.undisturbed FOLDER`: logs of this robot, driving, for `giveway tune`.

The drives are those of `giveway crowd endurance`, 30 s each; the controller does not react, as the log would end there.
A log that is in FOLDER already is taken as it is. `python -m verify.second_simulator.tuned FOLDER` judges.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "cosim")]

from giveway.crowd import endurance  # noqa: E402
from giveway.replay.run_log import write_log  # noqa: E402
from giveway.robot.presets import NO_REFLEX  # noqa: E402
from giveway.robot.variables import table  # noqa: E402

from verify.second_simulator.__main__ import BUILT, STEP_S  # noqa: E402
from verify.second_simulator.electronics import compile_drives  # noqa: E402
from verify.second_simulator.loop import TICK_S, Run, Traces, simulate  # noqa: E402
from verify.second_simulator.mjcf import FRICTION, build  # noqa: E402

DRAW, GROUP = "judging", "planar"  # of the plans; the robot is always the same
MINUTES = 12.0  # half of them to tune on: as `giveway bench --tune`
WHOLE = ("sensor.encoder", "sensor.counter", "sensor.imu_counter")


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m verify.second_simulator.undisturbed", description=__doc__)
    parser.add_argument("folder", type=Path, help="for the logs, CSV")
    parser.add_argument("--minutes", type=float, default=MINUTES)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--friction", choices=FRICTION, default=FRICTION[0], help="of the rollers: see mjcf.py")
    asked = parser.parse_args(words)
    asked.folder.mkdir(parents=True, exist_ok=True)
    compile_drives(BUILT)
    paths = [asked.folder / f"drive{number:03d}.csv" for number in range(round(60.0 * asked.minutes / endurance.RUN_S))]
    missing = [(number, path, asked.friction) for number, path in enumerate(paths) if not path.exists()]
    with ProcessPoolExecutor(asked.jobs) as pool:
        for done, _ in enumerate(pool.map(_drive, missing)):
            print(f"{done + 1}/{len(missing)} drives", file=sys.stderr, flush=True)
    return 0


def _drive(work: tuple[int, Path, str]) -> None:
    """Write the log of drive ``number``."""
    number, path, friction = work
    _, driven = endurance.drive(DRAW, GROUP, number * endurance.SHARED, {})
    run = Run(endurance.RUN_S, driven.plan, controller=NO_REFLEX, seed=number + 1)
    testbed = {one.name: one.start for one in table("testbed").select("parameter")}
    write_log(path, _as_result(simulate(build(testbed, "none", STEP_S, friction), BUILT / "drives.so", run)))


def _as_result(traces: Traces) -> Any:
    """What `write_log` reads of a run's result; counts are whole numbers again."""
    columns = {}
    for name, values in traces.items():
        quantity = name.partition(".")[2]
        columns[name] = SimpleNamespace(values=values.astype("int64") if quantity.startswith(WHOLE) else values)
    present = "testbed.sensor.imu_present"
    columns[present] = SimpleNamespace(values=traces[present].astype("bool"))
    manifest = {"parameters_set": {"controller": dict(NO_REFLEX)}, "scenario": {"step_s": TICK_S}}
    return SimpleNamespace(traces=columns, manifest=manifest)


if __name__ == "__main__":
    sys.exit(main())
