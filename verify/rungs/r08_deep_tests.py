"""The tests marked `deep`, which `make test` leaves out, pass: those whose result depends on the controller."""

from __future__ import annotations

from verify.context import PYTEST, Context
from verify.deep import BUILDERS, OTHER_ROOMS, passed
from verify.rung import Figure, Rung, planted


def check(context: Context) -> Figure:
    left_out = [word for path in (BUILDERS, *OTHER_ROOMS) for word in ("--ignore", path)]
    tests = passed(context, "tests", *left_out, "--numprocesses", "2", "--dist", "loadfile")
    _check_planted(context)
    return Figure(f"{tests} tests passed; 1 planted fault seen", {"tests": tests, "planted_faults": 1})


# Python runs it at each start.
OTHER_NUMBERS = """
from giveway.firmware import c_text

exact = c_text.real
c_text.real = lambda value: exact(1.001 * value)
"""


def _check_planted(context: Context) -> None:
    """Firmware whose numbers are 0.1 % larger than those of the controller that was recorded."""
    (context.work / "sitecustomize.py").write_text(OTHER_NUMBERS, encoding="utf-8")
    with planted("other numbers in the firmware", shows=r"FAILED tests/cosim/test_firmware\.py\S*lekiwi-test-arm"):
        tests = "tests/cosim/test_firmware.py::test_the_self_test_passes_here_and_on_a_cortex_m4f"
        passed(context, tests, "-k", "lekiwi", environment={"PYTHONPATH": str(context.work)})


RUNG = Rung("the tests of the controller that take too long for every commit", (PYTEST,), check)
