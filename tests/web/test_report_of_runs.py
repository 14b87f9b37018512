"""The report of runs in a real browser: curves that tell their values, zoom, and play beside the motion."""

from __future__ import annotations

import csv
import io
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import giveway
import numpy as np
import pytest
from giveway.base import native
from giveway.fmu_tools.page import write_run
from giveway.fmu_tools.run import run_fmu
from giveway.report import render
from giveway.simulation.result import Result
from playwright.sync_api import expect

from web.browser import WIDTHS, Browser, accessible

if TYPE_CHECKING:
    from playwright.sync_api import Page

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def results() -> list[Result]:
    experiment = giveway.experiment("motionless")
    return [giveway.run(experiment.scenario(bumper), engine="native") for bumper in ("none", "magnetic")]


@pytest.fixture(scope="module")
def path(results: list[Result], tmp_path_factory: pytest.TempPathFactory) -> Path:
    written = tmp_path_factory.mktemp("runs") / "report.html"
    written.write_text(render("motionless", "A sentence.", results), encoding="utf-8")
    return written


@pytest.fixture
def tab(browser: Browser, path: Path) -> Iterator[Page]:
    with browser.page(path) as opened:
        yield opened


def taken(tab: Page, button: str, folder: Path) -> str:
    with tab.expect_download() as waiting:
        tab.get_by_role("button", name=button, exact=True).click()
    waiting.value.save_as(folder / "taken")
    return (folder / "taken").read_text(encoding="utf-8")


def test_its_curves_are_those_of_the_run(tab: Page, results: list[Result], tmp_path: Path) -> None:
    rows = list(csv.DictReader(io.StringIO(taken(tab, "Contact force as CSV", tmp_path))))
    time, force = (
        np.array([float(row[f"magnetic spring bumper: {label}"]) for row in rows])
        for label in ("time since contact (ms)", "contact force (N)")
    )
    hit = results[1].traces
    contact_s = float(hit["testbed.truth.first_contact_time"].values[-1])
    true = np.interp(1e-3 * time + contact_s, hit["time"].values, hit["testbed.truth.contact_force"].values)
    np.testing.assert_allclose(force, true, atol=2e-3 * true.max())
    svg = taken(tab, "Contact force as SVG", tmp_path)
    drawn = ElementTree.fromstring(svg)
    assert drawn.tag.endswith("svg")
    assert "contact force (N)" in svg
    name = {"svg": "http://www.w3.org/2000/svg"}
    clip = drawn.find(".//svg:clipPath", name)
    assert clip is not None  # a zoomed curve stays within its axes
    assert drawn.find(f".//svg:g[@clip-path='url(#{clip.get('id')})']/svg:path", name) is not None


def test_a_curve_tells_its_values_and_moves_the_scene(tab: Page) -> None:
    chart = tab.get_by_role("img", name=re.compile("^Contact force"))
    chart.focus()
    for _ in range(6):
        tab.keyboard.press("Shift+ArrowRight")
    panel = tab.locator(".drawn[data-name='Contact force']")
    said = panel.locator(".said")
    found = re.fullmatch(r"no bumper: contact force ([\d.]+) N at time since contact ([\d.]+) ms", said.inner_text())
    assert found, said.inner_text()
    assert float(found[1]) > 1.0
    expect(tab.get_by_label("time shown")).to_have_text(f"{float(found[2]):.0f} ms")  # drawn in the next frame
    tab.keyboard.press("ArrowDown")
    expect(said).to_have_text(re.compile("^magnetic spring bumper: "))
    tab.keyboard.press("+")
    tab.keyboard.press("0")


def test_the_motion_plays_and_runs_can_be_chosen(tab: Page) -> None:
    tab.get_by_role("button", name="Play").click()
    tab.get_by_role("button", name="Pause").click()
    tab.get_by_label("runs").select_option("no bumper")
    expect(tab.get_by_label("time shown")).not_to_have_text("-50 ms")


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("dark", [False, True])
def test_everybody_can_read_it(browser: Browser, path: Path, width: int, dark: bool) -> None:
    folder = ROOT / "out" / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    with browser.page(path, width=width, dark=dark) as tab:
        assert accessible(tab) == []
        assert tab.evaluate("document.documentElement.scrollWidth") <= width
        tab.screenshot(path=folder / f"report_of_runs_{width}_{'dark' if dark else 'light'}.png", full_page=True)


def test_the_run_of_an_fmu_has_the_same_curves(browser: Browser, tmp_path: Path) -> None:
    out = tmp_path / "run.html"
    run = run_fmu(native.fmu("drivetrain", 3), "cs", 0.1, 0.001, ["motor.torque=6"])
    write_run(out, run)
    with browser.page(out, width=WIDTHS[0]) as tab:
        assert accessible(tab) == []
        assert tab.evaluate("document.documentElement.scrollWidth") <= WIDTHS[0]
        rows = list(csv.DictReader(io.StringIO(taken(tab, "N.m as CSV", tmp_path))))
        torque = np.array([float(row["sensor.torque: N.m"]) for row in rows])
        np.testing.assert_allclose(torque, run.traces["sensor.torque"], rtol=1e-6)  # 7 digits
