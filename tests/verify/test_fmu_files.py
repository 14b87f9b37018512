"""The fuzz of FMU files: a few hundred of the rung's 10,000, and each planted fault that is quick to see is seen."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from giveway.base import native

from verify.fmu_files.faults import FAULTS
from verify.fmu_files.make import MAKERS, bases, hostile

ROOT = Path(__file__).parents[2]
SLOW = {"hangs", "reads without limits", "crashes"}  # in the rung


def _fuzz(*options: str, expect: int = 0) -> tuple[str, dict[str, Any]]:
    command = [sys.executable, "-m", "verify.fmu_files", *options]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert answer.returncode == expect, answer.stdout + answer.stderr
    *_, last = answer.stdout.splitlines()
    return answer.stdout, json.loads(last)


def test_nothing_goes_wrong_with_a_hundred() -> None:
    _, found = _fuzz("--count", "100")
    assert found["files"] == 100
    assert set(found["kinds"]) <= set(MAKERS)
    # More than one check is needed to stop them all.
    assert {"check 0", "check 1", "check 2", "info 0", "info 2"} <= set(found["codes"])


@pytest.mark.parametrize("name", sorted(set(FAULTS) - SLOW))
def test_a_planted_fault_is_seen(name: str) -> None:
    said, found = _fuzz("--count", "100", "--fault", name, expect=1)
    assert FAULTS[name].shows in said
    assert found["bad"] >= 1


@pytest.mark.parametrize("kind", sorted(MAKERS))
def test_a_seed_is_the_same_file_everywhere(kind: str) -> None:
    healthy = bases([native.fmu("bumper", version).read_bytes() for version in (2, 3)])
    made = [hostile(seed, healthy, "/o", kind) for seed in (1, 2)]
    assert made == [hostile(seed, healthy, "/o", kind) for seed in (1, 2)]
    assert made[0].content != made[1].content
    assert {one.kind for one in made} == {kind}


def test_a_changed_library_is_never_run() -> None:
    healthy = bases([native.fmu("bumper", 3).read_bytes()])
    for kind in ("binary", "bytes", "directory"):
        assert not any(hostile(seed, healthy, "/o", kind).may_run for seed in range(10))
