"""The tests of the rooms outside c_core see nine of ten small faults; why they do not see the rest is written down."""

from __future__ import annotations

from verify.context import PYTEST, Context, Tool
from verify.mutation.mutants import SEED
from verify.mutation.rooms.planted import plant
from verify.mutation.rooms.room import ROOMS
from verify.mutation.rooms.tests import RoomTests
from verify.mutation.rooms.trial import judge, try_all
from verify.rung import Figure, Rung, planted

CXX = Tool("g++")
MUTANTS = sum(room.few for room in ROOMS)


def check(context: Context) -> Figure:
    tests = RoomTests(context, plant(context, few=True))
    try:
        trial = try_all(tests, say=_unsaid)
        judge(context, trial)
        tests.take_away()
        with planted("all tests taken away", shows=r"\d+ survived, and not listed"):
            judge(context, try_all(tests, ROOMS[:1], say=_unsaid))
    finally:
        tests.close()
    return Figure(
        f"{trial.text}; seed {SEED}; 1 planted fault seen",
        {"mutants": len(trial.fates), "killed": trial.killed, "seed": SEED, "planted_faults": 1},
    )


def _unsaid(_line: str) -> None:
    """What has to be known of survivors stands in the evidence."""


# Not the rooms themselves: some change every day, and this takes an hour.
RUNG = Rung(
    f"{MUTANTS} mutants of the rooms outside c_core",
    (CXX, PYTEST),
    check,
    subject=tuple(f"verify/mutation/rooms/*.{suffix}" for suffix in ("py", "toml", "hpp")),
)
