"""`make mutate`: every mutant of c_core; prints survivors that are not listed in the form of the list."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import time
from pathlib import Path

from verify.context import Context
from verify.failure import RungFailed
from verify.mutation.killers import Fate, Killers
from verify.mutation.mutants import Mutant, every
from verify.mutation.trial import Trial, judge, of_all

ROOT = Path(__file__).parents[2]


def main() -> int:
    parser = argparse.ArgumentParser(prog="verify.mutation", description=__doc__)
    parser.add_argument("--file", action="append", metavar="NAME", help="only mutants of this file, such as gw_servo.c")
    files: list[str] | None = parser.parse_args().file
    work = ROOT / "build" / "verify" / "mutate"
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    killers = Killers(Context(ROOT, work, os.environ["PATH"]))
    mutants = [mutant for mutant in every(ROOT) if files is None or mutant.key.file in files]
    start = time.perf_counter()
    fates: dict[Mutant, Fate] = {}
    for name in dict.fromkeys(mutant.key.file for mutant in mutants):
        of_file = of_all(killers, [mutant for mutant in mutants if mutant.key.file == name])
        print(f"{name}: {of_file.killed} of {of_file.counted} killed", flush=True)
        fates |= of_file.fates
    trial = Trial(fates)
    print(f"{trial.text}; {time.perf_counter() - start:.0f} s", flush=True)
    judge(killers, trial)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except RungFailed as failure:
        raise SystemExit(failure.evidence) from None
