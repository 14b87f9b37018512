"""Study files: the examples are read, and a wrong one is refused with its line and key before anything runs."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from giveway.base.errors import GivewayError
from giveway.study import study_file
from giveway.study.evidence import evidence_setup
from study_helpers import LATCH, SPRING, small_study

EXAMPLES = Path(__file__).parents[2] / "examples" / "studies"
GOOD = """\
schema_version = 1
name = "wrong on purpose"

[scenario]
duration = 0.7
bumper = "magnetic"

[[collision]]
name = "front"
speed = 0.5
edge = 0

[designs]
kind = "sobol"
count = 8

[[vary]]
quantity = "testbed.bumper.latch_force"
low = 0.0
high = 90.0
unit = "N"

[[tolerance]]
quantity = "testbed.bumper.spring_rate"
relative = 0.1

[[objective]]
metric = "peak force of the run"

[[constraint]]
metric = "bumper compression"
maximum = 110
unit = "mm"
"""
WRONG = {  # what is replaced, by what, the line, and words of the message
    "unknown quantity": ("testbed.bumper.latch_force", "testbed.bumper.latch_forse", 18,
        ("vary[0].quantity", "latch_force")),
    "unknown robot number": ("testbed.bumper.spring_rate", "robot.base.mas", 24,
        ("tolerance[0].quantity", "robot.base.mass")),
    "unit of another kind": ('unit = "N"', 'unit = "N/m"', 21,
        ("vary[0].unit", "N/m", "N, or a unit of the same kind")),
    "unit of a metric": ('unit = "mm"', 'unit = "ms"', 33, ("constraint[0].unit", "mm")),
    "empty range": ("high = 90.0", "high = 0.0", 20, ("vary[0].high", "range is empty")),
    "out of the variable's range": ("high = 90.0", "high = 90000.0", 20, ("vary[0].high", "from 0 to 10000 N")),
    "levels are missing": ('"sobol"\ncount = 8', '"factorial"', 16, ("vary[0].levels", "factorial needs them")),
    "count is missing": ("count = 8", "", 13, ("designs.count", "nothing")),
    "option of another kind": ("count = 8", "trajectories = 8", 15, ("designs.trajectories", "unknown")),
    "unknown kind of design": ('"sobol"', '"soboll"', 14, ("designs.kind", "sobol")),
    "unknown metric": ('"peak force of the run"', '"peak farce of the run"', 28,
        ("objective[0].metric", "peak force of the run")),
    "unknown method": ('name = "wrong', 'method = "exact"\nname = "wrong', 2, ("method", "event-exact")),
    "unknown key": ("edge = 0", "edge = 0\nheigth = 0.3", 12, ("collision[0].heigth", "height")),
    "no such side": ("edge = 0", "edge = 7", 11, ("collision[0].edge", "from 0 to 2")),
    "scenario out of range": ("duration = 0.7", "duration = -1.0", 5, ("scenario.duration", "0 to 3600")),
    "relative above one": ("relative = 0.1", "relative = 1.5", 25, ("tolerance[0].relative", "below 1")),
    "samples of nothing": ('[[tolerance]]\nquantity = "testbed.bumper.spring_rate"\nrelative = 0.1',
        "[tolerances]\nsamples = 3", 24, ("tolerances.samples: 3", "[[tolerance]]", "noise_seeds")),
    "tolerance twice": ('relative = 0.1', 'relative = 0.1\nabsolute = 3.0', 25, ("tolerance[0].relative", "one of")),
    "set by the collision": ("testbed.bumper.latch_force", "testbed.slider.mass", 18,
        ("vary[0].quantity", "collision.mass")),
    "nothing but a limit of nobody": ("maximum = 110", 'maximum = "lasting limit"', 32,
        ("constraint[0].maximum", "body_region")),
    "offset without a side": ("edge = 0", "point = [0.088046, 0.1525]", 18, ("vary[0].quantity", "edge")),
    "too many designs": ("count = 8", "count = 2000000000", 15, ("designs.count", "2 to 20000000")),
}  # fmt: skip


def written(folder: Path, text: str) -> Path:
    path = folder / "wrong.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_file_is_right_as_it_is(tmp_path: Path) -> None:
    setup = study_file.read(written(tmp_path, GOOD))
    assert [one.quantity.name for one in setup.varied] == [LATCH]
    assert setup.plan.count == 8
    assert setup.constraints[0].maximum == 110.0


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_file_is_refused_with_line_and_key(name: str, tmp_path: Path) -> None:
    old, new, line, words = WRONG[name]
    text = GOOD.replace("testbed.bumper.latch_force", "collision.offset") if name == "offset without a side" else GOOD
    text = text.replace('unit = "N"\n', "").replace("high = 90.0", "high = 0.1") if "collision.offset" in text else text
    assert old in text
    path = written(tmp_path, text.replace(old, new))
    with pytest.raises(GivewayError) as caught:
        study_file.read(path)
    message = str(caught.value)
    assert message.startswith(f"{path}:{line}: "), message
    assert "\n" not in message
    for word in words:
        assert word in message


def test_more_runs_than_the_disk_holds_are_refused_before_any(tmp_path: Path) -> None:
    from giveway.study.engine import sweep

    text = GOOD.replace("count = 8", "count = 20000000").replace(
        "relative = 0.1", "relative = 0.1\n\n[tolerances]\nsamples = 1000000\n"
    )
    path = written(tmp_path, text)
    with pytest.raises(
        GivewayError, match=r"wrong\.toml:15: designs\.count: .* runs \([\d,]+ TB\).* [GT]B of free space"
    ):
        sweep(study_file.read(path), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_small_disk_is_spoken_of_in_a_unit_that_suits_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from giveway.study import engine

    monkeypatch.setattr(engine.shutil, "disk_usage", lambda _: SimpleNamespace(free=900))
    with pytest.raises(
        GivewayError, match=r"designs\.count: \d+ runs \([\d.]+ kB\) .* as many as fit into \d+ bytes of free"
    ):
        engine.sweep(study_file.read(written(tmp_path, GOOD)), tmp_path / "out")


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_example_can_be_read(path: Path) -> None:
    assert study_file.read(path).objectives


def test_designs_come_from_a_csv_file(tmp_path: Path) -> None:
    (tmp_path / "mine.csv").write_text(
        "bumper, testbed.bumper.spring_rate [N/mm]\nspring, 0.5\nmagnetic, 1.5\n", encoding="utf-8"
    )
    study = small_study(vary=[], designs={"kind": "csv", "file": "mine.csv"})
    setup = study.setup(tmp_path)
    assert setup.plan.rows is not None
    np_rows = setup.plan.rows.tolist()
    assert np_rows == [[1.0, 500.0], [2.0, 1500.0]]


@pytest.mark.parametrize(("text", "line", "word"), [
    ("testbed.bumper.latch_forse\n1\n", 1, "latch_force"),
    ("testbed.bumper.latch_force\n1\n-5\n", 3, "from 0 to 10000 N"),
    ("testbed.bumper.latch_force,bumper\n1,spring\n2\n", 3, "2, as in the first line"),
    ("testbed.bumper.latch_force [m]\n1\n", 1, "N, or a unit of the same kind"),
    ("testbed.bumper.latch_force\nsome\n", 2, "finite number"),
])  # fmt: skip
def test_a_wrong_csv_file_is_refused_with_its_line(text: str, line: int, word: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(GivewayError) as caught:
        small_study(vary=[], designs={"kind": "csv", "file": "mine.csv"}).setup(tmp_path)
    assert str(caught.value).startswith(f"{path}:{line}: ")
    assert word in str(caught.value)


def test_a_file_that_is_no_csv_is_refused(tmp_path: Path) -> None:
    (tmp_path / "mine.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(GivewayError, match=r"mine\.csv: cannot be read"):
        small_study(vary=[], designs={"kind": "csv", "file": "mine.csv"}).setup(tmp_path)


def test_a_limit_of_a_body_region_is_its_number() -> None:
    study = small_study().constraint("peak force of the run", maximum="transient limit")
    study.document["scenario"]["judge_as"] = "lower leg"
    from giveway.scenario.body_regions import body_region

    assert study.setup().constraints[0].maximum == body_region("lower leg").peak_limit_n
    # 420 N/cm2 on half a square centimetre
    study.document["scenario"]["contact_area"] = {"value": 50, "unit": "mm2"}
    assert study.setup().constraints[0].maximum == pytest.approx(210.0)


def test_a_study_of_a_body_region_is_hit_by_that_body() -> None:
    """Designs with other covers: each in series with the leg; what the region decides cannot be varied."""
    from giveway.study.chosen import scenario_of_run, settings_of_run
    from giveway.study.runs import RunTable

    study = small_study(vary=[{"quantity": "robot.contact.stiffness", "values": [5.0, 20.0], "unit": "kN/m"}])
    del study.document["collision"][0]["mass"]
    study.document["scenario"]["body_region"] = "lower leg"
    setup = study.setup()
    runs = RunTable(setup, np.array([[5e3], [2e4]]), np.zeros((1, 0)))
    for design, cover in enumerate((5e3, 2e4)):
        found = settings_of_run(runs, design, 0, 0)["testbed"]
        assert found["contact.stiffness"] == 1.0 / (1.0 / 6e4 + 1.0 / cover)
        assert found["slider.mass"] == 75.0
        again = scenario_of_run(setup, runs, design)
        assert again.parameters("testbed")["contact.stiffness"] == found["contact.stiffness"]
        assert again.judged is setup.cases[0].scenario.judged
    for quantity in ("collision.mass", "testbed.contact.stiffness", "robot.slider.mass"):
        refused = small_study(vary=[{"quantity": quantity, "values": [500.0, 600.0]}])
        refused.document["scenario"]["body_region"] = "lower leg"
        del refused.document["collision"][0]["mass"]
        with pytest.raises(GivewayError, match=r'vary\[0\]\.quantity: .* body_region = "lower leg".*judge_as'):
            refused.setup()


@pytest.mark.parametrize(
    ("bumper", "quantity", "words"),
    [
        ("none", SPRING, "the bumper none, which has no numbers"),
        ("none", "testbed.bumper.mount_x", "the bumper none, which has no numbers"),
        ("spring", LATCH, "the bumper spring: testbed.bumper.spring_rate, "),
        ("spring", "testbed.bumper.latch_model", "the bumper spring: "),
        ("magnetic", "testbed.bumper.foam_force_25", "testbed.bumper.latch_gap"),
    ],
)
def test_a_number_that_the_bumper_has_not_is_refused(bumper: str, quantity: str, words: str) -> None:
    study = small_study(vary=[])
    study.document["scenario"]["bumper"] = bumper
    ends: dict[str, Any] = {"values": [0, 1]} if quantity.endswith("model") else {"low": 10.0, "high": 20.0}
    if quantity.endswith("mount_x"):
        ends = {"low": 0.1, "high": 0.2}
    with pytest.raises(GivewayError) as caught:
        study.vary(quantity, **ends).designs("sobol", count=2).setup()
    assert (caught.value.field, caught.value.value) == ("vary[0].quantity", quantity)
    assert words in caught.value.allowed


def test_a_tolerance_that_the_bumper_has_not_is_refused_too() -> None:
    study = small_study(vary=[]).vary("collision.speed", values=[0.3, 0.5]).tolerance(LATCH, relative=0.1)
    study.document["scenario"]["bumper"] = "spring"
    with pytest.raises(GivewayError, match=r"tolerance\[0\]\.quantity: testbed\.bumper\.latch_force is not allowed"):
        study.setup()


def test_a_number_that_one_of_the_bumpers_has_may_vary(tmp_path: Path) -> None:
    study = small_study(vary=[]).vary("bumper", values=["none", "spring"]).vary(SPRING, values=[0.6, 1.2], unit="N/mm")
    answers = study.objective("detection time").run(tmp_path / "study", progress=False)
    for design in (0, 3):  # the evidence is about one bumper, with all the numbers of the design
        assert len(evidence_setup(answers, design, [0.3], [5.0]).varied) == 5
    with pytest.raises(GivewayError, match=r"vary\[2\]\.quantity: testbed\.bumper\.latch_force is not allowed"):
        study.vary(LATCH, values=[10.0, 20.0]).setup()
