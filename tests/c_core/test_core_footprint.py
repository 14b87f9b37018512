"""What c_core costs on a Cortex-M4F is what its texts say; `make verify` measures the other processors."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from verify import footprint
from verify.context import Context
from verify.rung import RungFailed
from verify.targets import TARGETS

ROOT = Path(__file__).parents[2]


def test_the_texts_show_what_is_measured(tmp_path: Path) -> None:
    context = Context(ROOT, tmp_path, os.environ["PATH"])
    m4f = TARGETS["cortex-m4f"]
    footprint.check_table(ROOT, {m4f.name: footprint.measure(context, m4f)})
    footprint.check_parts(ROOT, footprint.measure_parts(context, m4f), footprint.measure_steps(context, m4f))


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
