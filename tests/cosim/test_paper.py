"""The paper's printed numbers: each has its row or its reason, and which were fitted is what the fit says."""

from __future__ import annotations

import importlib
import json
from pathlib import Path

import pytest
from giveway.base import native
from giveway.base.errors import UnknownNameError
from giveway.paper import matched as matched_module
from giveway.paper.matched import QUANTITIES, SET_BY_HAND, matched
from giveway.paper.printed import NOT_JUDGED, RESULTS
from giveway.robot.robot_file import read_robot

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/site/explanation/paper_numbers.md"


def test_ten_of_the_fits_quantities_are_the_papers() -> None:
    record = json.loads((ROOT / "robots" / "trikey.fit.json").read_text(encoding="utf-8"))
    assert [one["quantity"] for one in record["targets"]] == [one.name for one in QUANTITIES]
    assert sum(bool(one.prints) for one in QUANTITIES) == 10
    demands = [one.name for one in QUANTITIES if not one.prints]
    assert demands == [
        "peak contact force, magnetic over spring",
        "false impulse after the reversal over the threshold",
    ]


def test_the_fit_aims_at_what_is_printed() -> None:
    for quantity in QUANTITIES:
        for result in (RESULTS[name] for name in quantity.prints):
            if result.unit == "%" and quantity.unit == "1":
                assert quantity.aim == pytest.approx(1.0 + result.value / 100.0), quantity.name
            elif result.unit == quantity.unit:
                assert quantity.aim == result.value, quantity.name
            else:  # 5.5 to 10 N of 10 N: the aim is between both ends
                assert (quantity.unit, result.unit) == ("N", "%")
                low, high = (10.0 * (1.0 + RESULTS[name].value / 100.0) for name in quantity.prints)
                assert quantity.aim == pytest.approx(0.5 * (low + high))


def test_what_was_not_matched_is_what_is_predicted() -> None:
    assert [name for name in RESULTS if name not in matched()] == [
        "time to detect and reverse",
        "M_des just over the limit of tipping",
        "largest acceleration, magnetic",
        "plateau, no bumper",
        "largest deflection, moving",
    ]
    assert matched()["detection, spring"] == ("giveway fit",)
    assert "giveway fit" in matched()["magnitude error, weakest of four pushes"]


def test_what_was_set_by_hand_exists() -> None:
    of_the_robot = {name for name, _ in read_robot(native.robot()).entries()}
    for name in SET_BY_HAND:
        module, _, constant = name.rpartition(".")
        if constant.isupper():
            assert hasattr(importlib.import_module(f"giveway.experiments.{module}"), constant), name
        else:
            assert name in of_the_robot


def test_a_number_that_the_paper_does_not_print_cannot_be_matched(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(matched_module, "SET_BY_HAND", {"roller.coulomb_torque": ("B_q",)})
    with pytest.raises(UnknownNameError, match="B_q is unknown"):
        matched.__wrapped__()


def test_the_docs_name_what_no_row_judges() -> None:
    text = " ".join(PAGE.read_text(encoding="utf-8").split())
    for what, why in NOT_JUDGED.items():
        assert f"- {what}: {why}" in text, f"{PAGE.name} should say: - {what}: {why}"
