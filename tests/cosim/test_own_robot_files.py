"""`giveway robot new` and `giveway robot check`."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
import pytest
from cosim_helpers import Cli, folder_content
from figure_labels import check_planted, in_si, same, unit_of_axis
from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.own_robot.body import plate
from giveway.own_robot.checked import check
from giveway.own_robot.drawing import draw
from giveway.own_robot.measured import outline_of
from giveway.own_robot.plausible import RULES, Numbers, doubts
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import table
from matplotlib.axes import Axes
from matplotlib.text import Annotation
from numpy.typing import NDArray

TRIKEY = native.robot().read_text(encoding="utf-8")
SIZES = ("--mass", "34.7 kg", "--wheel-radius", "4 in", "--wheel-distance", "240 mm")
NEW = ("robot", "new", "mine.toml", *SIZES, "--outline", "triangle 0.61", "--height", "0.75")


def test_a_new_file_can_be_used_and_states_what_was_given(cli: Cli, tmp_path: Path) -> None:
    done = cli(*NEW, "--name", 'My "first" robot', "--encoder-counts", "4000", "--com-height", "41.4 cm")
    assert done.returncode == 0, done.stderr
    assert "mine.toml: can be used; 0 doubts" in done.stdout
    robot = read_robot(tmp_path / "mine.toml")
    assert robot.name == 'My "first" robot'
    given = {name: entry for name, entry in robot.entries() if entry.provenance == "given"}
    assert {name: entry.values[0] for name, entry in given.items() if not name.startswith("outline.")} == {
        "base.mass": 34.7,
        "base.com_height": 0.414,
        "wheel.radius": 0.1016,
        "wheel.distance": 0.24,
        "drivetrain.encoder_counts": 4000,
    }
    assert robot["outline.x"].values == pytest.approx((0.352184, -0.176092, -0.176092), abs=1e-6)
    assert robot["outline.y"].values == pytest.approx((0.0, 0.305, -0.305), abs=1e-6)
    estimates = [entry for name, entry in robot.entries() if name not in given]
    assert {(entry.provenance, entry.confidence) for entry in estimates} == {("assumed", "low")}
    assert all(entry.source.startswith("estimate of giveway robot new: ") for entry in estimates)
    text = (tmp_path / "mine.toml").read_text(encoding="utf-8")
    assert len(re.findall(r"^# [^\n]+\n\[", text, re.MULTILINE)) == len(dict(robot.entries()))  # each has its comment


def test_its_estimates_are_near_trikeys_numbers(cli: Cli, tmp_path: Path) -> None:
    """The rules scale Trikey: its own sizes give back its numbers, by order of magnitude."""
    assert cli(*NEW).returncode == 0
    mine, trikey = read_robot(tmp_path / "mine.toml"), read_robot(native.robot())
    for name, entry in trikey.entries():
        if name in mine and entry.values[0]:
            assert 0.2 < mine[name].values[0] / entry.values[0] < 5.0, name


@pytest.mark.parametrize(
    ("mass", "radius", "distance", "outline", "height"),
    [("2.5", "0.03", "0.1", "circle 0.24", "0.15"), ("150", "0.1", "0.4", "rectangle 90 cm x 0.8 m", "1.4")],
)
def test_small_and_large_robots_are_plausible(
    mass: str, radius: str, distance: str, outline: str, height: str, cli: Cli, tmp_path: Path
) -> None:
    sizes = ("--mass", mass, "--wheel-radius", radius, "--wheel-distance", distance, "--height", height)
    assert cli("robot", "new", "mine.toml", *sizes, "--outline", outline, "--imu").returncode == 0
    found = check(tmp_path / "mine.toml")
    assert found.usable
    assert [doubt for _, doubt in found.doubts if doubt.rule != "threshold"] == []
    assert table("testbed").robot_values(found.robot)["imu.present"] is True
    assert table("controller").robot_values(found.robot)["imu.use"] == 1


def test_a_robot_that_senses_by_motor_current(cli: Cli, tmp_path: Path) -> None:
    """It has the currents' entries and none of torque sensors, and both models take it."""
    done = cli(*NEW, "--torque-constant", "0.03 N.m/A", "--gear-ratio", "60", "--torque-limit", "18 N.m")
    assert done.returncode == 0, done.stderr
    assert "mine.toml: can be used; 0 doubts" in done.stdout
    robot = read_robot(tmp_path / "mine.toml")
    assert robot.motor_current
    assert not [name for name, _ in robot.entries() if name.startswith(("drivetrain.torque_n", "drivetrain.torque_s"))]
    assert robot.value("motor.current_range") == 14.0  # 1.4 * 18 N m / (60 * 0.03 N m/A)
    testbed = table("testbed").robot_values(robot)
    assert testbed["electronics.torque_noise"] == pytest.approx(0.056 * 60 * 0.03)
    given = {name for name, entry in robot.entries() if entry.provenance == "given"}
    assert {"motor.gear_ratio", "motor.torque_constant"} <= given


def test_a_file_is_replaced_only_by_force(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("years of work")
    done = cli(*NEW)
    assert done.returncode == 2
    assert "giveway: mine.toml: is there already; give another name, or --force" in done.stderr
    assert (tmp_path / "mine.toml").read_text() == "years of work"
    assert cli(*NEW, "--force").returncode == 0
    assert read_robot(tmp_path / "mine.toml").name == "mine"


WRONG_NEW = {
    "nothing": (
        ("robot", "new", "mine.toml"),
        ("--mass, --wheel-radius, --wheel-distance, --outline, --height: nothing", '--mass "34.7 kg" --wheel-radius'),
    ),
    "no outline": (NEW[:9], ("--outline, --height: nothing", '--outline "circle 0.45"', "needed")),
    "no ratio": ((*NEW, "--torque-constant", "0.03 N.m/A"), ("--gear-ratio: nothing", "with --torque-constant")),
    "no constant": ((*NEW, "--gear-ratio", "20"), ("--torque-constant: nothing", "0.0001 to 100 N.m/A")),
    "noise of two": (
        (*NEW, "--torque-constant", "0.03", "--gear-ratio", "20", "--torque-noise", "0.1"),
        ("--torque-noise: 0.1 N.m, with --torque-constant,", "motor.current_noise"),
    ),
    "another kind": ((*NEW, "--mass", "3 m"), ("--mass: m ", "kg, or a unit of the same kind")),
    "negative": ((*NEW, "--mass", "-3"), ("--mass: -3.0", "1 to 1000 kg")),
    "words": ((*NEW, "--height", "tall"), ("--height: tall", "0.02 to 5 m")),
    "no number": ((*NEW, "--height", "1.2.3"), ("--height: 1.2.3", "0.02 to 5 m")),
    "shape": ((*NEW, "--outline", "heart 0.3"), ("--outline: heart 0.3", "circle DIAMETER")),
    "two corners": ((*NEW, "--outline", "0,0 1,0"), ("--outline", "3 to 16 corners")),
    "dent": ((*NEW, "--outline", "0,0 1,0 0.2,0.2 0,1"), ("--outline", "convex")),
    "one side": ((*NEW, "--outline", "rectangle 0.5"), ("--outline: rectangle 0.5", "LENGTH x WIDTH")),
    "top-heavy": ((*NEW, "--com-height", "0.8"), ("--com-height: 0.8 m", "below --height, 0.75 m")),
    "in the air": ((*NEW, "--clearance", "0.8"), ("--clearance: 0.8 m", "below --height, 0.75 m")),
    "too light for the models": (
        (*NEW, "--mass", "1", "--wheel-radius", "0.02", "--wheel-distance", "0.05", "--outline", "circle 0.1"),
        ("mine.toml:", "base.yaw_inertia: 0.00", "0.01 to 1000 kg.m2"),
    ),
    "no TOML": (("robot", "new", "mine.txt", *NEW[3:]), ("FILE: mine.txt", "ending in .toml")),
    "no robot": (("robot", "check", "nobody"), ("FILE: nobody", "delivery, ")),
    "no file": (("robot", "check", "nobody.toml"), ("nobody.toml", "no such file")),
    "another picture": (("robot", "check", "trikey", "--out", "a.pdf"), ("--out: a.pdf", ".html, .svg, .png")),
}


@pytest.mark.parametrize("case", WRONG_NEW)
def test_wrong_input_is_one_line_and_writes_nothing(case: str, cli: Cli, tmp_path: Path) -> None:
    arguments, words = WRONG_NEW[case]
    done = cli(*arguments)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert not done.stdout
    for word in words:
        assert word in done.stderr
    assert folder_content(tmp_path) == []


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_at_a_terminal_it_asks_until_it_can_use_the_answer(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers = ["heavy", "", "20 kg", "50 mm", "0.2", "circle 45 cm", "0.3", *[""] * 6]
    monkeypatch.setattr("sys.stdin", Terminal("\n".join(answers) + "\n"))
    done = cli("robot", "new", "mine.toml", "--torque-limit", "3")
    assert done.returncode == 0, done.stderr
    assert "--mass: heavy is not allowed" in done.stderr
    assert "Mass of the robot with wheels and usual load, on a scale [kg]" in done.stdout + done.stderr
    robot = read_robot(tmp_path / "mine.toml")
    assert [robot.value(name) for name in ("base.mass", "wheel.radius", "drivetrain.torque_limit")] == [20.0, 0.05, 3.0]


def test_at_a_terminal_it_asks_for_the_gear_of_a_motor_that_senses(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers = ["20 kg", "50 mm", "0.2", "circle 45 cm", "0.3", "", "", "", "", "0.03 N.m/A", "20", ""]
    monkeypatch.setattr("sys.stdin", Terminal("\n".join(answers) + "\n"))
    done = cli("robot", "new", "mine.toml")
    assert done.returncode == 0, done.stderr
    assert "(empty: torque sensors)" in done.stderr
    assert "sensed torque" not in done.stderr
    assert read_robot(tmp_path / "mine.toml").motor_current


def test_areas_and_radii_are_those_of_textbooks() -> None:
    triangle = plate(outline_of("", "triangle 0.61"))
    assert triangle.area_m2 == pytest.approx(0.61**2 * 3**0.5 / 4)
    assert triangle.gyration_m == pytest.approx(0.61 / 12**0.5)
    assert triangle.reach_m == pytest.approx(0.61 / 3**0.5)
    box = plate(outline_of("", "rectangle 0.5 x 40 cm"))
    assert (box.area_m2, box.gyration_m**2) == (pytest.approx(0.2), pytest.approx((0.25 + 0.16) / 12.0))
    clockwise = outline_of("", "0,0 0,1 1,0")
    assert plate(clockwise).area_m2 == pytest.approx(0.5)


def test_trikey_is_not_in_doubt(process: Cli, tmp_path: Path) -> None:
    done = process("robot", "check", "trikey", "--out", "trikey.html")
    assert done.returncode == 0, done.stderr
    assert "0 doubts; 81 numbers: 42 assumed, 11 fitted, 18 sourced, 10 given" in done.stdout
    assert "wheel.floor_stiffness" in done.stdout
    page = (tmp_path / "trikey.html").read_text(encoding="utf-8")
    assert "<svg" in page
    assert "centre of mass" in page
    assert "default-src 'none'" in page  # nothing is fetched
    assert not re.search(r'(?:src|href)="(?!#|data:)', page)


@pytest.mark.parametrize("ending", ["svg", "png"])
def test_the_drawing_is_a_picture(ending: str, cli: Cli, tmp_path: Path) -> None:
    assert cli("robot", "check", "trikey", "--out", f"a.{ending}").returncode == 0
    begin = (tmp_path / f"a.{ending}").read_bytes()[:300]
    assert begin.startswith(b"\x89PNG") if ending == "png" else b"<svg" in begin


def test_the_drawing_is_in_the_unit_of_its_labels() -> None:
    figure = draw(Numbers(read_robot(native.robot())), "Trikey")
    above, side = figure.axes
    turns = np.radians([0.0, 120.0, 240.0, 0.0])
    centres = 0.24 * np.column_stack((np.cos(turns), np.sin(turns)))  # robots/trikey.toml: wheel.distance

    def read(axes: Axes, which: str, values: object) -> NDArray[np.float64]:
        unit = unit_of_axis(figure, axes, which)
        assert unit is not None
        try:
            return in_si(values, unit, "m")
        except GivewayError as error:
            raise AssertionError(str(error)) from None

    def compared() -> None:
        over, centre = above.lines[:2]
        for line, wanted in ((over, centres), (centre, np.zeros((1, 2)))):
            assert same(read(above, "x", line.get_xdata()), wanted[:, 0])
            assert same(read(above, "y", line.get_ydata()), wanted[:, 1])
        named = [text for text in above.texts if isinstance(text, Annotation) and text.get_text().isdigit()]
        assert [text.get_text() for text in named] == ["0", "1", "2"]
        for k, axis in enumerate("xy"):
            assert same(read(above, axis, [text.xy[k] for text in named]), centres[:3, k])
        marks = [text for text in side.texts if isinstance(text, Annotation)]
        heights = sorted(float(read(side, "y", text.xy[1])) for text in marks)
        assert heights[:3] == pytest.approx([0.101, 0.2032, 0.414])  # clearance, wheel, centre of mass
        front = [float(read(side, "x", text.xy[0])) for text in marks]
        assert front == pytest.approx([0.352184] * len(marks))  # outline.x

    check_planted(figure, compared)


# A number of Trikey's file, another value in its own unit, and the doubts that this raises.
DOUBTS: dict[str, tuple[str, str, set[str]]] = {
    "base.mass": (
        "34.7",
        "900.0",
        {"density", "torque limit", "yaw inertia", "tilt inertia", "servo", "sensed bandwidth"},
    ),
    "base.yaw_inertia": ("1.31", "0.2", {"yaw inertia"}),
    "base.tilt_inertia": ("2.0", "20.0", {"tilt inertia"}),
    "base.com_height": ("0.414", "1.9", {"tipping", "tilt inertia", "accelerometer"}),
    "admittance.acceleration_limit": ("2.8", "6.0", {"tipping"}),
    "wheel.inertia": ("0.002798", "0.05", {"wheels"}),
    "wheel.distance": ("0.24", "0.1", {"wheels", "tipping"}),
    "wheel.width": ("0.025", "0.4", {"wheels"}),
    "roller.radius": ("0.009525", "0.09", {"rollers"}),
    "roller.coulomb_torque": ("0.2", "2.0", {"roller friction", "threshold"}),
    "roller.presliding_stiffness": ("28900.0", "500.0", {"roller friction"}),
    "outline.clearance": ("0.101", "0.3", {"clearance"}),
    "drivetrain.torque_limit": ("20.0", "3.0", {"torque limit", "gear friction"}),
    "drivetrain.torque_sensor_limit": ("28.0", "15.0", {"torque sensor"}),
    "drivetrain.torque_noise": ("0.03", "0.9", {"torque sensor", "threshold"}),
    "drivetrain.torque_sensor_resolution": ("0.0143", "0.5", {"torque sensor"}),
    "drivetrain.stiffness": ("721.0", "200.0", {"sensed bandwidth", "servo"}),
    "drivetrain.encoder_counts": ("8500", "400", {"encoder"}),
    "electronics.bus_delay": ("1", "4", {"bus"}),
    "imu.height": ("0.414", "0.2", {"accelerometer"}),
    "servo.kd": ("7.02", "200.0", {"servo", "sensed bandwidth"}),
    "contact.stiffness": ("10100.0", "5e6", {"contact stiffness"}),
    "admittance.damping": ("1.6", "40.0", {"escape"}),
}


@pytest.mark.parametrize("name", DOUBTS)
def test_each_implausible_number_is_named(name: str, tmp_path: Path) -> None:
    before, after, rules = DOUBTS[name]
    path = tmp_path / "mine.toml"
    head, found, rest = TRIKEY.partition(f"[{name}]\nvalue = {before}\n")
    assert found
    path.write_text(f"{head}[{name}]\nvalue = {after}\n{rest}", encoding="utf-8")
    raised = doubts(Numbers(read_robot(path)))
    assert {doubt.rule for doubt in raised} & rules, raised
    assert {doubt.rule for doubt in raised} <= rules, raised
    assert name in {entry for doubt in raised for entry in doubt.entries}


def test_every_rule_is_raised_by_one_of_them() -> None:
    assert len(RULES) == 16
    raised = {rule for _, _, rules in DOUBTS.values() for rule in rules}
    assert raised >= {
        *("density", "yaw inertia", "tilt inertia", "tipping", "clearance", "wheels", "roller friction"),
        *("torque limit", "torque sensor", "servo", "encoder", "bus", "threshold", "contact stiffness", "escape"),
        "accelerometer",
    }


def test_a_centre_of_mass_beside_the_wheels(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(TRIKEY + '\n[testbed.base.com_x]\nvalue = -0.1\nunit = "m"\n', encoding="utf-8")
    (doubt,) = [doubt for _, doubt in check(path).doubts if doubt.rule == "centre of mass"]
    assert "close to the line between two wheels" in doubt.words
    path.write_text(path.read_text().replace("-0.1", "-0.2"), encoding="utf-8")
    assert "falls over" in check(path).refused


def test_a_doubt_is_a_warning_with_file_and_line(cli: Cli, tmp_path: Path) -> None:
    text = TRIKEY.replace("value = 1.31", "value = 0.2")
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    done = cli("robot", "check", "mine.toml")
    assert done.returncode == 0
    line = text[: text.index("value = 0.2\n")].count("\n") + 1
    assert f"mine.toml:{line}: yaw inertia: 0.2 kg m2; an even body of this outline and mass has 1.08" in done.stdout


def test_what_is_missing_is_listed_at_once(cli: Cli, tmp_path: Path) -> None:
    start, end = TRIKEY.index("[servo.kp]"), TRIKEY.index("# --- Drive electronics")
    (tmp_path / "mine.toml").write_text(TRIKEY[:start] + TRIKEY[end:], encoding="utf-8")
    done = cli("robot", "check", "mine.toml", "--out", "a.png")
    assert done.returncode == 2
    assert done.stderr.splitlines() == ["giveway: mine.toml: cannot be used: 3 numbers missing"]
    for name in ("servo.kp", "servo.kd", "servo.derivative_cutoff"):
        assert name in done.stdout
    assert folder_content(tmp_path) == ["mine.toml"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("value = 2.75", "value = 3.5", "drivetrain.gear_stiction"),  # below gear_coulomb, the first of both
        ('value = 34.7\nunit = "kg"', 'value = 5e4\nunit = "kg"', "mine.toml:14: base.mass"),
    ],
)
def test_what_the_models_refuse_cannot_be_used(old: str, new: str, words: str, cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(TRIKEY.replace(old, new, 1), encoding="utf-8")
    done = cli("robot", "check", "mine.toml", "--out", "a.png")
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert words in done.stderr
    assert folder_content(tmp_path) == ["mine.toml"]
