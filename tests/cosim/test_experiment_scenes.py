"""The scenes of Fig. 13: what is hit, where, and what is judged."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import synthetic_collision as synthetic
from figure_labels import Curve, check_panels, check_planted, curve, in_si, unit_of_axis
from giveway import batch, experiments
from giveway.base.errors import UnknownNameError
from giveway.experiments.reproduction.findings import Effort, Findings
from giveway.experiments.scenes import SCENES, STEADY_S, VARIANTS, _creeping_roller, _judged_by, scenario
from giveway.robot.footprint import hull, wheel_corners
from giveway.scenario.body_regions import NOTICE
from giveway.scenario.plan import Straight
from giveway.simulation.metrics import Collision
from giveway.simulation.result import Result
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon


@pytest.fixture(scope="module")
def findings() -> Findings:
    return experiments.get("scenes").reproduce(Effort(full=False))


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    return {name: batch.run(scenario(name, "paper")) for name in SCENES}


def collision(result: Result) -> Collision:
    return Collision(result.traces, result.manifest["parameters"])


@pytest.mark.parametrize("name", SCENES)
def test_robot_is_steady_when_it_hits(name: str, results: dict[str, Result]) -> None:
    hit, scene = collision(results[name]), SCENES[name]
    plan = Straight(scene.speed_mps, scene.direction_rad)
    tare_s = 0.1
    # The base lags its plan by what servo and drivetrain give, some millimetres: at most 20 mm.
    assert hit.contact_s == pytest.approx(tare_s + plan.ramp_s + STEADY_S, abs=0.02 / scene.speed_mps)
    row = hit.start - 1
    speed = np.hypot(hit["testbed.truth.vx"][row], hit["testbed.truth.vy"][row])
    assert speed == pytest.approx(scene.speed_mps, rel=0.02)


@pytest.mark.parametrize("name", SCENES)
def test_the_obstacle_s_direction_is_within_half_a_turn(name: str) -> None:
    direction = float(scenario(name).testbed["slider.direction"])
    assert abs(direction) <= np.pi
    ahead = SCENES[name].direction_rad + np.pi + (SCENES[name].edge_rad or 0.0)
    # Equal but for whole turns, whose rounding is 1e-15.
    assert [np.cos(direction), np.sin(direction)] == pytest.approx([np.cos(ahead), np.sin(ahead)], abs=1e-14)


def test_hand_is_hit_by_the_wheel_itself(results: dict[str, Result]) -> None:
    hit = collision(results["hand"])
    point = hit.true_point()
    assert point is not None
    wheel = wheel_corners(results["hand"].manifest["parameters"]["testbed"], SCENES["hand"].height_m)[0]
    low, high = wheel.min(axis=0), wheel.max(axis=0)
    assert (point >= low - 1e-3).all()
    assert (point <= high + 1e-3).all()
    assert point[1] == pytest.approx(high[1], abs=1e-3)  # its front


def test_bicycle_meets_a_corner_and_person_the_body(results: dict[str, Result]) -> None:
    for name, corners in (("bicycle", True), ("person", False)):
        hit = collision(results[name])
        row = hit.start
        point = np.array([hit[f"testbed.truth.contact_base_{axis}"][row] for axis in "xy"])
        parameters = results[name].manifest["parameters"]["testbed"]
        body = np.array([[parameters[f"outline.{axis}[{i}]"] for axis in "xy"] for i in range(3)])
        everything = hull([*body, *wheel_corners(parameters, SCENES[name].height_m).reshape(-1, 2)])
        assert (np.hypot(*(everything - point).T).min() < 1e-3) == corners


def test_every_scene_is_noticed_and_no_limit_is_broken_by_force(findings: Findings) -> None:
    rows = {row.quantity: row for row in findings.rows}
    for name in SCENES:
        assert rows[f"detection time, {name}"].met
        moved = rows[f"moves away by, {name}"].ours
        assert moved is not None
        assert moved > 0.25  # half of the escape: further hits on the way may bend it
    forces = [row for row in findings.rows if "force" in row.quantity and row.target is not None]
    assert len(forces) == 4  # two persons, peak and lasting
    assert all(row.met for row in forces)
    assert NOTICE in findings.notes


def test_peak_is_that_of_the_plant(findings: Findings, results: dict[str, Result]) -> None:
    rows = {row.quantity: row.ours for row in findings.rows}
    for name in ("hand", "person"):
        force = results[name].traces["testbed.truth.contact_force"].values
        assert rows[f"peak force, {name} ({SCENES[name].region})"] == pytest.approx(force.max())


def test_a_miss_says_what_was_changed(findings: Findings) -> None:
    for row in findings.rows:
        assert (row.reason != "") == (row.met is False)
        if row.reason:
            assert all(variant in row.reason for variant in VARIANTS)


def test_false_hits_are_explained_by_the_rollers(findings: Findings) -> None:
    """If the robot takes its rollers for a hit, the note names the wheel and the force; else there is no such note."""
    rows = {row.quantity: row.ours for row in findings.rows}
    for name in SCENES:
        explained = [note for note in findings.notes if note.startswith(f"{name}: ")]
        assert len(explained) == (rows[f"false detections, {name}"] != 0.0)


def test_no_scene_may_detect_what_is_not_there() -> None:
    _, target, _ = _judged_by("")["false detections"]
    assert target is not None
    assert target.met(0.0)
    assert not target.met(1.0)


def test_unknown_scene() -> None:
    with pytest.raises(UnknownNameError, match="bicycle"):
        scenario("bycicle")


def test_picture_has_a_panel_for_each(findings: Findings) -> None:
    (picture,) = findings.pictures
    assert [axes.get_title("left") for axes in picture.figure.axes] == [scene.title for scene in SCENES.values()]


def in_world(result: Result, row: int, points: np.ndarray) -> np.ndarray:
    """Points of the base frame, shape (n, 2), m, in the world."""
    x, y, theta = (float(result.traces[f"testbed.truth.{name}"].values[row]) for name in ("x", "y", "theta"))
    cos, sin = np.cos(theta), np.sin(theta)
    return np.stack([x + cos * points[:, 0] - sin * points[:, 1], y + sin * points[:, 0] + cos * points[:, 1]], axis=1)


def seen_from_above(result: Result) -> tuple[list[Curve], np.ndarray]:
    """What a scene shows but for body, wheels and obstacle; and the corners of body and wheels at the contact."""
    hit, testbed = collision(result), result.manifest["parameters"]["testbed"]
    contact, detected = hit.start, hit.detected
    x, y = (result.traces[f"testbed.truth.{axis}"].values for axis in "xy")
    tip = np.array([result.traces[f"testbed.truth.nose_{axis}"].values[contact] for axis in "xy"])
    along = np.array([np.cos(testbed["slider.direction"]), np.sin(testbed["slider.direction"])])
    estimate = {
        name: np.array([[result.traces[f"controller.detection.{name}_{axis}"].values[detected] for axis in "xy"]])
        for name in ("point", "force")
    }
    place = in_world(result, contact, estimate["point"])
    # An arrow of 4 mm for each newton.
    tail_and_tip = np.concatenate([place, in_world(result, contact, estimate["point"] + 0.004 * estimate["force"])])
    true = hit.true_point()
    assert true is not None
    drawn = (in_world(result, contact, true[None, :]), place, tail_and_tip, np.stack([tip, tip - 0.5 * along]))
    curves = [curve(points[:, 0], "m", points[:, 1], "m") for points in drawn]
    curves += [curve(x[part], "m", y[part], "m") for part in (slice(contact), slice(contact, None))]
    body = np.array([[testbed[f"outline.{axis}[{i}]"] for axis in "xy"] for i in range(3)])
    return curves, np.concatenate([in_world(result, contact, part) for part in (body, *wheel_corners(testbed))])


def test_the_figure_s_labels_say_what_it_draws(findings: Findings, results: dict[str, Result]) -> None:
    figure = findings.pictures[0].figure
    wanted = [seen_from_above(results[name]) for name in SCENES]
    check_planted(figure, lambda: check_panels(figure, [curves for curves, _ in wanted]))
    for axes, (_, corners), name in zip(figure.axes, wanted, SCENES, strict=True):
        unit = unit_of_axis(figure, axes, "x")
        assert unit is not None
        shapes = [in_si(patch.get_xy()[:-1], unit, "m") for patch in axes.patches if isinstance(patch, Polygon)]
        at_contact = np.concatenate(shapes[4:8])  # body and wheels; the four before them stand where it ended
        assert at_contact == pytest.approx(corners, abs=1e-9)
        check_obstacle(axes, unit, SCENES[name].radius_m if name != "bicycle" else None, results[name])


def check_obstacle(axes: Axes, unit: tuple[float, str], radius_m: float | None, result: Result) -> None:
    """Its foremost point is the nose that hits."""
    hit = collision(result)
    nose = np.array([hit[f"testbed.truth.nose_{axis}"][hit.start] for axis in "xy"])
    if radius_m is None:
        edge = in_si(axes.patches[8].get_xy()[:2], unit, "m")  # type: ignore[attr-defined]
        assert edge.mean(axis=0) == pytest.approx(nose)
        return
    disc = axes.patches[8]
    assert isinstance(disc, Circle)
    assert in_si(disc.get_radius(), unit, "m") == pytest.approx(radius_m)
    assert np.linalg.norm(in_si(disc.get_center(), unit, "m") - nose) == pytest.approx(radius_m)


def test_the_note_tells_what_a_creeping_roller_holds_and_what_its_law_knows() -> None:
    """Two hits of a drawn collision, of which the second is late; wheel 0's roller creeps at 2 mm/s."""
    traces = synthetic.traces()
    count = traces["controller.detection.count"].values.copy()
    count[-5:] += 1
    contact = traces["testbed.truth.contact"].values & (traces["time"].values < traces["time"].values[-1] - 0.5)
    size = len(count)
    put = {
        "controller.detection.count": count,
        "testbed.truth.contact": contact,
        "testbed.truth.theta": np.zeros(size),
        "testbed.truth.vx": np.full(size, 0.002),
        "testbed.truth.vy": np.full(size, 0.3),
        "testbed.truth.roller_force[0]": np.full(size, 7.0),
    }
    traces = traces.assign({name: ("time", values) for name, values in put.items()})
    friction = {"roller.radius": 0.01, "roller.coulomb_torque": 0.02, "roller.tanh_slope": 2.5}
    parameters = {**synthetic.PARAMETERS, "testbed": {**synthetic.PARAMETERS["testbed"], **friction}}
    (note,) = _creeping_roller("a scene", SimpleNamespace(traces=traces, manifest={"parameters": parameters}))  # type: ignore[arg-type]
    # 0.02/0.01 tanh(2.5 x 0.002/0.01) = 0.92 N
    assert "direction of wheel 0, whose roller creeps at 2.0 mm/s: stuck, it holds 7 N" in note
    assert "of which (28) knows 0.9 N" in note
