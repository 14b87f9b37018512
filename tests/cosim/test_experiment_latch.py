"""What the magnetic latch costs in the first 60 ms, reduced: the rows against the definition, and their reason."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from giveway import batch, experiments
from giveway.experiments import latch
from giveway.experiments.reproduction.findings import Effort, Findings
from giveway.simulation.result import Result

KINDS = ("spring", "magnetic spring")


@pytest.fixture(scope="module")
def findings() -> Findings:
    reproduce = experiments.get("latch").reproduce
    assert reproduce is not None
    return reproduce(Effort(full=False))


def row(findings: Findings, quantity: str) -> float:
    (found,) = [one for one in findings.rows if one.quantity == quantity]
    assert found.ours is not None
    return found.ours


def first_60_ms(result: Result) -> float:
    """Largest contact force of the first 60 ms of contact, N."""
    time_s = result.traces["time"].values
    contact_s = float(result.traces["testbed.truth.first_contact_time"].values[-1])
    force = result.traces["testbed.truth.contact_force"].values
    return float(np.max(force[(time_s > contact_s) & (time_s < contact_s + 0.06)]))


def test_the_rows_are_the_force_of_the_first_60_ms(findings: Findings) -> None:
    spring, magnetic = (first_60_ms(batch.run(latch.pulled(bumper))) for bumper in ("spring", "magnetic"))
    assert row(findings, "force of the first 60 ms, 5.2, spring") == pytest.approx(spring)
    assert row(findings, "force of the first 60 ms, 5.2, magnetic spring") == pytest.approx(magnetic)
    assert row(findings, "the latch raises it by, 5.2") == pytest.approx(100.0 * (magnetic / spring - 1.0))


def test_the_page_tells_what_it_costs(findings: Findings) -> None:
    page = Path(__file__).parents[2] / "docs" / "site" / "explanation" / "paper_numbers.md"
    text = " ".join(page.read_text(encoding="utf-8").split())
    for case in ("5.2", "0.2 m/s"):
        spring, magnetic = (row(findings, f"force of the first 60 ms, {case}, {one}") for one in KINDS)
        assert f"{magnetic:.0f} instead of {spring:.0f} N" in text
    assert f"noticed {row(findings, 'the latch is noticed earlier by, 5.2'):.0f} ms before the plain spring" in text


def test_the_shipped_latch_costs_force_at_every_speed(findings: Findings) -> None:
    raised = [one for one in findings.rows if one.quantity.startswith("the latch raises it by")]
    assert [one.met for one in raised] == [False] * 3
    assert all(one.kind == "own requirement" for one in raised)


def test_the_reason_names_latches_that_cost_nothing(findings: Findings) -> None:
    (found,) = {one.reason for one in findings.rows if one.met is False}
    shipped = re.search(r"0\.5 kg on 0\.948 N/mm: up to (\d+) N at 0\.5 m/s", found)
    assert shipped is not None
    weak = float(shipped[1])
    assert weak < 45.8

    def force(latch_n: float) -> float:
        return first_60_ms(batch.run(latch.free_slider("magnetic", 0.5, {"bumper.latch_force": latch_n})))

    assert force(weak) <= 1.05 * force(0.0)
    assert force(weak + 5.0) > 1.05 * force(0.0)
