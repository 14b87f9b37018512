"""Every compiler and machine gives the same bits; a build that cannot is refused or detected."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass

from verify import golden
from verify.context import Context
from verify.rung import Figure, Rung, RungFailed, planted
from verify.targets import CORTEX_M, CROSS, HOST, HOST_CLANG, TARGETS, WIN64, Target

LEVELS = ("-O0", "-O1", "-O2", "-O3", "-Os")
# On the other machines each further optimisation level would add little: M4F represents them.
MACHINES = [
    *[(target, level) for target in (HOST, HOST_CLANG, TARGETS["cortex-m4f"]) for level in LEVELS],
    *[(target, "-O2") for target in (WIN64, *CORTEX_M, *CROSS) if target.name != "cortex-m4f"],
]


@dataclass(frozen=True)
class Breaking:
    """Flags that break the promise, and how this is detected."""

    target: Target
    flags: tuple[str, ...]
    shows: str
    double: int = 0


X87 = Target("i686 x87", CROSS[0].compiler, ("-static", "-mno-sse", "-mfpmath=387"), CROSS[0].emulator)
REFUSED = r"#error"
OTHER_BITS = r"other bits than"
BREAKING = (
    Breaking(HOST, ("-ffast-math",), REFUSED),
    Breaking(HOST, ("-funsafe-math-optimizations",), REFUSED),
    Breaking(HOST, ("-ffinite-math-only",), REFUSED),
    Breaking(HOST_CLANG, ("-ffast-math",), r"error: .giveway needs IEEE arithmetic"),
    Breaking(TARGETS["cortex-m4f"], ("-ffast-math",), REFUSED),
    Breaking(X87, (), r"FLT_EVAL_METHOD"),
    Breaking(HOST, ("-march=haswell", "-ffp-contract=fast"), OTHER_BITS),
    Breaking(TARGETS["cortex-m4f"], ("-ffp-contract=fast",), OTHER_BITS),
    Breaking(CROSS[1], ("-ffp-contract=fast",), OTHER_BITS),
    Breaking(HOST, ("-fsingle-precision-constant",), OTHER_BITS, double=1),
)
# These only change sizes; the bits must stay.
HARMLESS = (("-fshort-enums",), ("-funsigned-char",), ("-fwrapv", "-fno-strict-aliasing"))


def check(context: Context) -> Figure:
    builds = 0
    for target, level in MACHINES:
        for double in (0, 1) if target.double_rounds else (0,):
            _same(context, target, double, level)
            builds += 1
    for flags in HARMLESS:
        _same(context, HOST, 0, "-O2", *flags)
        builds += 1
    for breaking in BREAKING:
        with planted(f"{breaking.target.name} {' '.join(breaking.flags)}", shows=breaking.shows):
            _same(context, breaking.target, breaking.double, "-O2", *breaking.flags)
    with planted("one last bit of one constant", shows=OTHER_BITS):
        golden.compare("planted", _with_one_bit_wrong(context), golden.read_table(context.root, 0))
    modules = len(golden.read_table(context.root, 0).splitlines())
    names = dict.fromkeys(target.name for target, _ in MACHINES)
    return Figure(
        f"{modules} digests the same in {builds} builds on {', '.join(names)}; {len(BREAKING)} breaking sets of flags "
        "refused or seen",
        {"digests": modules, "builds": builds, "machines": len(names), "breaking_flags": len(BREAKING)},
    )


def _same(context: Context, target: Target, double: int, *flags: str) -> None:
    what = " ".join([target.name, golden.TYPES[double], *flags])
    program = golden.build(context, target, context.core, double, re.sub(r"[^\w.]+", "_", what), *flags)
    golden.compare(what, golden.digests(context, target, program), golden.read_table(context.root, double))
    program.unlink()


def _with_one_bit_wrong(context: Context) -> str:
    core = context.work / "planted"
    source = core / "src" / "gw_math.c"
    shutil.copytree(context.core, core)
    healthy = "(gw_real_t)(-1.0 / 5040.0)"
    text = source.read_text()
    if healthy not in text:
        raise RungFailed(f"gw_math.c no longer holds {healthy}: choose another constant to spoil")
    source.write_text(text.replace(healthy, "(gw_real_t)(-1.0 / 5040.001)"))
    return golden.digests(context, HOST, golden.build(context, HOST, core, 0, "planted_program", "-O2"))


RUNG = Rung(
    "the same bits from every compiler on every machine",
    tuple(dict.fromkeys(tool for target, _ in MACHINES for tool in target.tools)),
    check,
)
