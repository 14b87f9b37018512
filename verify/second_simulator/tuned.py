"""`python -m verify.second_simulator.tuned FOLDER`: `giveway tune` on logs of the second simulator, judged on others.

The first half of FOLDER's logs is tuned on, which writes FOLDER/tuned.toml; in replays of the second half the alarms
are counted. Runs with the interpreter of giveway, not that of MuJoCo. The last line is JSON; the line before it has the
words that give `python -m verify.second_simulator` the tuned controller. Exit code 1: the interval does not hold.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from giveway.base import native
from giveway.crowd.statistics import rate_interval
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import table
from giveway.tuning.logs import read_log
from giveway.tuning.thresholds import alarms_in
from giveway.tuning.tuned import tune_robot

PER_HOUR = 60.0  # wished: as `giveway bench --tune`


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m verify.second_simulator.tuned", description=__doc__)
    parser.add_argument("folder", type=Path, help="with the logs of verify.second_simulator.undisturbed")
    parser.add_argument("--false-alarms", type=float, default=PER_HOUR, help="wished, per hour")
    asked = parser.parse_args(words)
    paths = sorted(asked.folder.glob("drive*.csv"))
    half = len(paths) // 2
    if not half:
        parser.error(f"{asked.folder}: {len(paths)} logs; needed: two or more of verify.second_simulator.undisturbed")
    file, out = native.robot_file("--robot", "trikey"), asked.folder / "tuned.toml"
    tuned, _ = tune_robot(paths[:half], file, asked.false_alarms, out, smallest=False)
    before, after = (table("controller").robot_values(read_robot(one)) for one in (file, out))
    fresh = [read_log(path, read_robot(out), after) for path in paths[half:]]
    alarms, hours = alarms_in(fresh, after)
    fewest, most = tuned.chosen.tail.counts(1.0, hours)
    found = {
        "tuned on, h": tuned.hours,
        "wished per hour": asked.false_alarms,
        "promised at most per hour": tuned.chosen.upper_per_hour,
        "thresholds before": dict(tuned.before),
        "thresholds": dict(tuned.chosen.thresholds),
        "fresh, h": hours,
        "foretold alarms": [fewest, most],
        "alarms": alarms,
        "alarms per hour, with 95 % interval": rate_interval(alarms, hours),
        "alarms with the thresholds before": alarms_in(fresh, before)[0],
        "holds": fewest <= alarms <= most,
    }
    changed = {name: value for name, value in after.items() if before.get(name) != value}
    print(" ".join(f"--set controller.{name}={value}" for name, value in changed.items()))
    print(json.dumps(found))
    return 0 if found["holds"] else 1


if __name__ == "__main__":
    sys.exit(main())
