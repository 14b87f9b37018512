"""`python -m web.study_bench`: how fluid the report of a study of 20,000 designs is in Chromium, and how large."""

from __future__ import annotations

import statistics
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.base.terminal import print_columns
from giveway.study import Study
from giveway.study.report import write_report

from web.browser import Browser

if TYPE_CHECKING:
    from playwright.sync_api import Page

__all__ = ["brush_times", "many_designs"]

DESIGNS, MOVES = 20_000, 100
WIDTHS = (1300, 420)
CANVASES = {"scatter": 0.3, "parallel": None}  # where in its height the pointer moves; None: along the fifth axis
FIFTH_AXIS_PX = 30 + 74 * 4


def many_designs(folder: Path, count: int = DESIGNS) -> Path:
    """The report of a study of ``count`` designs, computed with fixed steps: a collision of 0.15 s each."""
    study = Study("many designs", duration=0.15, bumper="magnetic", method="fixed-step", noise_seed=3)
    study.collision("front", speed=0.5, mass=9.08, edge=0, time=0.1)
    study.vary("testbed.bumper.latch_force", low=0.0, high=60.0)
    study.vary("testbed.bumper.spring_rate", low=0.4, high=3.0, unit="N/mm")
    study.vary("testbed.bumper.plate_mass", low=0.05, high=0.5)
    study.vary("testbed.bumper.damping", low=0.0, high=20.0)
    study.designs("sobol", count=count)
    for metric in ("sensed torque share", "motor torque share", "energy residual"):  # the contact is not over
        study.objective(metric)
    study.constraint("sensed torque share", maximum=0.1)
    answers = study.run(folder / "study", files=False, progress=False)
    write_report(folder / "many_designs.html", answers)
    return folder / "many_designs.html"


def brush_times(tab: Page, canvas: str, moves: int = MOVES) -> list[float]:
    """Milliseconds from each move of the pointer until all views show what is selected."""
    place = tab.locator(f"canvas.{canvas}")
    place.scroll_into_view_if_needed()
    box = place.bounding_box()
    assert box is not None
    share = CANVASES[canvas]
    y = box["y"] + (FIFTH_AXIS_PX if share is None else share * box["height"])
    tab.evaluate("performance.clearMeasures('brush')")
    tab.mouse.move(box["x"] + 0.25 * box["width"], y)
    tab.mouse.down()
    for move in range(moves):
        down = 0.0 if share is None else 0.4 * box["height"] * move / moves
        tab.mouse.move(box["x"] + box["width"] * (0.25 + 0.5 * move / moves), y + down)
    tab.mouse.up()
    tab.wait_for_timeout(300.0)
    found: list[float] = tab.evaluate("performance.getEntriesByName('brush').map((one) => one.duration)")
    return found


def main(arguments: Sequence[str]) -> None:
    count = int(arguments[0]) if arguments else DESIGNS
    rows = []
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        path = many_designs(Path(folder), count)
        for width in WIDTHS:
            for canvas in CANVASES:
                with browser.page(path, width=width) as tab:
                    times = sorted(brush_times(tab, canvas))
                    found = (statistics.median(times), times[int(0.95 * len(times))])
                    rows.append((str(width), canvas, str(len(times)), *(f"{one:.0f}" for one in found)))
        size = path.stat().st_size / 1e6
    print_columns(
        f"Report of {count:,} designs, {size:.1f} MB: from the pointer's move to the selection in all views",
        ("width, px", "brush in", "moves", "median, ms", "95 %, ms"),
        rows,
    )


if __name__ == "__main__":
    main(sys.argv[1:])
