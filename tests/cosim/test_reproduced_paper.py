"""The reproduction at full effort: the site tells its predictions and counts; every printed number has its row."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from giveway.experiments.reproduction.reproduce import Reproduction, reproduce
from giveway.paper.printed import RESULTS, Printed

PAGE = Path(__file__).parents[2] / "docs" / "site" / "explanation" / "paper_numbers.md"
BEGIN, END = "<!-- counts: giveway reproduce -->\n", "<!-- end of counts -->"


@pytest.fixture(scope="module")
def reproduction() -> Reproduction:
    found = reproduce(threads=os.cpu_count() or 1)
    assert not found.failed
    return found


def page() -> str:
    return PAGE.read_text(encoding="utf-8")


def test_the_page_tells_every_prediction() -> None:
    found = reproduce(["motionless", "tipping", "moving"])  # which have them all: the deep test below counts them
    predicted = [row for _, row in found.rows() if row.kind == "predicted"]
    assert f"- predicted: {sum(row.met is True for row in predicted)} met of {len(predicted)}\n" in page()
    for row in predicted:
        assert f"{row.ours:.{row.decimals}f} instead of" in " ".join(page().split()), row.quantity


@pytest.mark.deep
def test_every_number_of_the_paper_has_a_row(reproduction: Reproduction) -> None:
    judged = {row.paper.name for _, row in reproduction.rows() if isinstance(row.paper, Printed)}
    assert judged == set(RESULTS)


@pytest.mark.deep
def test_every_miss_has_its_reason(reproduction: Reproduction) -> None:
    assert [row.quantity for _, row in reproduction.rows() if row.met is False and not row.reason] == []


@pytest.mark.deep
def test_the_page_tells_the_counts(reproduction: Reproduction) -> None:
    text = page()
    told = text[text.index(BEGIN) + len(BEGIN) : text.index(END)]
    expected = "".join(f"- {line}\n" for line in reproduction.summary())
    assert told == expected, f"the page should show\n{expected}"
