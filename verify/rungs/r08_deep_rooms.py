"""The tests marked `deep`, which `make test` leaves out, pass: those of rooms that the controller does not change."""

from __future__ import annotations

from verify.context import PYTEST, Context
from verify.deep import BUILDERS, OTHER_ROOMS, check_planted, passed
from verify.rung import Figure, Rung


def check(context: Context) -> Figure:
    tests = passed(context, *OTHER_ROOMS, "--numprocesses", "2", "--dist", "loadfile")
    tests += passed(context, BUILDERS)
    check_planted(
        context, "a gigabyte is unpacked", NO_LIMIT,
        "tests/cosim/test_fmu_hostile.py", "-k", "large_is_refused and info and bomb",
        shows=r"FAILED tests/cosim/test_fmu_hostile\.py\S*bomb-info",
    )  # fmt: skip
    return Figure(f"{tests} tests passed; 1 planted fault seen", {"tests": tests, "planted_faults": 1})


# A limit on unpacked files that is too high to protect anybody.
NO_LIMIT = """
from giveway.fmu_tools.limits import Limits

_, *others = Limits.__init__.__defaults__
Limits.__init__.__defaults__ = (100_000.0, *others)
"""

# Not what they test: some of it changes every day, and this takes a quarter of an hour. Climb it before a release.
RUNG = Rung(
    "the tests of other rooms that take too long for every commit",
    (PYTEST,),
    check,
    subject=(*OTHER_ROOMS, f"{BUILDERS}/*.py"),
)
