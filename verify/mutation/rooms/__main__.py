"""`make mutate`: mutants drawn from the rooms outside c_core; survivors that are not listed are printed in its form."""

from __future__ import annotations

import argparse
import functools
import os
import sys
import time
from pathlib import Path

from verify.context import Context
from verify.mutation.rooms.planted import plant
from verify.mutation.rooms.room import ROOMS
from verify.mutation.rooms.tests import RoomTests
from verify.mutation.rooms.trial import judge, try_all
from verify.rung import RungFailed

ROOT = Path(__file__).parents[3]


def main() -> int:
    parser = argparse.ArgumentParser(prog="verify.mutation.rooms", description=__doc__)
    names = [room.folder for room in ROOMS]
    parser.add_argument("--room", action="append", choices=names, help="only mutants of this room")
    parser.add_argument("--few", action="store_true", help="only those that `make verify` tries")
    parser.add_argument(
        "--survivors", action="store_true", help="tests have changed: do not ask again about the killed"
    )
    given = parser.parse_args()
    work = ROOT / "build" / "verify" / "mutate_rooms"
    work.mkdir(parents=True, exist_ok=True)
    context = Context(ROOT, work, os.environ["PATH"])
    start = time.perf_counter()
    planted = plant(context, few=given.few)
    print(f"{len(planted.drawn)} mutants planted and built; {time.perf_counter() - start:.0f} s", flush=True)
    tests = RoomTests(context, planted, trust_killed=given.survivors)
    print(f"{len(tests.quick)} tests recorded; {time.perf_counter() - start:.0f} s", flush=True)
    for name in tests.failing:
        print(f"  left out, for it fails in this build: {name}", flush=True)
    rooms = [room for room in ROOMS if given.room is None or room.folder in given.room]
    trial = try_all(tests, rooms, functools.partial(print, flush=True))
    tests.close()
    print(f"{trial.text}; {time.perf_counter() - start:.0f} s", flush=True)
    judge(context, trial)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except RungFailed as failure:
        raise SystemExit(failure.evidence) from None
