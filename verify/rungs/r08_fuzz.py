"""A minute of fuzzing per harness, configurations and input sequences: no sanitizer speaks, no invariant breaks."""

from __future__ import annotations

import shutil

from verify.context import Context
from verify.fuzzing import ADDRESS, HARNESSES, MEMORY, VALGRIND, build, fuzz, replay
from verify.rung import Figure, Rung, RungFailed, planted
from verify.targets import CLANG

SECONDS = 60
UNDER_VALGRIND = 40  # inputs: fifty times slower
PLANTED = {
    "controller": (
        "gw_supervisor.c",
        "if (!events->sensors_good) {",
        "if ((!events->sensors_good) && (!events->stop_request)) {",
    ),
    "servo": ("gw_servo.c", "gw_clamp(wanted, -limit, limit)", "gw_clamp(wanted, -limit, GW_TWO * limit)"),
}


def check(context: Context) -> Figure:
    runs = 0
    for name in HARNESSES:
        corpus = context.work / f"{name}_corpus"
        program = build(context, context.core, name, ADDRESS, context.work / name)
        runs += fuzz(context, program, corpus, SECONDS)
        replay(context, (build(context, context.core, name, MEMORY, context.work / f"{name}_memory"),), corpus)
        plain = build(context, context.core, name, ("-fsanitize=fuzzer", "-gdwarf-4"), context.work / f"{name}_plain")
        few = context.work / f"{name}_few"
        few.mkdir()
        for path in sorted(corpus.iterdir(), key=lambda path: -path.stat().st_size)[:UNDER_VALGRIND]:
            shutil.copy(path, few)
        replay(context, (context.which(VALGRIND), "--quiet", "--error-exitcode=9", plain), few)
        _check_planted(context, name)
    return Figure(
        f"{runs:,} inputs in {SECONDS} s per harness with ASan and UBSan, "
        f"corpora again with MSan and valgrind: none bad; {len(PLANTED)} planted faults found",
        {"harnesses": len(HARNESSES), "seconds_per_harness": SECONDS, "planted_faults": len(PLANTED)},
    )


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
    program = build(context, core, name, ADDRESS, context.work / f"{name}_with_fault")
    with planted(f"{file} without {healthy}", shows="broken: "):
        fuzz(context, program, context.work / f"{name}_corpus", SECONDS)


RUNG = Rung("fuzzing with sanitizers", (CLANG, VALGRIND), check)
