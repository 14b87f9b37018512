"""What the reflexes did: table and targets of `giveway crowd` over the second simulator's runs, and its quiet runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from giveway.crowd.judged import Judged, judge, limits
from giveway.crowd.population import WITH_IMU
from giveway.crowd.statistics import rate_upper_bound
from giveway.crowd.table import HEADER, ROWS, TARGET_HEADER, cells, find, read, target_rows

from verify.second_simulator.loop import Traces

__all__ = ["QUIET_HEADER", "judged_record", "markdown", "quiet_rows"]

QUIET_HEADER = (
    "untouched",
    "runs",
    "runs with an alarm",
    "seconds",
    "false detections",
    "per hour",
    "95 % upper bound",
    "at most",
    "",
)
ASKED = "tipping"  # its base can tip

Record = Mapping[str, Any]


def judged_record(traces: Traces, parameters: Mapping[str, Any], controller: Mapping[str, Any]) -> Any:
    """The verdict on one run as plain data."""
    return judge(traces["time"], traces, limits(controller, float(parameters["wheel.distance"]))).record()


def quiet_rows(records: Sequence[Record]) -> list[tuple[str, ...]]:
    """False detections of the runs that nobody touches."""
    rows: list[tuple[str, ...]] = []
    for situation in dict.fromkeys(record["situation"] for record in records if record["kind"] == "nothing"):
        mine = [record for record in records if record["kind"] == "nothing" and record["situation"] == situation]
        counts = [len(Judged.of(record["judged"]).detections_s) for record in mine]
        seconds = sum(float(record["simulated_s"]) for record in mine)
        hours = seconds / 3600.0
        rows.append(
            (
                situation,
                str(len(mine)),
                str(sum(count > 0 for count in counts)),
                f"{seconds:.0f}",
                str(sum(counts)),
                f"{sum(counts) / hours:.0f}",
                f"{rate_upper_bound(sum(counts), hours):.0f}",
                "0",
                "missed" if sum(counts) else "met",
            )
        )
    return rows


def markdown(records: Sequence[Record], imu: bool = False) -> str:
    """The classes of hits, what is asked of them, and the quiet runs; ``imu``: the controller has one."""
    touched = read([dict(record) for record in records if record["kind"] != "nothing"])
    found = [found for row in ROWS if (found := find(row, touched)).runs]
    # Wheels that lift are not compared with a blocked run here.
    asked = [line for line in target_rows(ASKED + WITH_IMU * imu, found) if line[-1] != "-"]
    return "\n".join(
        [
            *_table(HEADER, [cells(one) for one in found]),
            *_table(TARGET_HEADER, asked),
            *_table(QUIET_HEADER, quiet_rows(records)),
        ]
    )


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(line)} |" for line in (header, ["---"] * len(header), *rows)] + [""]
