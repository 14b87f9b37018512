"""A native test that hangs fails in minutes, instead of holding up everything after it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
BUILD = Path(os.environ.get("GIVEWAY_BUILD_DIR", ROOT / "build"))


def test_ctest_ends_every_native_test() -> None:
    command = [Path(sys.executable).parent / "ctest", "--test-dir", BUILD, "--verbose", "--tests-regex"]
    one_of_each = "^(batch_test|c_core.float.unit|Noise.PhiloxGivesItsPublishedAnswers)$"  # by hand, and found by gtest
    said = subprocess.run([*command, one_of_each], capture_output=True, text=True, check=True, timeout=300).stdout
    limits = [float(found) for found in re.findall(r"Test timeout computed to be: (\S+)", said)]
    assert len(limits) == 3, said
    assert max(limits) <= 120.0
