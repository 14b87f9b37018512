"""What c_core costs on Cortex-M is what its texts say, as `make verify` measured it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from verify import footprint
from verify.rung import RungFailed

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def recorded() -> dict[str, int]:
    """Of these sources: tests/verify/test_verified.py."""
    document = json.loads((ROOT / "c_core" / "VERIFIED.json").read_text(encoding="utf-8"))
    values: dict[str, int] = document["rungs"]["footprint"]["values"]
    return values


def test_the_texts_show_what_was_measured(recorded: dict[str, int]) -> None:
    footprint.check(ROOT, recorded)


def test_each_number_that_was_measured_is_shown(recorded: dict[str, int]) -> None:
    for name in recorded:
        with pytest.raises(RungFailed, match=r"does not show what was measured|README.md says"):
            footprint.check(ROOT, {**recorded, name: recorded[name] + 1})


LISTING = """
00000000 <gw_top>:
   0:\tpush\t{r4, r5, lr}
   2:\tsub\tsp, #20
   4:\tbl\t10 <gw_middle>
   8:\tbl\t20 <memcpy>

00000010 <gw_middle>:
  10:\tvpush\t{d8-d9}
  14:\tb.w\t20 <memcpy>

00000020 <memcpy>:
  20:\tstr\tr4, [sp, #-16]!
"""


def test_worst_stack_is_that_of_the_deepest_chain() -> None:
    # 3 registers and 20 bytes; 2 doubles; 16 bytes.
    assert footprint.worst_stack(LISTING, {}, "gw_top") == 32 + 16 + 16
    # For the compiler's functions the compiler's figures count.
    assert footprint.worst_stack(LISTING, {"gw_top": 100, "gw_middle": 8}, "gw_top") == 100 + 8 + 16


def test_recursion_has_no_worst_stack() -> None:
    with pytest.raises(RungFailed, match="recursion: gw_top -> gw_middle -> memcpy -> gw_top"):
        footprint.worst_stack(LISTING + "  24:\tb.w\t0 <gw_top>\n", {}, "gw_top")
