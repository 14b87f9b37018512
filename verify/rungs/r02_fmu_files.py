"""`giveway fmu check | info | run` withstand hostile files: nothing hangs, eats memory, or is written outside."""

from __future__ import annotations

import json
import sys
from typing import Any

from verify.context import Context, Tool
from verify.fmu_files.faults import FAULTS
from verify.fmu_files.make import MAKERS
from verify.fmu_files.trial import LONGEST_S, MOST_MB
from verify.rung import Figure, Rung, RungFailed, planted

GIVEWAY = Tool("giveway")
FILES = 10_000
FILES_OF_A_FAULT = 300


def check(context: Context) -> Figure:
    for name, fault in FAULTS.items():
        with planted(name, shows=fault.shows):
            _fuzzed(context, FILES_OF_A_FAULT, "--fault", name)
    found = _fuzzed(context, FILES)
    missing = set(MAKERS) - set(found["kinds"])
    if found["files"] != FILES or missing:
        raise RungFailed(f"{found['files']} files of {FILES}; kinds that never came up: {sorted(missing)}")
    return Figure(
        f"{FILES:,} hostile files of {len(MAKERS)} kinds: nothing written outside or left behind, no traceback, "
        f"none over {LONGEST_S:g} s or {MOST_MB:g} MB; {len(FAULTS)} planted faults seen",
        {"files": FILES, "kinds": len(MAKERS), "planted_faults": len(FAULTS)},
        varies=f"at most {found['slowest_s']:.1f} s and {found['largest_mb']:.0f} MB",
    )


def _fuzzed(context: Context, count: int, *options: str) -> dict[str, Any]:
    """The figures of so many seeds; `RungFailed` if a file does what none may."""
    answer = context.run(
        sys.executable,
        "-m",
        "verify.fmu_files",
        "--count",
        str(count),
        *options,
        cwd=context.root,
        timeout_s=1800.0,
        memory_gib=None,  # it limits that of the processes that read the files
        environment={"TMPDIR": str(context.work)},
    )
    figures: dict[str, Any] = json.loads(answer.stdout.splitlines()[-1])
    return figures


RUNG = Rung(
    "fuzzing of FMU files",
    (GIVEWAY,),
    check,
    subject=("cosim/giveway/fmu_tools/**/*.py", "verify/fmu_files/*.py"),
)
