"""What a 1 ms step costs on this machine: c_core's against the same step written with Eigen.

`.venv/bin/python -m verify.step_cost` prints the table of docs/site/reference/c_cost.md, after `make build`, and `make
bench` does.
"""

from __future__ import annotations

import os
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

from verify.context import Context, Tool
from verify.rung import RungFailed

__all__ = ["Cost", "measure", "table"]

VALGRIND = Tool("valgrind")
PROGRAM = "build/tests/c_core/bench_step"
TICKS = 800  # RECORDED_TICKS
COLLISIONS = 500  # number of repetitions; the best counts, as other processes use the machine as well
WAYS = {"c_core": "run_c_core", "eigen": "run_eigen"}


@dataclass(frozen=True)
class Cost:
    """Per step, over the recorded collision."""

    nanoseconds: float
    instructions: float


def measure(context: Context) -> dict[str, Cost]:
    """Nanoseconds of both in one run, measured alternately; instructions counted by callgrind."""
    program = context.root / PROGRAM
    lines = context.run(program, str(COLLISIONS)).stdout.splitlines()
    times = {name: float(value) for name, value in (line.split() for line in lines)}
    return {name: Cost(times[name], _instructions(context, program, function)) for name, function in WAYS.items()}


def _instructions(context: Context, program: Path, function: str) -> float:
    answer = context.run(
        context.which(VALGRIND),
        "--tool=callgrind",
        f"--callgrind-out-file={context.work / 'callgrind.out'}",
        "--collect-atstart=no",
        f"--toggle-collect={function}",
        program,
        "1",
        memory_gib=None,  # valgrind reserves address space
    )
    found = re.search(r"Collected : (\d+)", answer.stderr)
    if found is None:
        raise RungFailed(answer.evidence)
    return int(found[1]) / TICKS


def table(costs: dict[str, Cost]) -> str:
    """The table of docs/site/reference/c_cost.md."""
    own, eigen = costs["c_core"], costs["eigen"]
    rows = (
        ("ns per step", own.nanoseconds, eigen.nanoseconds),
        ("instructions per step", own.instructions, eigen.instructions),
    )
    lines = ["| this machine, gcc -O2 | c_core | Eigen | ratio |", "|---|---:|---:|---:|"]
    lines += [f"| {name} | {ours:,.0f} | {theirs:,.0f} | {ours / theirs:.2f} |" for name, ours, theirs in rows]
    return "".join(f"{line}\n" for line in lines)


def _print() -> None:
    root = Path(__file__).parents[1]
    with tempfile.TemporaryDirectory() as folder:
        print(table(measure(Context(root, Path(folder), os.environ["PATH"]))), end="")


if __name__ == "__main__":
    _print()
