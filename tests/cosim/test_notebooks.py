"""How results show themselves in Jupyter, and the notebooks of `docs/notebooks`, executed as they are."""

from __future__ import annotations

import dataclasses
import html.parser
import json
import math
import os
from pathlib import Path
from typing import Any

import giveway
import nbformat
import numpy as np
import pytest
from figure_labels import check_panels, check_planted, curve
from giveway.base.in_notebooks import ShownInNotebooks
from giveway.drivetrain.analysis import analyse
from giveway.drivetrain.model import read
from giveway.notebook.page import _designs, _forces, html_of
from giveway.scenario.plan import Pushes, TimedPush
from giveway.simulation.result import Result
from giveway.simulation.run_warnings import RunWarning
from nbclient import NotebookClient
from study_helpers import judged_study, small_study

FOLDER = Path(__file__).parents[2] / "docs" / "notebooks"
NAMES = ("bumper_study", "drivetrain", "first_push")
EVIL = "<script>alert('1')</script>&"


class Page(html.parser.HTMLParser):
    """Tags in their order, each closed, and texts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: list[str] = []
        self.images: list[dict[str, str | None]] = []
        self.texts: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append(tag)
        if tag == "img":
            self.images.append(dict(attrs))
        else:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def shown(thing: ShownInNotebooks) -> Page:
    return Page(thing._repr_html_())


def test_a_run_shows_picture_table_and_no_warnings(short_run: Result) -> None:
    page = shown(dataclasses.replace(short_run, warnings=()))  # the short one ends during its contact
    [image] = page.images
    assert str(image["src"]).startswith("data:image/png;base64,")
    assert "peak force of the run, N" in page.texts
    assert "Warnings" not in page.texts
    assert "script" not in page.seen


def test_texts_from_outside_are_escaped(short_run: Result) -> None:
    manifest = {**short_run.manifest, "scenario": {**short_run.manifest["scenario"], "name": EVIL}}
    evil = dataclasses.replace(short_run, manifest=manifest, warnings=(RunWarning("code", EVIL),))
    page = shown(evil)
    assert "script" not in page.seen
    joined = "".join(page.texts)
    assert joined.count(EVIL) == 2
    assert "Warnings" in page.texts


def test_a_run_of_pushes_shows_them() -> None:
    push = TimedPush(20.0, 0.0, -0.176, 0.0, 0.3, 0.2)
    scenario = giveway.Scenario("by hand", 0.7, bumper="none", push=Pushes((push,)))
    result = giveway.run(scenario, engine="native")
    page = shown(result)
    assert page.seen.count("table") == 2
    assert any("20 N at 0.3 s" in text for text in page.texts)
    figure = _forces(result)
    forces = [
        np.hypot(*(result.traces[f"{name}_{axis}"].values for axis in "xy"))
        for name in ("testbed.push.force", "controller.estimate.force")
    ]
    curves = [curve(result.traces["time"].values, "s", force, "N") for force in forces]
    check_planted(figure, lambda: check_panels(figure, [curves]))


def test_a_study_shows_its_designs(tmp_path: Path) -> None:
    study = judged_study(name=EVIL).objective("peak force of the run").objective("detection time")
    answers = study.run(tmp_path / "study", progress=False)
    page = shown(answers)
    assert "script" not in page.seen
    assert any(text.startswith(EVIL) for text in page.texts)
    assert any(text.startswith("Recommended") for text in page.texts)
    assert len(page.images) == 1
    figure = _designs(answers)
    force, time_ms = answers.values[:, answers.columns[:2]].T
    chosen = [slice(None), answers.pareto, answers.order[:1]]
    curves = [curve(force[rows], "N", time_ms[rows], "ms") for rows in chosen]
    check_planted(figure, lambda: check_panels(figure, [curves]))


def test_a_study_without_a_winner_shows_itself(tmp_path: Path) -> None:
    page = shown(small_study().run(tmp_path / "study", progress=False))
    assert "No design is recommended" in page.texts


def test_drivetrains_show_numbers_and_bode_diagrams() -> None:
    drivetrain, servo = read(load="locked")
    assert math.isinf(drivetrain.load_inertia)
    assert "inf" in shown(drivetrain).texts
    page = shown(analyse(drivetrain, servo))
    assert (len(page.images), page.seen.count("table")) == (1, 1)


def test_other_things_have_no_page() -> None:
    with pytest.raises(TypeError, match="int has no page"):
        html_of(1)


def notebook(name: str) -> Any:
    return nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)


def test_notebooks_are_kept_without_outputs() -> None:
    assert sorted(path.stem for path in FOLDER.glob("*.ipynb")) == sorted(NAMES)
    for name in NAMES:
        found = notebook(name)
        nbformat.validate(found)
        for cell in found.cells:
            if cell.cell_type == "code":
                assert (cell.outputs, cell.execution_count) == ([], None), f"{name}: clear the outputs"
        assert set(json.loads((FOLDER / f"{name}.ipynb").read_text())["metadata"]) == {"kernelspec", "language_info"}


def execute(name: str, folder: Path) -> list[Any]:
    """The outputs of all code cells."""
    found = notebook(name)
    home = {"IPYTHONDIR": str(folder), "JUPYTER_CONFIG_DIR": str(folder), "JUPYTER_RUNTIME_DIR": str(folder)}
    NotebookClient(found, timeout=300, resources={"metadata": {"path": str(folder)}}).execute(
        env={**os.environ, **home}
    )
    return [output for cell in found.cells if cell.cell_type == "code" for output in cell.outputs]


def pages(outputs: list[Any]) -> list[Page]:
    return [Page(one.data["text/html"]) for one in outputs if "text/html" in one.get("data", {})]


def test_the_first_push_runs(tmp_path: Path) -> None:
    found = pages(execute("first_push", tmp_path))
    assert [len(page.images) for page in found] == [1, 1]


@pytest.mark.deep
@pytest.mark.parametrize(("name", "pictures"), [("bumper_study", 2), ("drivetrain", 2)])
def test_the_other_notebooks_run(name: str, pictures: int, tmp_path: Path) -> None:
    texts = [one.data["text/html"] for one in execute(name, tmp_path) if "text/html" in one.get("data", {})]
    assert sum("<img " in text for text in texts) == pictures
