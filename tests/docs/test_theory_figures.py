"""The pictures of theory and detector: of the robot file's numbers, readable at a phone's width, shown by the pages."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from giveway.robot.robot_file import read_robot

from docs.theory_figures import FIGURES, WIDTH, draw

ROOT = Path(__file__).parents[2]
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> dict[str, ElementTree.Element]:
    folder = tmp_path_factory.mktemp("pictures")
    draw(ROOT, folder)
    return {path.name: ElementTree.parse(path).getroot() for path in folder.iterdir()}


def test_the_pages_show_every_picture(drawn: dict[str, ElementTree.Element]) -> None:
    folder = ROOT / "docs" / "site" / "explanation"
    pages = [(folder / name).read_text(encoding="utf-8") for name in ("theory.md", "detector.md")]
    assert set(re.findall(r"pictures/(\w+\.svg)", "".join(pages))) == set(drawn) == set(FIGURES)


def test_they_are_readable_on_a_phone(drawn: dict[str, ElementTree.Element]) -> None:
    for name, picture in drawn.items():
        assert int(picture.attrib["width"]) == WIDTH <= 360, name
        assert float(picture.attrib["font-size"]) >= 14, name
        assert picture.find(f"{SVG}rect").attrib["fill"] == "#ffffff", name  # type: ignore[union-attr]
        for text in picture.iter(f"{SVG}text"):
            half = 0.0 if text.get("text-anchor") is None else 0.5
            length = 8.5 * len(str(text.text))  # px, of letters of 15 px
            left = float(text.attrib["x"]) - half * length
            assert 0 <= left <= WIDTH - length, (name, text.text)


def test_the_push_s_line_is_as_far_from_the_middle_as_its_moment_says(drawn: dict[str, ElementTree.Element]) -> None:
    lines = drawn["theory_geometry.svg"].findall(f"{SVG}line")
    (dashed,) = [line for line in lines if line.get("stroke-dasharray")]
    (lever,) = [line for line in lines if line.get("stroke-width") == "1.5"]

    def along(line: ElementTree.Element) -> tuple[float, float]:
        ends = [float(line.attrib[key]) for key in ("x1", "y1", "x2", "y2")]
        return ends[2] - ends[0], ends[3] - ends[1]

    (ax, ay), (bx, by) = along(dashed), along(lever)
    # Ends are rounded to 0.1 px, of 46 px and more.
    assert abs(ax * bx + ay * by) < 0.01 * (ax**2 + ay**2) ** 0.5 * (bx**2 + by**2) ** 0.5
    ends = [
        float(lever.attrib["x2"]) - float(dashed.attrib["x1"]),
        float(lever.attrib["y2"]) - float(dashed.attrib["y1"]),
    ]
    assert abs(ends[0] * ay - ends[1] * ax) < 0.5 * (ax**2 + ay**2) ** 0.5  # its end lies on the line


def test_the_numbers_are_those_of_the_robot_file() -> None:
    robot = read_robot(ROOT / "robots" / "trikey.toml")
    shown = FIGURES["theory_friction.svg"](robot)
    force = robot.value("roller.coulomb_torque") / robot.value("roller.radius")
    assert f"up to {force:.0f} N" in shown
    assert f">{1000 * force / robot.value('roller.presliding_stiffness'):.2f}<" in shown
