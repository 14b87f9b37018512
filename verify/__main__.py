"""`python -m verify [--only NAME]...`: from the repository's root; `make verify` prepares what it needs."""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

from verify.ladder import climb, hashes, standing, verified, write_summary
from verify.rung import RungFailed, all_rungs

ROOT = Path(__file__).parents[1]
CHANGED = "changed"


def main() -> int:
    rungs = all_rungs()
    parser = argparse.ArgumentParser(prog="verify", description="Verify c_core, rung by rung.")
    parser.add_argument(
        "--only",
        action="append",
        choices=[*rungs, CHANGED],
        metavar="NAME",
        help=f"{', '.join(rungs)}; {CHANGED}: those whose result is not about the sources as they are now",
    )
    chosen: set[str] = set(parser.parse_args().only or rungs)
    if CHANGED in chosen:
        chosen |= set(rungs) - set(standing(ROOT, rungs))
    start = time.perf_counter()
    before = hashes(ROOT, rungs)
    # Tools that are Python packages have an environment of their own; then comes the one that runs this.
    path = os.pathsep.join([str(ROOT / "build/verify/tools/bin"), str(Path(sys.executable).parent), os.environ["PATH"]])
    outcomes = climb(ROOT, {name: rung for name, rung in rungs.items() if name in chosen}, path)
    seconds = time.perf_counter() - start
    summary = write_summary(ROOT, outcomes, seconds)
    failed = sum(outcome.figure is None for outcome in outcomes)
    print(f"\n{len(outcomes) - failed} passed, {failed} failed in {seconds:.0f} s: {summary}")
    try:
        print(verified(ROOT, outcomes, rungs, before))
    except RungFailed as failure:
        print(failure.evidence)
        failed += 1
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
