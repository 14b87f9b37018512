"""The unit tests in C pass on every machine: the PC, Windows under wine, Cortex-M under qemu; float and double."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from verify.context import Context
from verify.rung import Figure, Rung, RungFailed, planted
from verify.targets import TARGETS, WARNINGS, Target, core_sources

CLOSING = re.compile(r"^(\d+) passed, (\d+) failed\r?$", re.MULTILINE)
TYPES = ("float", "double")


def check(context: Context) -> Figure:
    counts = {}
    for target in TARGETS.values():
        for double, name in enumerate(TYPES):
            counts[f"{target.name} {name}"] = _passed(context, target, context.core, double)
    numbers = set(counts.values())
    if len(numbers) != 1:
        raise RungFailed("\n".join(["not the same number of tests everywhere", *map(str, counts.items())]))
    (tests,) = numbers
    _check_planted(context)
    return Figure(
        f"{tests} passed, 0 failed in float and in double on {', '.join(TARGETS)}",
        {"tests": tests, "machines": len(TARGETS), "planted_faults": 1},
    )


def _passed(context: Context, target: Target, core: Path, double: int) -> int:
    """The number of tests that passed; `RungFailed` if one failed or the program did not finish."""
    tests = sorted((context.root / "tests" / "c_core" / "unit").glob("*.c"))
    program = target.build(
        context,
        [*core_sources(core), *tests],
        context.work / f"{target.name}_{TYPES[double]}",
        *WARNINGS,
        "-O2",
        f"-DGW_REAL_DOUBLE={double}",
    )
    answer = target.run(context, program, timeout_s=600.0, expect=None)
    closing = CLOSING.search(answer.stdout)
    if closing is None or closing[2] != "0":
        raise RungFailed(f"{target.name}, {TYPES[double]}\n{answer.evidence}")
    return int(closing[1])


def _check_planted(context: Context) -> None:
    """The robot continues with bad sensors: the tests have to see it, also on the target."""
    core = context.work / "planted"
    shutil.copytree(context.core, core)
    source = core / "src" / "gw_sensor_check.c"
    healthy = "status = GW_STATUS_SENSOR_SATURATED;"
    text = source.read_text()
    assert healthy in text
    source.write_text(text.replace(healthy, "status = GW_STATUS_OK;"))
    with planted("a saturated sensor passes for good", shows=r"FAILED bad_sensors_command_no_motion"):
        _passed(context, TARGETS["cortex-m4f"], core, 0)


RUNG = Rung(
    "unit tests in C on the PC, under wine and on Cortex-M",
    tuple(dict.fromkeys(tool for target in TARGETS.values() for tool in target.tools)),
    check,
)
