"""The example studies at small size: what their findings rest on is in the physics, not in the sampling."""

from __future__ import annotations

import copy
import re
from pathlib import Path

import numpy as np
import pytest
from giveway.study import study_file
from giveway.study.answers import Answers, load
from giveway.study.engine import sweep
from giveway.study.gallery import LatchClaim, SensorTrade, latch_claim, sensor_trade
from PIL import Image

ROOT = Path(__file__).parents[2]


def small(name: str, folder: Path, **levels: list[float]) -> Path:
    """The example study ``name`` with other levels for some quantities, run; its folder."""
    document = copy.deepcopy(study_file.read(ROOT / "examples" / "studies" / f"{name}.toml").document)
    for entry in document["vary"]:
        for quantity, values in levels.items():
            if entry["quantity"].endswith(quantity):
                unit = {key: entry[key] for key in ("quantity", "also", "unit") if key in entry}
                entry.clear()
                entry.update(unit, values=values)
    if document["tolerances"].get("samples"):
        document["tolerances"]["samples"] = 1
    sweep(study_file.check(document, ROOT / "examples" / "studies", name), folder / name, threads=2)
    return folder / name


@pytest.fixture(scope="module")
def claim(tmp_path_factory: pytest.TempPathFactory) -> LatchClaim:
    levels = [0.0, 15.0, 36.0, 60.0, 85.0]
    return latch_claim(
        load(small("magnetic_latch", tmp_path_factory.mktemp("gallery"), spring_rate=[0.6, 2.4], latch_force=levels))
    )


@pytest.fixture(scope="module")
def trade(tmp_path_factory: pytest.TempPathFactory) -> SensorTrade:
    folder = tmp_path_factory.mktemp("gallery")
    return sensor_trade(
        load(small("sensor_stiffness", folder, stiffness=[100.0, 10000.0], gear_coulomb=[0.0, 2.75, 6.0]))
    )


def test_a_light_plate_s_peak_is_that_of_spring_or_latch(claim: LatchClaim) -> None:
    """F_L <= v sqrt(k_b m): the latch is not felt below, and decides above; in between the cover overshoots."""
    share = claim.latch_n / claim.bound_n[:, None]
    light = claim.peak[0, ..., 0]
    # Plate, cover and the robot that gives way: 7 % is what they change below half of the bound, in the whole study.
    assert light[share <= 0.5] == pytest.approx(1.0, abs=0.07)
    # Above, the cover's spring carries the latch force, and at most as much again as it overshoots.
    above = share > 1.05
    assert (light[above] > 0.95 * share[above]).all()
    assert (light[above] < 2.0 * share[above]).all()


def test_a_plate_s_own_mass_takes_of_the_bound(claim: LatchClaim) -> None:
    assert (claim.allowed(False)[1] < claim.allowed(False)[0]).all()
    # A magnet of 130 % reaches its limit at 1/1.3 of the stated force; 0.1: the levels are far apart here.
    assert claim.allowed(True)[0] == pytest.approx(claim.allowed(False)[0] / 1.3, abs=0.1)


def test_the_latch_is_noticed_earlier_with_the_stiff_spring(claim: LatchClaim) -> None:
    lead = claim.lead_at(claim.allowed(False))
    assert (lead[:, 1] > lead[:, 0] + 1.0).all()  # a tick of the controller is 1 ms
    assert (claim.lead_ms[..., -1, 0] > claim.lead_ms[..., 1, 0]).all()


def test_a_stiff_sensor_is_early_and_hits_hardly_harder(trade: SensorTrade) -> None:
    assert (trade.detection_ms[1] < 0.7 * trade.detection_ms[0]).all()
    assert (trade.peak_n[1] > trade.peak_n[0]).all()
    assert (trade.peak_n[1] < 1.12 * trade.peak_n[0]).all()  # the cover decides, not the drivetrain


def test_friction_holds_the_motor_against_a_stiff_sensor_only(trade: SensorTrade) -> None:
    assert (np.diff(trade.detection_ms[1]) < -3.0).all()
    assert (np.diff(trade.error[1]) < 0.0).all()
    assert np.ptp(trade.detection_ms[0]) < 0.5 * np.ptp(trade.detection_ms[1])


@pytest.mark.parametrize("name", ["magnetic_latch", "sensor_stiffness"])
def test_the_readme_says_what_its_pictures_found(name: str) -> None:
    """docs/study_*.png are made by `giveway study gallery` and carry their finding; the room's README repeats it."""
    with Image.open(ROOT / "docs" / f"study_{name}.png") as picture:
        finding = picture.info["Description"]
    text = " ".join((ROOT / "cosim" / "README.md").read_text(encoding="utf-8").split())
    assert finding in text


def test_the_readme_s_ten_lines_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (ROOT / "cosim" / "README.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```python\n([^`]*giveway\.Study[^`]*)```", text)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Answers] = {}
    exec(block.replace("count=512", "count=2").replace("duration=1.0", "duration=0.6"), names)
    # The slider comes at 0.5 s without a time of its own: 0.1 s of the collision are enough here.
    assert names["answers"].complete
    assert (tmp_path / "out" / "studies" / "latch" / "manifest.json").is_file()
