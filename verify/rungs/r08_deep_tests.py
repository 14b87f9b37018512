"""The tests marked `deep`, which `make test` leaves out, pass."""

from __future__ import annotations

import re

from verify.context import PYTEST, Context
from verify.rung import Figure, Rung, RungFailed, planted

# Most of the time is compilers and installers; only what hangs takes this long.
HANGS_S = 5400.0
# They build a release in the same folder, and keep both cores busy: one after the other, and beside nothing else.
BUILDERS = "tests/packaging"
PASSED = re.compile(r"^(?:=+ )?(\d+) passed\b[^\n]*", re.MULTILINE)


def check(context: Context) -> Figure:
    tests = passed(context, "tests", "--ignore", BUILDERS, "--numprocesses", "2", "--dist", "loadfile")
    tests += passed(context, BUILDERS)
    _check_planted(context)
    return Figure(f"{tests} tests passed; 1 planted fault seen", {"tests": tests, "planted_faults": 1})


def passed(context: Context, *arguments: str, environment: dict[str, str] | None = None) -> int:
    """The number of deep tests that passed; `RungFailed` if one failed or none was found."""
    answer = context.run(
        context.which(PYTEST), "-q", "-m", "deep", *arguments,
        cwd=context.root, timeout_s=HANGS_S, memory_gib=None,
        environment={"OPENBLAS_NUM_THREADS": "1", **(environment or {})},
    )  # fmt: skip
    closing = PASSED.search(answer.stdout)
    if closing is None or "skipped" in closing[0]:
        raise RungFailed(answer.evidence)
    return int(closing[1])


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


RUNG = Rung("the tests that take too long for every commit", (PYTEST,), check)
