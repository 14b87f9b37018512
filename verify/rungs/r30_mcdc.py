"""The unit tests in C reach every line, every branch and every condition (MC/DC) of c_core, unoptimised."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from verify.context import Context, Tool
from verify.rung import Figure, Rung, RungFailed, planted
from verify.targets import CLANG, PORTABLE, STANDARD, WARNINGS, core_sources

PROFDATA = Tool("llvm-profdata-19", package="llvm-19")
COV = Tool("llvm-cov-19", package="llvm-19")
KINDS = ("lines", "branches", "mcdc")
TYPES = ("float", "double")


def check(context: Context) -> Figure:
    tests = sorted((context.root / "tests" / "c_core" / "unit").glob("*.c"))
    totals = [_covered(context, context.core, tests, double) for double in (0, 1)]
    # A harness that always reports 100 % would do so without the tests of a module, too.
    without = [path for path in tests if path.name != "servo_test.c"]
    stub = context.work / "no_servo_test.c"
    stub.write_text('#include "unit.h"\nvoid suite_servo(void)\n{\n}\n')
    with planted("a module without its tests", shows=r"gw_servo\.c:\d+: line"):
        _covered(context, context.core, [*without, stub], 0)
    _check_planted_condition(context, tests)
    values = {f"{kind}_{TYPES[double]}": totals[double][kind] for double in (0, 1) for kind in KINDS}
    text = ", ".join(f"{totals[0][kind]} of {totals[0][kind]} {kind}" for kind in KINDS)
    return Figure(f"100 %: {text} in float; the same in double; 2 planted faults reported", values)


def _check_planted_condition(context: Context, tests: list[Path]) -> None:
    """A condition without effect: all lines and branches are reached, but MC/DC is not."""
    core = context.work / "planted"
    shutil.copytree(context.core, core)
    source = core / "src" / "gw_wrench.c"
    source.write_text(
        source.read_text()
        + "bool planted(bool a, bool b);\nbool planted(bool a, bool b)\n{\n    return a && (a || b);\n}\n"
    )
    caller = context.work / "planted_caller.c"
    caller.write_text(
        "#include <stdbool.h>\nbool planted(bool a, bool b);\nbool planted_caller(void);\n"
        "__attribute__((constructor)) static void call(void)\n"
        "{\n    (void)planted(true, true);\n    (void)planted(false, false);\n}\n"
    )
    with planted("a condition without effect", shows=r"gw_wrench\.c:\d+: MC/DC"):
        _covered(context, core, [*tests, caller], 0)


def _covered(context: Context, core: Path, tests: list[Path], double: int) -> dict[str, int]:
    """Numbers of lines, branches and conditions; `RungFailed` names those that were not reached."""
    program = context.work / f"tests_{TYPES[double]}"
    raw, profile = program.with_suffix(".profraw"), program.with_suffix(".profdata")
    context.run(
        context.which(CLANG),
        *STANDARD,
        *WARNINGS,  # clang warns about decisions that it cannot instrument
        PORTABLE,
        "-O0",
        "-fprofile-instr-generate",
        "-fcoverage-mapping",
        "-fcoverage-mcdc",
        f"-DGW_REAL_DOUBLE={double}",
        f"-I{core / 'include'}",
        f"-I{context.root / 'tests' / 'c_core' / 'unit'}",
        *core_sources(core),
        *tests,
        "-o",
        program,
    )
    context.run(program, environment={"LLVM_PROFILE_FILE": str(raw)}, expect=None)
    context.run(context.which(PROFDATA), "merge", raw, "-o", profile)
    export = context.run(
        context.which(COV), "export", "-format=text", f"-instr-profile={profile}", program, *core_sources(core)
    )
    (data,) = json.loads(export.stdout)["data"]
    files = [file for file in data["files"] if Path(file["filename"]).parent == core / "src"]
    if len(files) != len(core_sources(core)):
        raise RungFailed(f"{len(files)} files in the report, {len(core_sources(core))} in c_core/src")
    missed = [line for file in files for line in _missed(file)]
    totals = {kind: sum(file["summary"][kind]["count"] for file in files) for kind in KINDS}
    reached = {kind: sum(file["summary"][kind]["covered"] for file in files) for kind in KINDS}
    if missed or totals != reached:
        figures = ", ".join(f"{reached[kind]} of {totals[kind]} {kind}" for kind in KINDS)
        raise RungFailed("\n".join([f"{TYPES[double]}: {figures}", *missed]))
    return totals


def _missed(file: dict[str, Any]) -> Iterator[str]:
    """Places that were not reached, from the arrays of the export (llvm-cov, format 3)."""
    name = Path(file["filename"]).name
    for line, _, count, has_count, is_entry, *_ in file["segments"]:
        if has_count and is_entry and count == 0:
            yield f"{name}:{line}: line not reached"
    for line, column, _, _, true, false, *_ in file["branches"]:
        if true == 0 or false == 0:
            yield f"{name}:{line}:{column}: branch never {'true' if true == 0 else 'false'}"
    for line, _, _, _, *rest in file["mcdc_records"]:
        conditions = rest[-1]
        for number, shown in enumerate(conditions, 1):
            if not shown:
                yield f"{name}:{line}: MC/DC: condition {number} of {len(conditions)} never decides"


RUNG = Rung("MC/DC, branch and line coverage of the unit tests", (CLANG, PROFDATA, COV), check)
