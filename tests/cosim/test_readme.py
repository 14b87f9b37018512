"""The README's result table is what the committed code computes."""

from __future__ import annotations

import re
from pathlib import Path

from giveway.report.overview import numbers
from giveway.simulation.result import Result
from giveway.simulation.summary import table_rows
from PIL import Image

README = Path(__file__).parents[2] / "README.md"
BEGIN, END = "<!-- table: giveway demo -->\n", "<!-- end of table -->"
# Everything that `giveway demo` prints, less what is only there to check the run.
LEFT_OUT = {"false detections", "energy residual", "direction error, deg", "peak torque, any sign, N.m"}


def markdown(results: dict[str, Result]) -> str:
    rows = [("", "no bumper", "spring", "magnetic"), ("---",) * 4]
    rows += [row for row in table_rows(results) if row[0] not in LEFT_OUT]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def test_readme_shows_the_computed_table(full_runs: dict[str, Result]) -> None:
    text = README.read_text(encoding="utf-8")
    shown = text[text.index(BEGIN) + len(BEGIN) : text.index(END)]
    expected = markdown(full_runs)
    assert shown == expected, f"README.md should show\n{expected}"


def test_the_picture_is_of_these_runs(full_runs: dict[str, Result]) -> None:
    """docs/overview.png is out/demo/overview.png of `make demo`; it carries its numbers."""
    with Image.open(README.parent / "docs" / "overview.png") as picture:
        assert picture.info["Description"] == numbers(full_runs)


def test_readme_links_lead_somewhere() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", README.read_text(encoding="utf-8")):
        assert (README.parent / target).exists(), target
