"""The tests marked `deep`: run by pytest for two rungs, those about the controller and those about other rooms."""

from __future__ import annotations

import re

from verify.context import PYTEST, Context
from verify.rung import RungFailed, planted

__all__ = ["BUILDERS", "OTHER_ROOMS", "check_planted", "passed"]

# They build a release in the same folder, and keep both cores busy: one after the other, and beside nothing else.
BUILDERS = "tests/packaging"
# Whatever the controller does, they find the same.
OTHER_ROOMS = (
    "tests/cosim/test_cluster_examples.py",
    "tests/cosim/test_fmu_hostile.py",
    "tests/cosim/test_frequency_response.py",
    "tests/cosim/test_replay_follow.py",
    "tests/cosim/test_report.py",
    "tests/cosim/test_study_cluster.py",
    "tests/cosim/test_study_sure.py",
    "tests/docs/test_site.py",
    "tests/fmu/plant/test_tipping.py",
    "tests/modelica/test_bumpers_on_the_dummy.py",
    "tests/verify/test_ladder.py",
)
# Most of the time is compilers and installers; only what hangs takes this long.
_HANGS_S = 5400.0
_PASSED = re.compile(r"^(?:=+ )?(\d+) passed\b[^\n]*", re.MULTILINE)


def passed(context: Context, *arguments: str, environment: dict[str, str] | None = None) -> int:
    """The number of deep tests that passed; `RungFailed` if one failed or none was found."""
    answer = context.run(
        context.which(PYTEST), "-q", "-m", "deep", *arguments,
        cwd=context.root, timeout_s=_HANGS_S, memory_gib=None,
        environment={"OPENBLAS_NUM_THREADS": "1", **(environment or {})},
    )  # fmt: skip
    closing = _PASSED.search(answer.stdout)
    if closing is None or "skipped" in closing[0]:
        raise RungFailed(answer.evidence)
    return int(closing[1])


def check_planted(context: Context, fault: str, code: str, *arguments: str, shows: str) -> None:
    """With ``code`` run at each start of Python the tests of ``arguments`` fail as ``shows`` says, or else the rung."""
    (context.work / "sitecustomize.py").write_text(code, encoding="utf-8")
    with planted(fault, shows=shows):
        passed(context, *arguments, environment={"PYTHONPATH": str(context.work)})
