"""`python -m verify [--only NAME]...`: from the repository's root; `make verify` prepares what it needs."""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

from verify.ladder import climb, verified, write_summary
from verify.rung import RungFailed, all_rungs
from verify.sources import core_hash

ROOT = Path(__file__).parents[1]


def main() -> int:
    rungs = all_rungs()
    parser = argparse.ArgumentParser(prog="verify", description="Verify c_core, rung by rung.")
    parser.add_argument("--only", action="append", choices=list(rungs), metavar="NAME", help=", ".join(rungs))
    chosen: list[str] | None = parser.parse_args().only
    start = time.perf_counter()
    sources = core_hash(ROOT)
    # Tools that are Python packages have an environment of their own; then comes the one that runs this.
    path = os.pathsep.join([str(ROOT / "build/verify/tools/bin"), str(Path(sys.executable).parent), os.environ["PATH"]])
    outcomes = climb(ROOT, {name: rung for name, rung in rungs.items() if not chosen or name in chosen}, path)
    seconds = time.perf_counter() - start
    summary = write_summary(ROOT, outcomes, sources, seconds)
    failed = sum(outcome.figure is None for outcome in outcomes)
    print(f"\n{len(outcomes) - failed} passed, {failed} failed in {seconds:.0f} s: {summary}")
    try:
        print(verified(ROOT, outcomes, sources, list(rungs)))
    except RungFailed as failure:
        print(failure.evidence)
        failed += 1
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
