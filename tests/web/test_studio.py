"""The studio in a real browser: what it computes, gives away and takes back; a silent console, nothing fetched."""

from __future__ import annotations

import csv
import io
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import parse_qs

import giveway
import numpy as np
import pytest
from giveway.base import native
from giveway.robot import variables
from giveway.scenario.scenario_file import read_scenario
from giveway.studio.filled import studio_data, studio_page
from playwright.sync_api import expect

from web.browser import Browser, accessible, pictures
from web.studio_page import Studio

if TYPE_CHECKING:
    from playwright.sync_api import Page

MAXIMUM_BYTES = 1_000_000
DESIGN = "#robot=trikey&duration_s=0.4&around=0.3&angle_deg=20&speed_mps=0.45&time_s=0.15"


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    written = tmp_path_factory.mktemp("studio") / "studio.html"
    written.write_text(studio_page(), encoding="utf-8")
    return written


@pytest.fixture
def studio(browser: Browser, path: Path) -> Iterator[Studio]:
    with browser.page(path, hash=DESIGN) as tab:
        yield Studio(tab)


def taken(studio: Studio, button: str, folder: Path) -> Path:
    with studio.tab.expect_download() as waiting:
        studio.tab.get_by_role("button", name=button).click()
    file = folder / waiting.value.suggested_filename
    waiting.value.save_as(file)
    return file


def command(*arguments: object) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-m", "giveway", "studio", "--no-browser", *map(str, arguments)]
    return subprocess.run(words, capture_output=True, text=True, check=False)


def test_the_command_writes_it(path: Path, tmp_path: Path) -> None:
    out = tmp_path / "new" / "mine.html"
    done = command("--out", out)
    assert done.returncode == 0, done.stderr
    assert out.read_text(encoding="utf-8") == path.read_text(encoding="utf-8")
    refused = command("--out", tmp_path / "mine.txt")
    assert refused.returncode == 2
    assert "--out" in refused.stderr
    assert [one.name for one in tmp_path.iterdir()] == ["new"]


def test_the_file_is_small_and_whole(path: Path) -> None:
    assert path.stat().st_size <= MAXIMUM_BYTES
    assert not re.findall(r'(?:src|href)="(?!data:|blob:)', path.read_text())


def test_every_parameter_stands_in_one_group(studio: Studio) -> None:
    expected = {f"{m}.{v.name}" for m in native.MODELS for v in variables.table(m).select("parameter")}
    found = studio.open_groups()
    assert len(found) == len(set(found))
    assert set(found) == expected
    assert {entry["name"] for entry in studio_data()["variables"]} == expected


def test_each_parameter_has_unit_and_range(studio: Studio) -> None:
    studio.tab.get_by_label("find a parameter", exact=True).fill("bumper.spring_rate")
    row = studio.row("testbed.bumper.spring_rate")
    assert "from 1 to 1000000 N/m" in row.inner_text()
    assert row.locator(".unit").inner_text() == "N/m"


@pytest.mark.parametrize(
    "changed",
    [
        "",
        "&preset=paper&testbed.base.mass=50&region=lower+leg",
        "&robot=delivery&testbed.bumper.mount=1&testbed.start.theta=0.3&testbed.electronics.seed=5",
    ],
)
def test_its_scenario_gives_the_same_bits(browser: Browser, path: Path, tmp_path: Path, changed: str) -> None:
    with browser.page(path, hash=DESIGN + changed) as tab:
        studio = Studio(tab)
        scenario = read_scenario(taken(studio, "Scenario (TOML)", tmp_path))
        text = taken(studio, "Curves (CSV)", tmp_path).read_text()
    result = giveway.run(scenario, engine="native")
    head, *rows = csv.reader(io.StringIO(text))
    columns = dict(zip((name.partition(" [")[0] for name in head), zip(*rows, strict=True), strict=True))
    assert len(columns) > 20
    for name, values in columns.items():
        if name != "time":
            np.testing.assert_array_equal(np.array(values, float), result.traces[name].values.astype(float), name)
    assert max(map(float, columns["testbed.truth.contact_force"])) > 10.0


def test_its_parameter_set_is_the_design(studio: Studio, tmp_path: Path) -> None:
    studio.set("testbed.bumper.latch_force", "33.25")
    root = ElementTree.parse(taken(studio, "Parameter set (SSV)", tmp_path)).getroot()
    space = {"v": "http://ssp-standard.org/SSP1/SystemStructureParameterValues"}
    found = {one.get("name"): one[0] for one in root.findall("v:Parameters/v:Parameter", space)}
    assert found["testbed.bumper.latch_force"].attrib == {"value": "33.25", "unit": "N"}
    assert found["testbed.rope.attached"].get("value") == "false"
    assert {one.get("name") for one in root.findall("v:Units/*", space)} >= {"N", "m", "m/s"}


def test_a_slider_changes_the_curves_and_undo_takes_it_back(studio: Studio) -> None:
    before = studio.number("peak force of the run")
    studio.set("testbed.bumper.latch_force", "200")
    assert studio.number("peak force of the run") > before
    studio.tab.get_by_role("button", name="Undo").click()
    studio.settle()
    assert studio.number("peak force of the run") == before
    assert studio.value("testbed.bumper.latch_force") == "45.8"
    studio.tab.keyboard.press("Control+Shift+Z")
    studio.settle()
    assert studio.value("testbed.bumper.latch_force") == "200"


def test_the_mouse_moves_the_hit_around_the_outline(studio: Studio) -> None:
    before = studio.number("first contact x")
    box = studio.tab.locator("#scene canvas").bounding_box()
    assert box
    mouse = studio.tab.mouse
    mouse.move(box["x"] + box["width"] * 0.5, box["y"] + box["height"] * 0.2)
    mouse.down()
    for step in range(1, 6):  # to the left, where the outline has another side
        mouse.move(box["x"] + box["width"] * (0.5 - 0.09 * step), box["y"] + box["height"] * (0.2 + 0.08 * step))
    mouse.up()
    studio.settle()
    assert studio.number("first contact x") < before - 50.0
    studio.tab.get_by_role("button", name="Undo").click()  # the whole drag is one step
    studio.settle()
    assert studio.number("first contact x") == before


def test_the_address_is_the_design(browser: Browser, path: Path, studio: Studio) -> None:
    studio.set("testbed.bumper.spring_rate", "700")
    studio.tab.get_by_role("button", name="Compare with a second design").click()
    studio.set("testbed.bumper.spring_rate", "1500")
    travels = studio.numbers("bumper compression")
    address = studio.address()
    assert parse_qs(address)["b.testbed.bumper.spring_rate"] == ["1500"]
    with browser.page(path, hash=f"#{address}") as tab:
        assert Studio(tab).numbers("bumper compression") == travels
    assert len(set(travels)) == 2


def test_what_an_address_cannot_say_is_named(browser: Browser, path: Path) -> None:
    with browser.page(path, hash="#testbed.slider.mass=-1&testbed.slider.weight=2&speed_mps=90&robot=hal") as tab:
        said = tab.get_by_role("alert").inner_text()
    assert "testbed.slider.mass = -1 is not allowed: a number from 0.1 to 1000 kg" in said
    assert "testbed.slider.weight = 2 is not allowed" in said
    assert "speed_mps = 90 is not allowed: a number from 0.05 to 2 m/s" in said
    assert "robot = hal is not allowed: trikey" in said


def test_a_design_that_is_not_possible_says_why(studio: Studio) -> None:
    studio.set("testbed.rope.attached", "true")
    studio.move("speed at the contact", "2")
    assert "reaches only" in studio.tab.get_by_role("alert").inner_text()
    studio.move("speed at the contact", "0.5")
    assert studio.tab.get_by_role("alert").count() == 0


def test_the_keyboard_is_enough(studio: Studio) -> None:
    tab = studio.tab
    tab.locator("#scene canvas").focus()
    shown = tab.get_by_label("time shown")
    tab.keyboard.press("Home")
    expect(shown).to_have_text("0 ms")  # drawn in the next frame
    tab.keyboard.press("ArrowRight")
    expect(shown).to_have_text("5 ms")
    tab.keyboard.press(" ")
    tab.get_by_role("button", name="Pause").wait_for()
    tab.keyboard.press(" ")
    tab.get_by_role("button", name="Play").wait_for()
    before = studio.number("first contact x")
    tab.get_by_label("place around the outline").focus()
    tab.keyboard.press("PageUp")
    studio.settle()
    assert studio.number("first contact x") != before


def test_curves_zoom_tell_values_and_can_be_taken(studio: Studio, tmp_path: Path) -> None:
    tab = studio.tab
    plot = tab.get_by_role("img", name=re.compile("^Contact force"))
    plot.focus()
    tab.keyboard.press("ArrowRight")
    assert re.search(r"\d N", tab.locator(".curve").first.locator(".u-legend").inner_text())
    svg = taken(studio, "Contact force as SVG", tmp_path).read_text()
    assert ElementTree.fromstring(svg).tag.endswith("svg")
    assert "Contact force, N" in svg
    rows = taken(studio, "Contact force as CSV", tmp_path).read_text().splitlines()
    assert rows[0] == 'time [ms],"force, true [N]",estimated [N]'
    assert len(rows) == 402


@pytest.mark.parametrize("dark", [False, True])
def test_it_can_be_read_by_everybody(browser: Browser, path: Path, dark: bool) -> None:
    with browser.page(path, hash=DESIGN + "&region=lower+leg&b.speed_mps=0.3", dark=dark) as tab:
        Studio(tab).open_groups(1)
        assert accessible(tab) == []


@pytest.mark.parametrize("width", [420, 1300])
def test_nothing_is_cut_off(browser: Browser, path: Path, width: int) -> None:
    with browser.page(path, hash=DESIGN, width=width) as tab:
        assert overflowing(tab) == []


def test_pictures_are_written(browser: Browser, path: Path, tmp_path: Path) -> None:
    assert len(pictures(browser, path, "studio")) == 4


def overflowing(tab: Page) -> list[str]:
    """What is wider than the page, or than the box that holds it and does not scroll."""
    found: list[str] = tab.evaluate(
        """() => [...document.querySelectorAll("body *")]
            .filter((one) => one.getBoundingClientRect().right > innerWidth + 1 && !one.closest(".scroll, .hidden"))
            .map((one) => one.outerHTML.slice(0, 120))"""
    )
    return found
