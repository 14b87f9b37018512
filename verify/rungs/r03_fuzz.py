"""A minute of fuzzing per harness and real type, with configurations and input sequences: no sanitizer reports an
error, no invariant is broken."""

from __future__ import annotations

import itertools
import shutil
from pathlib import Path

from verify.context import Context
from verify.fuzzing import ADDRESS, HARNESSES, MEMORY, TYPES, VALGRIND, build, fuzz, replay
from verify.rung import Figure, Rung, RungFailed, planted
from verify.targets import CLANG

SECONDS = 60
PLANTED_SECONDS = 600  # at most: it ends with the fault, late on a machine that has more to do
UNDER_VALGRIND = 40  # inputs: fifty times slower
PLANTED = {
    "controller": (
        "gw_supervisor.c",
        "if (!events->sensors_good) {",
        "if ((!events->sensors_good) && (!events->stop_request)) {",
    ),
    "configuration": ("gw_config.c", "!gw_in_range(value, minimum, maximum)", "(value < minimum) || (value > maximum)"),
    "servo": ("gw_servo.c", "gw_clamp(wanted, -limit, limit)", "gw_clamp(wanted, -limit, GW_TWO * limit)"),
}


def check(context: Context) -> Figure:
    runs = sum(_fuzzed(context, name, real) for name, real in itertools.product(HARNESSES, TYPES))
    for name in HARNESSES:
        _check_planted(context, name)
    return Figure(
        f"{SECONDS} s per harness, {len(HARNESSES)} in float and in double, with ASan and UBSan, corpora again with "
        f"MSan and valgrind: no input was bad; {len(PLANTED)} planted faults found",
        {
            "harnesses": len(HARNESSES),
            "types": len(TYPES),
            "seconds_per_harness_and_type": SECONDS,
            "planted_faults": len(PLANTED),
        },
        varies=f"{runs:,} inputs",
    )


def _fuzzed(context: Context, name: str, real: str) -> int:
    """How many inputs were run."""

    def built(kind: str, *flags: str) -> Path:
        return build(context, context.core, name, real, flags, context.work / f"{name}_{real}_{kind}")

    corpus = _corpus(context, name, real)
    runs = fuzz(context, built("address", *ADDRESS), corpus, SECONDS)
    replay(context, (built("memory", *MEMORY),), corpus)
    few = context.work / f"{name}_{real}_few"
    few.mkdir()
    for path in sorted(corpus.iterdir(), key=lambda path: -path.stat().st_size)[:UNDER_VALGRIND]:
        shutil.copy(path, few)
    plain = built("plain", "-fsanitize=fuzzer", "-gdwarf-4")
    replay(context, (context.which(VALGRIND), "--quiet", "--error-exitcode=9", plain), few)
    return runs


def _corpus(context: Context, name: str, real: str) -> Path:
    return context.work / f"{name}_{real}_corpus"


def _check_planted(context: Context, name: str) -> None:
    """The fuzzer has to find the fault by itself, from the corpus that it has."""
    file, healthy, sick = PLANTED[name]
    core = context.work / f"{name}_planted"
    shutil.copytree(context.core, core)
    source = core / "src" / file
    text = source.read_text()
    if text.count(healthy) != 1:
        raise RungFailed(f"not once in {file}: {healthy}")
    source.write_text(text.replace(healthy, sick))
    real = TYPES[0]
    program = build(context, core, name, real, ADDRESS, context.work / f"{name}_with_fault")
    with planted(f"{file} without {healthy}", shows="broken: "):
        fuzz(context, program, _corpus(context, name, real), PLANTED_SECONDS)


RUNG = Rung("fuzzing with sanitizers", (CLANG, VALGRIND), check)
