"""The tests marked `deep`, which `make test` leaves out, pass: those whose result depends on the controller."""

from __future__ import annotations

from verify.context import PYTEST, Context
from verify.deep import BUILDERS, OTHER_ROOMS, check_planted, passed
from verify.rung import Figure, Rung


def check(context: Context) -> Figure:
    left_out = [word for path in (BUILDERS, *OTHER_ROOMS) for word in ("--ignore", path)]
    tests = passed(context, "tests", *left_out, "--numprocesses", "2", "--dist", "loadfile")
    check_planted(
        context, "other numbers in the firmware", OTHER_NUMBERS,
        "tests/cosim/test_firmware.py", "-k", "self_test and lekiwi",
        shows=r"FAILED tests/cosim/test_firmware\.py\S*lekiwi-test-arm",
    )  # fmt: skip
    return Figure(f"{tests} tests passed; 1 planted fault seen", {"tests": tests, "planted_faults": 1})


# Firmware whose numbers are 0.1 % larger than those of the controller that was recorded.
OTHER_NUMBERS = """
from giveway.firmware import c_text

exact = c_text.real
c_text.real = lambda value: exact(1.001 * value)
"""

RUNG = Rung("the tests of the controller that take too long for every commit", (PYTEST,), check)
