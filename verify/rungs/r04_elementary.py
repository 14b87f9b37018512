"""Errors of the scalar functions are within what gw_math.h states: over every float, and searched for double."""

from __future__ import annotations

import itertools
import math
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from verify.context import Context
from verify.rung import Figure, Rung, RungFailed, planted
from verify.sources import SCALARS
from verify.targets import GCC, HOST, PORTABLE

INFINITY_BITS = 0x7F800000
# Parts of about equal duration, two at a time: tiny numbers are slow (their squares are subnormal), and above
# GW_ANGLE_MAX there is little to compute.
BOUNDS = (0, 0x10000000, 0x20000000, 0x30000000, INFINITY_BITS)
PARTS = tuple(itertools.pairwise(BOUNDS))
AT_A_TIME = 2
DOUBLE_SAMPLES = 5_000_000
STATED = re.compile(r"^ \*     (\w+) +([\d.]+) +([\d.]+)$", re.MULTILINE)
MEASURED = re.compile(r"^(\w+) (\S+) (\S+)$", re.MULTILINE)


def check(context: Context) -> Figure:
    header = (context.core / "include/giveway/gw_math.h").read_text()
    stated = {name: (float(single), float(double)) for name, single, double in STATED.findall(header)}
    single = _build(context, context.core, 0, "single")
    double = _build(context, context.core, 1, "double")
    with ThreadPoolExecutor(AT_A_TIME) as pool:
        parts = list(pool.map(lambda part: _errors(context, single, *(f"{bound:x}" for bound in part)), PARTS))
    of_float = {name: max(part[name] for part in parts) for name in parts[0]}
    of_double = _errors(context, double, str(DOUBLE_SAMPLES))
    _compare(stated, of_float, of_double)
    _check_planted(context, stated, of_double)
    worst = max(of_float, key=lambda name: of_float[name])
    return Figure(
        f"every float: sqrt correctly rounded, at most {of_float[worst]:.2f} ulp ({worst}); "
        f"double: at most {max(of_double.values()):.2f} ulp in {DOUBLE_SAMPLES} samples of each kind",
        {
            **{f"{name} float ulp": error for name, error in of_float.items()},
            **{f"{name} double ulp": error for name, error in of_double.items()},
        },
    )


def _build(context: Context, core: Path, double: int, name: str) -> Path:
    tests = context.root / "tests" / "c_core"
    return HOST.build(
        context,
        [core / "src/gw_math.c", tests / "golden/generator.c", tests / "elementary/errors.c"],
        context.work / name,
        "-O2",
        PORTABLE,
        f"-DGW_REAL_DOUBLE={double}",
        f"-I{tests / 'golden'}",
        "-Wl,--no-as-needed,-lm",
    )


def _errors(context: Context, program: Path, *arguments: str) -> dict[str, float]:
    answer = context.run(program, *arguments, timeout_s=900.0)
    return {name: float(error) for name, error, _ in MEASURED.findall(answer.stdout)}


def _compare(stated: dict[str, tuple[float, float]], of_float: dict[str, float], of_double: dict[str, float]) -> None:
    wrong = []
    for kind, measured in enumerate((of_float, of_double)):
        for name, error in measured.items():
            bound = stated.get(name, (math.nan, math.nan))[kind]
            if not error <= bound:
                wrong.append(f"{name} {('float', 'double')[kind]}: {error} ulp, gw_math.h states {bound}")
    if wrong:
        raise RungFailed("\n".join(wrong))


def _check_planted(context: Context, stated: dict[str, tuple[float, float]], of_double: dict[str, float]) -> None:
    """One coefficient off by a millionth: seen in the range where it matters, in float."""
    core = context.work / "planted"
    (core / "src").mkdir(parents=True)
    text = (context.core / "src/gw_math.c").read_text()
    healthy = "(gw_real_t)(-1.0 / 6.0)"
    if healthy not in text:
        raise RungFailed(f"gw_math.c no longer holds {healthy}: choose another coefficient to spoil")
    (core / "src/gw_math.c").write_text(text.replace(healthy, "(gw_real_t)(-1.000001 / 6.0)"))
    spoilt = _build(context, core, 0, "spoilt")
    with planted("a coefficient of the sine off by a millionth", shows=r"sin float: "):
        _compare(stated, _errors(context, spoilt, "3f000000", "3f400000"), of_double)


RUNG = Rung(
    "errors of the scalar functions over every float",
    (GCC,),
    check,
    subject=(*SCALARS, "tests/c_core/elementary/*", "tests/c_core/golden/generator.*"),
)
