"""The tests marked `deep`, which `make test` leaves out, pass: those of rooms that the controller does not change."""

from __future__ import annotations

from verify.context import PYTEST, Context
from verify.deep import BUILDERS, OTHER_ROOMS, passed
from verify.rung import Figure, Rung, planted


def check(context: Context) -> Figure:
    tests = passed(context, *OTHER_ROOMS, "--numprocesses", "2", "--dist", "loadfile")
    tests += passed(context, BUILDERS)
    _check_planted(context)
    return Figure(f"{tests} tests passed; 1 planted fault seen", {"tests": tests, "planted_faults": 1})


# Python runs it at each start.
NO_LIMIT = """
from giveway.fmu_tools.limits import Limits

_, *others = Limits.__init__.__defaults__
Limits.__init__.__defaults__ = (100_000.0, *others)
"""


def _check_planted(context: Context) -> None:
    """A limit on unpacked files that is too high to protect anybody."""
    (context.work / "sitecustomize.py").write_text(NO_LIMIT, encoding="utf-8")
    with planted("a gigabyte is unpacked", shows=r"FAILED tests/cosim/test_fmu_hostile\.py\S*bomb-info"):
        tests = "tests/cosim/test_fmu_hostile.py::test_what_is_large_is_refused_in_little_memory"
        passed(context, tests, "-k", "info and bomb", environment={"PYTHONPATH": str(context.work)})


# Not what they test: some of it changes every day, and this takes half an hour. Climb it before a release.
RUNG = Rung(
    "the tests of other rooms that take too long for every commit",
    (PYTEST,),
    check,
    subject=(*OTHER_ROOMS, f"{BUILDERS}/*.py"),
)
