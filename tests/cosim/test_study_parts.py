"""Parts from catalogues: read as written, refused where wrong, fitted where they fit, named wherever a design is."""

from __future__ import annotations

import csv
import math
import shutil
from pathlib import Path
from xml.etree import ElementTree

import fmpy.ssp
import giveway
import numpy as np
import pytest
from giveway.base.errors import GivewayError
from giveway.cli import _main
from giveway.study import Study, study_file, tables
from giveway.study.answers import Answers, load
from giveway.study.catalogue import read_catalogue
from giveway.study.engine import plan_runs, sweep
from giveway.study.export import SSV, export_design, export_table
from giveway.study.report import write_report
from lxml import etree
from study_helpers import LATCH, SPRING, judged_study, small_study, stored_runs

EXAMPLES = Path(__file__).parents[2] / "examples"
SCHEMA = Path(fmpy.ssp.__file__).parent / "schema" / "SystemStructureParameterValues.xsd"
PRELOAD, TRAVEL = "testbed.bumper.preload", "testbed.bumper.travel"
SPRINGS = """\
# Made up for tests.
name,   maker, price [EUR], mass [g], rate [N/mm], free length [mm], solid length [mm], max force [N]

soft,   Acme,  1.50,        20,       0.4,         200,              40,                60
"hard, long", , 2.25,       45,       1.2,         210,              50,                150
short,  Acme,  0.50,        10,       1.0,         100,              30,                150
"""
MAGNETS = """\
name, price [EUR], mass [kg], force [N], gap [mm], max temperature [degC]
none, 0, 0, 0, 1, 500
weak, 1, 0.004, 20, 0.8, 80
big,  2, 0.010, 60, 1.2, 200
"""
RATE = {SPRING: "rate"}
PULL = {LATCH: "force", "testbed.bumper.latch_gap": "gap"}


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    """A folder with both catalogues."""
    (tmp_path / "springs.csv").write_text(SPRINGS, encoding="utf-8")
    (tmp_path / "magnets.csv").write_text(MAGNETS, encoding="utf-8")
    return tmp_path


def bought(shop: Path, **spring: object) -> Study:
    """Every spring with every magnet."""
    study = judged_study(vary=[])
    study.parts("spring", shop / "springs.csv", **{"sets": RATE, **spring})  # type: ignore[arg-type]
    return study.parts("magnet", shop / "magnets.csv", sets=PULL)


def test_a_catalogue_is_read_as_it_is_written(shop: Path) -> None:
    found = read_catalogue(shop / "springs.csv")
    assert found.names == ("soft", "hard, long", "short")
    assert (found.head_line, found.lines) == (2, (4, 5, 6))
    assert found.columns["maker"].cells == ("Acme", "", "Acme")
    assert (found.columns["rate"].unit, found.columns["rate"].position) == ("N/mm", 5)
    np.testing.assert_allclose(found.numbers("x", "rate", "N/m", (0, 2)), [400.0, 1000.0], rtol=1e-15)


@pytest.mark.parametrize(("old", "new", "words"), [
    ("0.4,", "0.4.1,", "springs.csv:4: column 5, rate [N/mm]: 0.4.1 is not allowed; allowed: a finite number"),
    ("0.4,", "inf,", "springs.csv:4: column 5, rate [N/mm]: inf is not allowed; allowed: a finite number"),
    ("0.4,", "4_0,", "springs.csv:4: column 5, rate [N/mm]: 4_0"),
    ("0.4,", ",", "springs.csv:4: column 5, rate [N/mm]: nothing is not allowed; allowed: a number: parts[0].sets"),
    ("0.4,", "-0.4,", "springs.csv:4: column 5, rate [N/mm]: -0.4 is not allowed; allowed: a finite number from 1 to"),
    ("2.25,", "-2.25,", "springs.csv:5: column 3, price [EUR]: -2.25 is not allowed; allowed: 0 or more"),
    ("rate [N/mm]", "rate [N/mmm]", "springs.csv:2: column 5: N/mmm is not allowed; allowed: 1 or a unit"),
    ("rate [N/mm]", "rate [mm]", "springs.csv:2: column 5, rate [mm]: mm is not allowed; allowed: N/m, or a unit"),
    ("rate [N/mm]", "rate [N/mm", "springs.csv:2: column 5: rate [N/mm is not allowed; allowed: a name, and for"),
    ("rate [N/mm]", "mass [g]", "springs.csv:2: column 5: mass is not allowed; allowed: a name of its own"),
    ("price [EUR]", "price", "springs.csv:2: column 3: price is not allowed; allowed: price [EUR]: a currency"),
    ("mass [g]", "mass [mm]", "springs.csv:2: column 4: mm is not allowed; allowed: kg"),
    ("name,   maker", "maker,   name [1]", "springs.csv:2: column 2: name [1] is not allowed; allowed: name, without"),
    ("name,", "part,", "springs.csv:2: columns: part, maker"),
    ("short,", "soft,", "springs.csv:6: column 1, name: soft is not allowed; allowed: a name of its own: line 4 has"),
    ("short,", ",", "springs.csv:6: column 1, name: nothing"),
    ("short,  Acme,", "short,", "springs.csv:6: columns: 7 is not allowed; allowed: 8, as in line 2"),
    ("solid length [mm]", "solid height [mm]", "parts[0].catalogue: free length without solid length is not"),
    ("40,                60", "400,           60", "springs.csv:4: column 7, solid length [mm]: 400 is not allowed"),
])  # fmt: skip
def test_a_wrong_catalogue_is_refused_with_line_and_column(old: str, new: str, words: str, shop: Path) -> None:
    assert old in SPRINGS
    (shop / "springs.csv").write_text(SPRINGS.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(GivewayError) as caught:
        bought(shop).setup(shop)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("content", "words"), [
    (b"\xff\xfe", "cannot be read"),
    (b"", "springs.csv:1: parts: 0 is not allowed"),
    (b"name,rate [N/mm]\n", "springs.csv:1: parts: 0 is not allowed; allowed: 1 to"),
    (b'name,rate [N/mm]\n"open,1\n', "cannot be read"),
    (b"name;rate [N/mm]\na;1\n", "divided by commas"),
])  # fmt: skip
def test_what_is_no_catalogue_is_refused(content: bytes, words: str, shop: Path) -> None:
    (shop / "springs.csv").write_bytes(content)
    with pytest.raises(GivewayError, match=r"springs\.csv") as caught:
        bought(shop).setup(shop)
    assert words in str(caught.value)


STUDY = """\
schema_version = 1

[scenario]
duration = 0.65
bumper = "magnetic"

[[collision]]
name = "front"
speed = 0.5
mass = 9.08
edge = 0
time = 0.12

[[parts]]
name = "spring"
catalogue = "springs.csv"
count = 2
sets = { "testbed.bumper.spring_rate" = "rate * count" }

[[parts]]
name = "magnet"
catalogue = "magnets.csv"
only = ["none", "big"]

[parts.sets]
testbed.bumper.latch_force = "force"
testbed.bumper.latch_gap = "gap"

[[vary]]
quantity = "testbed.bumper.preload"
values = [2.0, 5.0]

[[objective]]
metric = "price of parts"

[[constraint]]
metric = "mass of parts"
maximum = 60
unit = "g"
"""


def test_a_study_file_chooses_parts(shop: Path) -> None:
    (shop / "s.toml").write_text(STUDY, encoding="utf-8")
    setup = study_file.read(shop / "s.toml")
    assert [one.quantity.name for one in setup.varied] == ["spring", "magnet", PRELOAD]
    runs = plan_runs(setup)
    assert len(runs.designs) == 3 * 2 * 2
    rows = runs.rows(np.arange(12), np.zeros(12, dtype=np.int64), 0)
    at = {name: rows.values[:, runs.columns.index[name]].tolist() for name in (SPRING, LATCH, PRELOAD)}
    assert at[SPRING] == [800.0] * 4 + [2400.0] * 4 + [2000.0] * 4  # two side by side
    assert at[LATCH] == [0.0, 0.0, 60.0, 60.0] * 3
    assert at[PRELOAD] == [2.0, 5.0] * 6
    assert rows.values[2, runs.columns.index["testbed.bumper.latch_gap"]] == 0.0012


@pytest.mark.parametrize(("old", "new", "line", "words"), [
    ('"rate * count"', '"rats"', 18, ("parts[0].sets.testbed.bumper.spring_rate: rats is unknown", "rate")),
    ('"rate * count"', '"maker"', 18, ("maker of springs.csv is not allowed", "maker [N/m]")),
    ('"rate * count"', "3", 18, ("3 is not allowed; allowed: the name of a column",)),
    ("spring_rate", "spring_rat", 18, ("parts[0].sets.testbed.bumper.spring_rat: ", "mean testbed.bumper.spring_rate")),
    ("count = 2", "count = 0", 17, ("parts[0].count: 0 is not allowed", "1 to 1000")),
    ('"springs.csv"', '"sprigns.csv"', 16, ("parts[0].catalogue: sprigns.csv is not allowed",)),
    ('"big"]', '"bigg"]', 23, ("parts[1].only[1]: bigg is unknown", "big")),
    ('"big"]', '"none"]', 23, ("parts[1].only[1]: none is not allowed; allowed: each part once",)),
    ('name = "magnet"', 'name = "spring"', 21, ("parts[1].name: spring is not allowed; allowed: a name of its",)),
    ('name = "magnet"', 'name = "detection time"', 21, ("parts[1].name: detection time",)),
    ('name = "magnet"', 'name = "status"', 21, ("parts[1].name: status", "means nothing else")),
    ("bumper.preload", "bumper.latch_force", 26, ("parts[1].sets.testbed.bumper.latch_force", "vary[0]")),
    ("unit = \"g\"", "unit = \"mm\"", 39, ("constraint[0].unit: mm is not allowed; allowed: kg",)),
    ('"price of parts"', '"price of part"', 34, ("price of part is unknown", "price of parts")),
    ("maximum = 60", "maximum = 60\ncatalogue = 1", 39, ("constraint[0].catalogue: catalogue is unknown",)),
    ("bumper.latch_gap", "bumper.kind", 27, ("parts[1].sets.testbed.bumper.kind", "another name for it")),
])  # fmt: skip
def test_wrong_parts_are_refused_with_line_and_key(
    old: str, new: str, line: int, words: tuple[str, ...], shop: Path
) -> None:
    assert old in STUDY
    (shop / "s.toml").write_text(STUDY.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(GivewayError) as caught:
        study_file.read(shop / "s.toml")
    message = str(caught.value)
    assert message.startswith(f"{shop / 's.toml'}:{line}: "), message
    for word in words:
        assert word in message


def test_a_price_that_is_not_stated_cannot_be_an_objective(shop: Path) -> None:
    study = bought(shop).objective("price of parts")
    (shop / "magnets.csv").write_text(MAGNETS.replace("price [EUR]", "cost [1]"), encoding="utf-8")
    with pytest.raises(GivewayError, match=r"parts\[1\]: price is unknown"):
        study.setup(shop)
    (shop / "magnets.csv").write_text(MAGNETS.replace("[EUR]", "[CHF]"), encoding="utf-8")
    with pytest.raises(GivewayError, match=r"parts\[1\]\.catalogue: CHF .* allowed: EUR"):
        study.setup(shop)
    assert [goal.metric.name for goal in bought(shop).setup(shop).shown] == ["mass of parts", "contact speed"]
    with pytest.raises(GivewayError, match=r"objective\[0\]\.metric: price of parts .* \[\[parts\]\]"):
        small_study().objective("price of parts").setup()


def test_parts_give_the_bits_that_their_numbers_give(shop: Path) -> None:
    study = bought(shop, only=["soft"])
    sweep(study.setup(shop), shop / "a" / "parts", threads=1)
    plain = judged_study(vary=[]).vary(SPRING, values=[0.4], unit="N/mm")
    (shop / "designs.csv").write_text(
        f"{SPRING} [N/mm], {LATCH}, testbed.bumper.latch_gap [mm]\n0.4,0,1\n0.4,20,0.8\n0.4,60,1.2\n", encoding="utf-8"
    )
    plain = judged_study(vary=[], designs={"kind": "csv", "file": "designs.csv"})
    sweep(plain.setup(shop), shop / "b" / "numbers", threads=1)
    one, other = stored_runs(shop / "a" / "parts"), stored_runs(shop / "b" / "numbers")
    for name in ("key", "peak force of the run", "bumper compression"):
        np.testing.assert_array_equal(one[name], other[name])
    assert one["spring"].tolist() == ["soft"] * 3
    assert one["magnet"].tolist() == ["none", "weak", "big"]
    assert one["price of parts"].tolist() == [1.5, 2.5, 3.5]


def refused(study: Study, folder: Path, sample: int = 0) -> dict[int, str]:
    """Why designs do not fit, by number."""
    runs = plan_runs(study.setup(folder))
    every = np.arange(len(runs.designs))
    return runs.rows(every, np.full(len(every), sample), 0).refused


def test_a_spring_fits_exactly_until_it_is_solid(shop: Path) -> None:
    """soft: 160 mm of room, 0.4 N/mm; hard: 160 mm, 1.2 N/mm; short: 70 mm, 1 N/mm. Preload 12 N."""
    asked = {0: 12.0 / 0.4, 1: 12.0 / 1.2, 2: 12.0 / 1.0}  # mm before the stroke begins
    for travel_mm, wrong in ((58.0, []), (58.001, [2]), (130.0, [2]), (130.001, [0, 2]), (151.0, [0, 1, 2])):
        study = small_study(vary=[]).parts("spring", shop / "springs.csv", sets=RATE)
        study.vary(PRELOAD, values=[12.0]).vary(TRAVEL, values=[travel_mm], unit="mm")
        found = {k: text for k, text in refused(study, shop).items() if "solid" in text}
        assert sorted(found) == wrong, travel_mm
        for design, text in found.items():
            room = {0: 160, 1: 160, 2: 70}[design]
            compressed = f"{asked[design] + travel_mm:.4g}"
            name = ("soft", "hard, long", "short")[design]
            assert text == (
                f"spring {name}: solid before the stop: compressed at the stop {compressed}, at most {room} mm"
            )


def test_preload_and_stop_are_held_against_the_greatest_force(shop: Path) -> None:
    study = small_study(vary=[]).parts("spring", shop / "springs.csv", sets=RATE, only=["soft"])
    study.vary(PRELOAD, values=[20.0, 20.5, 61.0]).vary(TRAVEL, values=[0.1])  # 40 N of travel; it stands 60 N
    found = refused(study, shop)
    assert sorted(found) == [1, 2]
    assert found[1] == "spring soft: stop above its force: force at the stop 60.5, at most 60 N"
    assert found[2] == "spring soft: preload above its force: preload 61, at most 60 N"


def test_springs_side_by_side_share_the_force_and_behind_each_other_the_way(shop: Path) -> None:
    for column, preload, travel in (("rate * count", 2 * 20.0, 0.1), ("rate / count", 20.0, 0.2)):
        study = small_study(vary=[]).parts(
            "spring", shop / "springs.csv", sets={SPRING: column}, count=2, only=["soft"]
        )
        study.vary(PRELOAD, values=[preload, 1.03 * preload]).vary(TRAVEL, values=[travel])
        assert {k: v.split(": ")[1] for k, v in refused(study, shop).items()} == {1: "stop above its force"}
        study.document["vary"][1]["values"] = [1.12 * travel]  # 50 + 112 mm on each, of 160 mm
        assert refused(study, shop)[0].endswith("compressed at the stop 162, at most 160 mm")


def test_a_hot_magnet_and_stated_limits_do_not_fit(shop: Path) -> None:
    study = small_study(vary=[]).parts("magnet", shop / "magnets.csv", sets=PULL, at_least={PRELOAD: "gap"})
    with pytest.raises(GivewayError, match=r"magnets\.csv:1: column 5, gap \[mm\]: mm .* allowed: N"):
        study.setup(shop)
    study = small_study(vary=[]).parts("magnet", shop / "magnets.csv", sets=PULL, at_most={TRAVEL: "gap"})
    study.vary("temperature", values=[80.0, 80.5]).vary(TRAVEL, values=[0.001])
    found = refused(study, shop)
    assert found == {
        2: f"magnet weak: above its limit: {TRAVEL} 1, at most 0.8 mm",
        3: "magnet weak: too hot: temperature 80.5, at most 80 degC",
    }
    study.vary("bumper", values=["spring"])  # then there is no magnet that could be too hot
    assert refused(study, shop)[3].startswith("magnet weak: above its limit")


def test_a_tolerance_can_make_a_part_unfit(shop: Path) -> None:
    study = small_study(vary=[]).parts("spring", shop / "springs.csv", sets=RATE, only=["soft"])
    study.vary(PRELOAD, values=[20.0]).vary(TRAVEL, values=[0.09]).tolerance(SPRING, relative=0.2)
    study.tolerances(kind="corners").objective("price of parts")
    assert not refused(study, shop)
    assert not refused(study, shop, sample=1)
    assert refused(study, shop, sample=2)[0].endswith("force at the stop 63.2, at most 60 N")
    answers = study.run(shop / "out", threads=1)
    assert not answers.feasible.any()
    assert tables.misfit_rows(answers)[0][:3] == ("spring soft", "1", "stop above its force")


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Answers:
    """Every spring and magnet with two travels; the catalogues are gone afterwards."""
    shop = tmp_path_factory.mktemp("shop")
    (shop / "springs.csv").write_text(SPRINGS, encoding="utf-8")
    (shop / "magnets.csv").write_text(MAGNETS, encoding="utf-8")
    study = bought(shop, count=2, sets={SPRING: "rate * count"}).vary(TRAVEL, values=[60.0, 90.0], unit="mm")
    study.objective("price of parts").objective("peak force of the run").constraint(
        "mass of parts", maximum=60, unit="g"
    )
    folder = tmp_path_factory.mktemp("out") / "study"
    sweep(study.setup(shop), folder, threads=1)
    shutil.rmtree(shop)
    return load(folder)


def test_price_and_mass_are_summed(answers: Answers) -> None:
    springs, magnets = {"soft": 1.5, "hard, long": 2.25, "short": 0.5}, {"none": 0.0, "weak": 1.0, "big": 2.0}
    masses = {"soft": 20, "hard, long": 45, "short": 10, "none": 0, "weak": 4, "big": 10}
    table = answers.table()
    chosen = list(zip(table["spring"].values.tolist(), table["magnet"].values.tolist(), strict=True))
    price = [2 * springs[a] + magnets[b] for a, b in chosen]
    mass = [2 * masses[a] + masses[b] for a, b in chosen]
    np.testing.assert_allclose(table["price of parts"], price, rtol=1e-15)
    np.testing.assert_allclose(table["mass of parts"], mass, rtol=1e-12)  # kg and back to g
    assert (table["price of parts"].attrs["units"], table["mass of parts"].attrs["units"]) == ("EUR", "g")
    heavy = np.array(mass) > 60.0
    unfit = (table["spring"].values == "short") & np.isclose(table["testbed.bumper.travel"].values, 90.0)
    np.testing.assert_array_equal(answers.feasible, ~heavy & ~unfit)
    assert heavy.any()
    assert unfit.sum() == 3


def test_table_report_and_console_name_parts_and_misfits(answers: Answers, tmp_path: Path) -> None:
    assert tables.goal_header(answers)[:3] == ("design", "spring", "magnet")
    assert ("short", "none") in [row[1:3] for row in tables.design_rows(answers)]
    assert "3 with parts that do not fit" in tables.counts(answers)
    assert "failed" not in tables.counts(answers)
    (row,) = tables.misfit_rows(answers)
    assert row[:3] == ("spring short", "3", "solid before the stop")
    assert row[3].endswith("compressed at the stop 91, at most 70 mm")
    write_report(tmp_path / "report.html", answers)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    for words in ("Parts that do not fit", "spring short", "compressed at the stop 91, at most 70 mm",
                  "soft, hard, long, short (catalogue-0-springs.csv, 2 of each)"):  # fmt: skip
        assert words in page, words
    assert "Runs that failed" not in page


def test_an_export_says_which_parts_it_has(answers: Answers, tmp_path: Path) -> None:
    design = 4  # soft, big, 60 mm
    export_table(answers, tmp_path / "all.csv")
    with (tmp_path / "all.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert (rows[design]["spring"], rows[design]["magnet"], rows[design]["price of parts [EUR]"]) == (
        "soft",
        "big",
        "5",
    )
    assert [row["spring"] for row in rows if "solid before the stop" in row["reason"]] == ["short"] * 3
    export_design(answers, design, tmp_path / "d.ssv")
    tree = etree.parse(tmp_path / "d.ssv")
    etree.XMLSchema(etree.parse(SCHEMA)).assertValid(tree)
    told = ElementTree.parse(tmp_path / "d.ssv").getroot().attrib["description"]
    assert told == "spring: 2 of soft (Acme, 1.50 EUR, 20 g); magnet: big (2 EUR, 0.010 kg)"
    values = {one.attrib["name"]: one[0].attrib["value"] for one in ElementTree.parse(tmp_path / "d.ssv").iter(
        f"{{{SSV}}}Parameter")}  # fmt: skip
    assert float(values["bumper.spring_rate"]) == 800.0
    assert float(values["bumper.latch_gap"]) == pytest.approx(0.0012, rel=1e-15)
    export_design(answers, design, tmp_path / "d.toml")
    assert "# spring: 2 of soft (Acme, 1.50 EUR, 20 g)\n" in (tmp_path / "d.toml").read_text(encoding="utf-8")
    scenario = giveway.read_scenario(tmp_path / "d.toml")
    assert (scenario.testbed["bumper.spring_rate"], scenario.testbed["bumper.latch_force"]) == (800.0, 60.0)
    export_design(answers, design, tmp_path / "d.csv")
    assert "spring,soft,\n" in (tmp_path / "d.csv").read_text(encoding="utf-8")


def test_another_catalogue_is_another_study(shop: Path) -> None:
    """A line above moves all parts: what is stored by number must not be taken for them."""
    first = sweep(bought(shop).setup(shop), shop / "out", threads=1)
    (shop / "springs.csv").write_text(
        SPRINGS.replace("soft,", "new, , 1, 1, 0.9, 300, 10, 500\nsoft,"), encoding="utf-8"
    )
    second = sweep(bought(shop).setup(shop), shop / "out", threads=1)
    assert (second.ran, second.reused + second.failed) == (3, first.ran + first.failed)
    (shop / "springs.csv").write_text(SPRINGS.replace("1.50", "9.50"), encoding="utf-8")
    third = sweep(bought(shop).setup(shop), shop / "out", threads=1)
    assert third.ran == 0
    assert stored_runs(shop / "out")["price of parts"][0] == 9.5


def test_every_kind_of_design_takes_parts(shop: Path) -> None:
    setup = bought(shop).vary(PRELOAD, low=1.0, high=9.0).designs("sobol", count=36).setup(shop)
    designs = plan_runs(setup).designs
    assert {tuple(row) for row in designs[:, :2].tolist()} == {(a, b) for a in range(3) for b in range(3)}
    study = bought(shop, nominal="short").designs("one-at-a-time")
    with pytest.raises(GivewayError, match=r"parts\[1\]\.nominal: nothing"):
        study.setup(shop)
    study.document["parts"][1]["nominal"] = "weak"
    assert plan_runs(study.setup(shop)).designs.tolist() == [[2, 1], [0, 1], [1, 1], [2, 0], [2, 2]]
    (shop / "mine.csv").write_text(f'magnet,{PRELOAD},spring\nbig,3,soft\nnone,4,"hard, long"\n', encoding="utf-8")
    setup = bought(shop).designs("csv", file="mine.csv").setup(shop)
    assert [one.quantity.name for one in setup.varied] == ["magnet", PRELOAD, "spring"]
    assert plan_runs(setup).designs.tolist() == [[2, 3, 0], [0, 4, 1]]
    (shop / "mine.csv").write_text(f"magnet,{PRELOAD}\nbig,3\n", encoding="utf-8")
    with pytest.raises(GivewayError, match=r"mine\.csv:1: columns: .* a column spring, parts\[0\]"):
        bought(shop).designs("csv", file="mine.csv").setup(shop)
    morris = bought(shop).vary(PRELOAD, low=1.0, high=9.0).designs("morris", trajectories=4).setup(shop)
    assert len(plan_runs(morris).designs) == 16


@pytest.mark.parametrize("path", sorted((EXAMPLES / "catalogues").glob("*.csv")), ids=lambda path: path.stem)
def test_example_catalogues_say_that_they_are_made_up(path: Path) -> None:
    assert path.stem.endswith("_made_up")
    assert "Made up: neither makers nor parts exist." in path.read_text(encoding="utf-8").partition("\n")[0]
    assert len(read_catalogue(path).lines) >= 8


def test_example_springs_are_what_their_wire_makes_them() -> None:
    """Rate and solid length from wire, diameter and coils, which the names state (shear modulus 79.3 GPa)."""
    found = read_catalogue(EXAMPLES / "catalogues" / "springs_made_up.csv")
    for part, name in enumerate(found.names):
        wire, diameter, coils = (float(text) for text in name.removeprefix("DF-").split("-"))
        rate = 79.3e3 * (wire / 100.0) ** 4 / (8.0 * diameter**3 * coils)
        assert found.columns["rate"].numbers[part] == pytest.approx(rate, abs=0.0051)  # rounded to 0.01 N/mm
        solid = (coils + 2.0) * wire / 100.0
        assert found.columns["solid length"].numbers[part] == pytest.approx(solid, abs=0.051)
        room = found.columns["free length"].numbers[part] - solid
        assert found.columns["max force"].numbers[part] / rate < room + 5.0


def test_the_example_study_has_parts_that_fit_and_parts_that_do_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = EXAMPLES / "studies" / "spring_and_magnet.toml"
    assert _main(["sweep", str(path), "--check"]) == 0
    assert "792 designs" in capsys.readouterr().out
    runs = plan_runs(study_file.read(path))
    every = np.arange(len(runs.designs))
    wrong = runs.rows(every, np.zeros_like(every), 0).refused
    assert 0 < len(wrong) < 0.2 * len(every)
    assert all(math.isfinite(value) for value in runs.designs.ravel())
