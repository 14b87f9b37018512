"""Fuzzing of c_core: harnesses in verify/fuzz with libFuzzer and sanitizers. `make fuzz` runs them for long."""

from __future__ import annotations

import argparse
import itertools
import os
import re
from pathlib import Path

from verify.context import Context, Tool
from verify.failure import RungFailed
from verify.targets import CLANG, STANDARD, WARNINGS, core_sources

__all__ = ["HARNESSES", "TYPES", "VALGRIND", "build", "fuzz", "replay"]

VALGRIND = Tool("valgrind")
HARNESSES = ("controller", "configuration", "servo")
TYPES = ("float", "double")
ADDRESS = ("-fsanitize=fuzzer,address,undefined", "-fno-sanitize-recover=all")
MEMORY = ("-fsanitize=fuzzer,memory", "-fno-sanitize-recover=all")
SEED = 1
LONGEST_INPUT = 4096  # bytes: some 60 ticks of a controller


def build(context: Context, core: Path, name: str, real: str, flags: tuple[str, ...], program: Path) -> Path:
    """A harness with c_core of the real type ``real``."""
    folder = context.root / "verify" / "fuzz"
    sources = (folder / f"{name}.c", *core_sources(core))
    include = (f"-I{core / 'include'}", f"-I{folder}")
    context.run(
        context.which(CLANG),
        *STANDARD,
        *WARNINGS,
        "-g",
        "-O1",
        f"-DGW_REAL_DOUBLE={TYPES.index(real)}",
        *flags,
        *include,
        *sources,
        "-o",
        program,
        memory_gib=None,
    )
    return program


def fuzz(context: Context, program: Path, corpus: Path, seconds: int) -> int:
    """Number of inputs run; `RungFailed` with the finding of the first bad one. ``corpus`` grows."""
    corpus.mkdir(exist_ok=True)
    answer = context.run(
        program,
        f"-max_total_time={seconds}",
        f"-max_len={LONGEST_INPUT}",
        f"-seed={SEED}",
        "-print_final_stats=1",
        corpus,
        timeout_s=seconds + 300.0,
        memory_gib=None,
        expect=None,
    )
    if answer.returncode != 0:
        raise RungFailed(answer.evidence)
    found = re.search(r"number_of_executed_units: (\d+)", answer.stderr)
    if found is None:
        raise RungFailed(answer.evidence)
    return int(found[1])


def replay(context: Context, command: tuple[str | Path, ...], corpus: Path) -> int:
    """Run every input of the corpus once, and return their number."""
    inputs = sorted(corpus.iterdir())
    if not inputs:
        raise RungFailed(f"{corpus}: nothing to replay")
    answer = context.run(*command, *inputs, memory_gib=None, expect=None)
    if answer.returncode != 0:
        raise RungFailed(answer.evidence)
    return len(inputs)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=int, default=60, help="for each harness and real type (default: 60)")
    minutes = parser.parse_args().minutes
    root = Path(__file__).resolve().parents[1]
    work = root / "build" / "verify" / "fuzz"
    work.mkdir(parents=True, exist_ok=True)
    context = Context(root, work, os.environ["PATH"])
    for name, real in itertools.product(HARNESSES, TYPES):
        program = build(context, context.core, name, real, ADDRESS, work / f"{name}_{real}")
        corpus = work / f"{name}_{real}_corpus"
        runs = fuzz(context, program, corpus, 60 * minutes)
        print(f"{name}, {real}: {runs:,} inputs, none bad; corpus: {corpus}", flush=True)


if __name__ == "__main__":
    try:
        main()
    except RungFailed as failure:
        raise SystemExit(failure.evidence) from None
