"""Demo, summary and report: the same numbers everywhere, in one file that needs nothing else."""

from __future__ import annotations

import html
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import giveway
import pytest
from cosim_helpers import Cli, folder_content
from giveway.library.batch_library import native_metrics
from giveway.report import render
from giveway.report.animation import scene
from giveway.simulation.metrics import Metric
from giveway.simulation.result import Result
from giveway.simulation.summary import cell, number, summary, table_rows
from page_arrays import data_of

MAXIMUM_BYTES = 3_000_000
SCENE = Path(__file__).parents[2] / "web" / "src" / "parts" / "scene.ts"


class References(HTMLParser):
    """Collects everything in a page that points somewhere, and all ids."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.ids: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        del tag
        for name, value in attrs:
            if name in ("src", "href", "xlink:href", "action", "data") and value:
                self.links.append(value)
            if name == "id" and value:
                self.ids.append(value)


@pytest.fixture(scope="module")
def page(full_runs: dict[str, Result]) -> str:
    return render("motionless", "A sentence.", list(full_runs.values()))


def test_the_report_needs_nothing_else(page: str) -> None:
    references = References()
    references.feed(page)
    ids = set(references.ids)
    assert len(ids) == len(references.ids)  # figures must not share ids
    assert all(link.startswith("#") and link[1:] in ids for link in references.links)
    assert not re.search(r"url\((?!#)|@import|https?://(?!www\.w3\.org)", page)


def test_the_report_is_small_and_whole(page: str) -> None:
    assert len(page.encode()) < MAXIMUM_BYTES
    data = data_of(page)
    assert page.count('class="drawn"') == len(data["figures"]) == 4
    assert page.rstrip().endswith("</html>")


def test_the_report_says_what_each_number_is(page: str, full_runs: dict[str, Result]) -> None:
    words = {metric.name: metric.description for metric in native_metrics()}
    text = html.unescape(page)
    for metric in full_runs["none"].metrics:
        assert f"<tr><th>{metric.name}</th><td>{words[metric.name]}</td></tr>" in text


def test_the_animation_data_is_json_with_the_detection(page: str, full_runs: dict[str, Result]) -> None:
    scenes = [scene("a run", run) for run in full_runs.values()]
    for drawn, given in zip(data_of(page)["scenes"], scenes, strict=True):
        assert drawn["time"] == given["time"]
        assert drawn["robot"]["outline"] == given["outline"]
        assert drawn["traces"]["testbed.truth.x"] == given["base"][0]
        assert {len(values) for values in drawn["traces"].values()} == {len(given["time"])}
        needed = re.findall(r'"((?:estimate|detection)\.\w+)"', SCENE.read_text(encoding="utf-8"))
        assert {name.removeprefix("controller.") for name in given["felt"]} == set(needed)
    for one, run in zip(scenes, full_runs.values(), strict=True):
        assert len(one["outline"]) == 3
        assert 1e3 * one["touches"][0]["detection"]["time"] == pytest.approx(
            run.metric("detection time").value, abs=0.1
        )
        assert len(one["time"]) == len(one["base"][0]) == len(one["force"][1])


def test_an_interrupted_run_says_so_in_its_report(short_run: Result) -> None:
    manifest = {**short_run.manifest, "interrupted": True}
    assert "was interrupted" in render(
        "motionless", "A sentence.", [Result(short_run.traces, short_run.metrics, manifest)]
    )
    assert "was interrupted" not in render("motionless", "A sentence.", [short_run])


def test_demo_writes_what_it_prints(process: Cli, tmp_path: Path) -> None:
    done = process("demo")
    assert done.returncode == 0, done.stderr
    lines = ["[1 of 4] bumper none", "[2 of 4] bumper spring", "[3 of 4] bumper magnetic", "[4 of 4] report"]
    assert done.stderr.splitlines() == lines
    out = tmp_path / "out" / "demo"
    assert {"report.html", "overview.png", "summary.json", "none", "spring", "magnetic"} <= set(folder_content(out))
    document = json.loads((out / "summary.json").read_text())
    assert document["schema_version"] == 1
    results = {bumper: giveway.load(out / bumper) for bumper in ("none", "spring", "magnetic")}
    assert document == summary(results)
    printed = [line.split() for line in done.stdout.splitlines()]
    for row in table_rows(results):
        assert " ".join(row).split() in printed


def test_every_number_of_the_table_is_in_the_summary(full_runs: dict[str, Result]) -> None:
    rows = summary(full_runs)["rows"]
    for index, (name, *cells) in enumerate(table_rows(full_runs)):
        for column, text in enumerate(cells):
            row = rows[column * len(table_rows(full_runs)) + index]
            assert set(row) == {"bumper", "name", "value", "unit", "truth"}
            assert name.startswith(row["name"])
            decimals = full_runs[row["bumper"]].metric(row["name"]).decimals
            assert text.startswith(number(row["value"], decimals))


@pytest.mark.parametrize(
    ("value", "decimals", "text"),
    [(None, 1, "-"), (12.345, 1, "12.3"), (-3.0, 0, "-3"), (-0.04, 1, "0.0"), (1.2e-7, None, "1.2e-07")],
)
def test_numbers_as_text(value: float | None, decimals: int | None, text: str) -> None:
    assert number(value, decimals) == text


def test_a_cell_shows_the_truth_in_brackets() -> None:
    assert cell(Metric("x", 1.0, "m", 2.0, 1)) == "1.0 (2.0)"
    assert cell(Metric("x", 1.0, "m", None, 1)) == "1.0"
    assert cell(Metric("x", None, "m", 2.0, 1)) == "- (2.0)"


def test_run_can_be_loaded_again(cli: Cli, tmp_path: Path) -> None:
    arguments = ("run", "motionless", "--bumper", "spring", "--out", "r", "--duration", "0.3", "--fmi", "2")
    done = cli(*arguments, "--set", "testbed.base.mass=36", "--seed", "5")
    assert done.returncode == 0, done.stderr
    result = giveway.load(tmp_path / "r")
    assert result.manifest["parameters"]["testbed"]["base.mass"] == 36.0
    assert result.manifest["seed"] == 5
    assert result.manifest["scenario"]["fmi_version"] == 2
    assert cli(*arguments).returncode == 0  # its own earlier result may be replaced


def test_lists_and_version(process: Cli) -> None:
    assert process("--version").stdout == f"giveway {giveway.__version__}\n"
    assert "motionless" in process("list").stdout
    listed = process("variables", "testbed", "--grep", "slider.mass").stdout
    assert "slider.mass" in listed
    assert "kg" in listed
    assert "base.mass" not in listed


@pytest.mark.deep
def test_bench_prints_all_parts(process: Cli) -> None:
    done = process("bench", "--repeats", "1")
    assert done.returncode == 0, done.stderr
    for part in ("run", "stepping", "testbed FMU", "controller FMU", "ERK", "Adams", "BDF"):
        assert part in done.stdout
    assert len(done.stderr.splitlines()) == 4  # each of its parts is announced
