"""The report of a study in a real browser: one selection, designs computed with the bits that the study has stored."""

from __future__ import annotations

import csv
import io
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from giveway.library.batch_library import native_metrics
from giveway.simulation.runner import run
from giveway.study import Study
from giveway.study.answers import Answers
from giveway.study.chosen import scenario_of_run
from giveway.study.report import write_report
from playwright.sync_api import expect
from study_helpers import LATCH, SPRING, stored_runs

from web.browser import WIDTHS, Browser, accessible
from web.study_bench import brush_times, many_designs

if TYPE_CHECKING:
    from playwright.sync_api import Page

ROOT = Path(__file__).parents[2]
MAXIMUM_BYTES = 6_000_000
PEAK, TRAVEL = "peak force of the run", "bumper compression"


def study_of(method: Any = "event-exact") -> Study:
    """Twelve designs with two hits each on a moving robot; limits in other units; a travel that is too short."""
    plan = {"kind": "straight", "direction": 0.0, "speed": 0.2}
    study = Study("answers back", duration=0.6, bumper="magnetic", plan=plan, method=method)
    study.collision("front", speed=0.5, mass=9.08, edge=0, time=0.12)
    study.collision("slow", speed=0.3, mass=4.0, edge=1, offset=0.05, time=0.12)
    study.vary(LATCH, values=[0.0, 20.0, 40.0]).vary(SPRING, values=[0.6, 2.4], unit="N/mm")
    study.vary("testbed.bumper.travel", values=[0.12, 0.005]).tolerance(LATCH, relative=0.3)
    study.tolerances(samples=1).objective("detection time").objective(PEAK).sure(probability=False)
    return study.constraint(TRAVEL, maximum=3.0, unit="cm").constraint(PEAK, maximum=0.4, unit="kN")


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Answers:
    return study_of().run(tmp_path_factory.mktemp("reports") / "study", files=False, progress=False)


@pytest.fixture(scope="module")
def path(answers: Answers) -> Path:
    write_report(answers.folder / "report.html", answers)
    return answers.folder / "report.html"


@pytest.fixture
def tab(browser: Browser, path: Path) -> Iterator[Page]:
    with browser.page(path) as opened:
        yield opened


def taken(tab: Page, button: str, folder: Path) -> str:
    with tab.expect_download() as waiting:
        tab.get_by_role("button", name=button, exact=True).click()
    waiting.value.save_as(folder / "taken")
    return (folder / "taken").read_text(encoding="utf-8")


def show(tab: Page, design: int) -> None:
    """Compute a design, by a click on its row."""
    tab.get_by_label("find designs").fill("")
    tab.locator("#designs tbody tr").filter(has=tab.get_by_role("rowheader", name=str(design), exact=True)).click()
    tab.locator(f"#beside[data-shown$='{design}']").wait_for()


def metrics_of(text: str, design: int) -> dict[str, float]:
    return {row["metric"]: float(row[f"design {design}"] or "nan") for row in csv.DictReader(io.StringIO(text))}


def column(tab: Page, number: int) -> list[str]:
    return tab.locator(f"#designs tbody tr:not([hidden]) > :nth-child({number})").all_inner_texts()


def box_of(tab: Page, canvas: str) -> dict[str, float]:
    place = tab.locator(f"canvas.{canvas}")
    place.evaluate("(one) => one.scrollIntoView()")
    box = place.bounding_box()
    assert box is not None
    return {"x": box["x"], "y": box["y"], "width": box["width"], "height": box["height"]}


@pytest.mark.parametrize("method", ["event-exact", "fixed-step"])
def test_a_design_that_the_page_computes_has_the_stored_bits(
    browser: Browser, answers: Answers, path: Path, tmp_path: Path, method: str
) -> None:
    if method != "event-exact":
        answers = study_of(method).run(tmp_path / "study", files=False, progress=False)
        path = tmp_path / "report.html"
        write_report(path, answers)
    stored, chosen = stored_runs(answers.folder), int(answers.order[0])
    latch = answers.designs[:, 0]
    other = next(design for design in answers.order.tolist() if latch[design] != latch[chosen])
    with browser.page(path) as tab:
        for case, collision in enumerate(("front", "slow")):
            tab.get_by_label("collision shown").select_option(collision)
            show(tab, other)
            expect(tab.locator("#beside")).to_have_attribute("data-same", "true true")
            text = taken(tab, "numbers of these designs as CSV", tmp_path)
            for design in (chosen, other):
                row = int(np.flatnonzero((stored["design"] == design) & (stored["tolerance sample"] == 0))[case])
                found = metrics_of(text, design)
                assert len(found) > len(native_metrics())
                for name, value in found.items():
                    np.testing.assert_array_equal(value, stored[name][row], name)


@pytest.mark.parametrize(
    ("mass", "words"),
    [("9.5", "not all bits are those that the study has stored"), ("-1", "cannot be computed: testbed.slider.mass")],
)
def test_what_is_not_as_stored_is_said(browser: Browser, path: Path, tmp_path: Path, mass: str, words: str) -> None:
    page = path.read_text(encoding="utf-8")
    changed = re.sub(r'("testbed.slider.mass":)[\d.]+', rf"\g<1>{mass}", page, count=1)
    assert changed != page
    (tmp_path / "study.html").write_text(changed, encoding="utf-8")
    with browser.page(tmp_path / "study.html") as tab:
        assert words in tab.locator("#beside").inner_text()
        assert "true" not in str(tab.locator("#beside").get_attribute("data-same"))


def test_curves_are_those_of_the_design_in_the_user_s_units(tab: Page, answers: Answers, tmp_path: Path) -> None:
    chosen = int(answers.order[0])
    text = taken(tab, "contact force as CSV", tmp_path)
    rows = list(csv.DictReader(io.StringIO(text)))
    force = run(scenario_of_run(answers.setup, answers.runs, chosen), engine="native").traces
    found = np.array([float(row[f"design {chosen} [kN]"]) for row in rows])
    assert 1e3 * found.max() == pytest.approx(force["testbed.truth.contact_force"].values.max(), rel=1e-12)
    times = np.array([float(row["time since the contact [ms]"]) for row in rows])
    assert (times[0], times[-1]) == (pytest.approx(-20.0, abs=1.0), pytest.approx(250.0, abs=1.0))
    assert (found[times < -0.01] == 0.0).all()
    assert found[np.searchsorted(times, 2.0)] > 0.0


def test_curves_fit_their_places_when_a_design_comes_beside(tab: Page, answers: Answers) -> None:
    show(tab, int(answers.order[1]))
    widths = tab.locator("#beside figure.curve").evaluate_all(
        "(all) => all.map((one) => [one.clientWidth, one.querySelector('.uplot canvas').clientWidth])"
    )
    assert len(widths) == 4
    for room, curve in widths:
        assert room - 1 <= curve <= room  # whole pixels


def test_the_scene_says_the_detection_time_of_the_table(tab: Page, answers: Answers, tmp_path: Path) -> None:
    stored, chosen = stored_runs(answers.folder), int(answers.order[0])
    times_ms = stored["detection time"].reshape(12, -1)[:, 0]  # nominal, of the first collision
    design = int(np.nanargmax(np.abs(times_ms - np.round(times_ms))))  # samples are at whole milliseconds
    assert design != chosen
    show(tab, design)
    told = taken(tab, "numbers of these designs as CSV", tmp_path)
    wanted = {f"noticed after {metrics_of(told, one)['detection time']:.1f} ms" for one in (chosen, design)}
    assert f"noticed after {times_ms[design]:.1f} ms" in wanted
    tab.evaluate(
        """() => {
          const pen = CanvasRenderingContext2D.prototype, fill = pen.fillText;
          window.drawn = [];
          pen.fillText = function (text, ...where) { window.drawn.push(text); fill.call(this, text, ...where); };
        }"""
    )
    tab.locator("#beside .scene canvas").press("End")
    expect(tab.get_by_label("time shown")).not_to_have_text("0 ms")
    said = tab.evaluate("() => window.drawn.filter((text) => text.startsWith('noticed after'))")
    assert {text.split(",")[0] for text in said} == wanted


def test_a_brush_is_seen_in_all_views(tab: Page, answers: Answers) -> None:
    said = tab.locator("#selection").get_by_role("status")
    expect(said).to_have_text("12 of 12 designs selected")
    box = box_of(tab, "scatter")
    tab.mouse.move(box["x"] + 70, box["y"] + 0.5 * box["height"])
    tab.mouse.down()
    tab.mouse.move(box["x"] + box["width"] - 20, box["y"] + box["height"] - 50, steps=4)
    tab.mouse.up()
    tab.get_by_text("Ranges as numbers").click()
    name = "peak force of the run, worst collision, worst of tolerances (kN)"
    low, high = (tab.get_by_label(f"{end} {name}").input_value() for end in ("lowest", "highest"))
    peak = 1e-3 * answers.values[:, 1]
    inside = np.flatnonzero((peak >= float(low)) & (peak <= float(high)))
    assert 0 < len(inside) < 12
    expect(said).to_have_text(f"{len(inside)} of 12 designs selected")
    assert sorted(map(int, column(tab, 1))) == inside.tolist()
    tab.get_by_label(f"lowest {name}").fill("1000")
    tab.get_by_label(f"lowest {name}").press("Enter")
    tab.get_by_text("none of 12 designs is selected").wait_for()
    tab.get_by_role("button", name="Select all").click()
    tab.get_by_text("12 of 12 designs selected").wait_for()
    tab.get_by_label("among").select_option("front")
    tab.get_by_text(f"{answers.pareto.sum()} of 12 designs selected").wait_for()


def test_an_axis_is_a_brush_too(tab: Page, answers: Answers) -> None:
    box = box_of(tab, "parallel")
    tab.mouse.move(box["x"] + 8, box["y"] + 30)
    tab.mouse.down()
    tab.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 30, steps=3)
    tab.mouse.up()
    tab.get_by_text("8 of 12 designs selected").wait_for()
    assert set(column(tab, 3)) == {"0", "20"}  # N of latch force
    tab.mouse.click(box["x"] + 50, box["y"] + 30)
    tab.get_by_text("12 of 12 designs selected").wait_for()


def test_the_table_sorts_and_finds(tab: Page, answers: Answers) -> None:
    first = [int(text) for text in column(tab, 1)]
    assert first[: len(answers.order)] == answers.order.tolist()
    head = tab.get_by_role("button", name="detection time, worst collision, worst of tolerances (ms)")
    head.click()
    times = [float(text) for text in column(tab, 6) if text != "-"]
    assert times == sorted(times)
    head.click()
    assert tab.locator("#designs th[aria-sort=descending]").count() == 1
    times = [float(text) for text in column(tab, 6) if text != "-"]
    assert times == sorted(times, reverse=True)
    tab.get_by_label("find designs").fill("bottomed")
    warned = sorted(design for design, codes in answers.warnings.items() if "bumper bottomed" in codes)
    assert sorted(map(int, column(tab, 1))) == warned != []


def test_the_keyboard_is_enough(tab: Page, answers: Answers) -> None:
    tab.locator("canvas.scatter").focus()
    tab.keyboard.press("ArrowRight")
    tip = tab.locator(".tip")
    design = re.match(r"design (\d+)", tip.inner_text())
    assert design
    assert f"bumper.spring_rate (N/mm): {answers.shown_designs(1)[int(design[1])]:g}" in tip.inner_text()
    tab.keyboard.press("Enter")
    tab.locator(f"#beside[data-shown$='{design[1]}']").wait_for()
    assert tab.url.endswith(f"#design={design[1]}")


def test_an_address_opens_its_design(browser: Browser, path: Path, answers: Answers) -> None:
    with browser.page(path, hash="#design=7") as tab:
        expect(tab.locator("#beside")).to_have_attribute("data-shown", f"{answers.order[0]} 7")


def test_pictures_and_tables_can_be_taken(tab: Page, answers: Answers, tmp_path: Path) -> None:
    for name, words in (("trade-off", "peak force of the run"), ("parallel coordinates", "bumper.spring_rate (N/mm)")):
        svg = taken(tab, f"{name} as SVG", tmp_path)
        assert ElementTree.fromstring(svg).tag.endswith("svg")
        assert words in svg
        assert "at most 3 cm" in svg or name == "trade-off"
    rows = list(csv.DictReader(io.StringIO(taken(tab, "selected designs as CSV", tmp_path))))
    assert [int(row["design"]) for row in rows[: len(answers.order)]] == answers.order.tolist()
    for row in rows:
        shown = float(row["peak force of the run, worst collision, worst of tolerances [kN]"] or "nan")
        np.testing.assert_equal(shown, answers.goal_unit(1).of(answers.values[int(row["design"]), 1]))


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("dark", [False, True])
def test_everybody_can_read_it(browser: Browser, path: Path, width: int, dark: bool) -> None:
    folder = ROOT / "out" / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    with browser.page(path, width=width, dark=dark) as tab:
        assert accessible(tab) == []
        assert tab.evaluate("document.documentElement.scrollWidth") <= width
        tab.screenshot(path=folder / f"report_of_a_study_{width}_{'dark' if dark else 'light'}.png", full_page=True)


def test_thousands_of_designs_are_small_and_quick(browser: Browser, tmp_path: Path) -> None:
    path = many_designs(tmp_path, 1000)
    assert path.stat().st_size < MAXIMUM_BYTES * (0.5 + 0.5 * 1000 / 20_000)
    with browser.page(path) as tab:
        times = brush_times(tab, "scatter", 20)
        assert tab.locator("#selection").get_by_role("status").inner_text().endswith("of 1,000 designs selected")
    assert len(times) > 5
