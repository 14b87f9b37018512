"""The bounds of gw_math that the proofs use hold for every float, and no finite float causes an overflow."""

from __future__ import annotations

import shutil
from pathlib import Path

from verify.context import Context
from verify.rung import Figure, Rung, RungFailed, planted
from verify.sources import SCALARS
from verify.targets import CLANG, PORTABLE, STANDARD, WARNINGS

FUNCTIONS = ("sqrt", "exp", "circle", "tanh", "atan2")


def check(context: Context) -> Figure:
    program = _build(context, context.core, context.work / "contracts")
    arguments = sum(_checked(context, program, name) for name in FUNCTIONS)
    core = context.work / "planted"
    shutil.copytree(context.core, core)
    source = core / "src" / "gw_math.c"
    healthy = "root = gw_min(root, BELOW_TWO);"
    text = source.read_text()
    if text.count(healthy) != 1:
        raise RungFailed(f"not once in gw_math.c: {healthy}")
    source.write_text(text.replace(healthy, "root = GW_HALF * gw_min(root, BELOW_TWO);"))
    with planted("roots of half the size", shows=r"sqrt: broken"):
        _checked(context, _build(context, core, context.work / "contracts_planted"), "sqrt")
    return Figure(
        f"{len(FUNCTIONS)} contracts hold on {arguments:,} floats; 1 planted fault seen",
        {"contracts": len(FUNCTIONS), "arguments": arguments, "planted_faults": 1},
    )


def _build(context: Context, core: Path, program: Path) -> Path:
    context.run(
        context.which(CLANG),
        *STANDARD,
        *WARNINGS,
        PORTABLE,
        "-O3",
        "-frounding-math",  # the flags are checked
        f"-I{core / 'include'}",
        context.root / "verify" / "exhaustive" / "contracts.c",
        core / "src" / "gw_math.c",
        "-lm",
        "-o",
        program,
    )
    return program


def _checked(context: Context, program: Path, name: str) -> int:
    """Number of floats checked; `RungFailed` if one breaks a bound."""
    answer = context.run(program, name)
    return int(answer.stdout.split()[0])


RUNG = Rung("bounds of gw_math on every float", (CLANG,), check, subject=(*SCALARS, "verify/exhaustive/*"))
