"""The clamped leg: forces of robot and wall, and their judgement."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
import xarray
from figure_labels import Curve, across, check_panels, check_planted, curve, keeping
from giveway import batch, experiments
from giveway.experiments.clamping import GAPS_M, REGION, SPEED_MPS, Clamped, _own_row, _safe_speed, scenario
from giveway.experiments.reproduction.findings import Effort, Findings
from giveway.scenario.body_regions import NOTICE, body_region
from giveway.scenario.scenario import ROBOT_BUMPERS
from giveway.simulation.result import Result


@pytest.fixture(scope="module")
def runs() -> list[xarray.Dataset]:
    """Those of the findings, of one batch: the bumpers at the wall and before it, no reflex, and over the speed."""
    return []


@pytest.fixture(scope="module")
def findings(runs: list[xarray.Dataset]) -> Findings:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(batch, "run_many", keeping(batch.run_many, runs))
        return experiments.get("clamping").reproduce(Effort(full=False))


@pytest.fixture(scope="module")
def pushing_on() -> Result:
    return batch.run(scenario("none", reflex=False))


def settled(run: Result, side: str) -> np.ndarray:
    """Magnitude of the force of the robot ("contact") or the wall from 1 s to 1.5 s after the contact, N."""
    since = run.traces["time"].values - float(run.traces["testbed.truth.first_contact_time"].values[-1])
    return np.abs(run.traces[f"testbed.truth.{side}_force"].values[(since > 1.0) & (since < 1.5)])


def test_clamped_leg_is_in_balance(pushing_on: Result) -> None:
    """Robot and wall press alike once all is at rest; the rail's friction may make up 1 N of difference."""
    assert settled(pushing_on, "contact") == pytest.approx(settled(pushing_on, "wall"), abs=1.5)


def test_torque_limit_sets_the_lasting_force(pushing_on: Result) -> None:
    """Two wheels push straight at the wall with their torque limit; stuck gears hold some more or less."""
    parameters = pushing_on.manifest["parameters"]["testbed"]
    force = float(settled(pushing_on, "contact").mean())
    # J^-T of a force along the middle between two wheels: 2/3 cos 30 deg r_w on each.
    torque = 2.0 / 3.0 * math.cos(math.pi / 6.0) * float(parameters["wheel.radius"]) * force
    limit, friction = (float(parameters[f"drivetrain.{name}"]) for name in ("torque_limit", "gear_stiction"))
    assert limit - friction <= torque <= limit + friction


def test_reflex_ends_the_clamping(pushing_on: Result) -> None:
    with_reflex = batch.run(scenario("none"))
    force = np.abs(with_reflex.traces["testbed.truth.contact_force"].values)
    time = with_reflex.traces["time"].values - float(with_reflex.traces["testbed.truth.first_contact_time"].values[-1])
    assert force.max() > 20.0
    assert force[time > 0.5].max() == 0.0
    before = pushing_on.traces["testbed.truth.contact_force"].values
    same = (time > 0.0) & (time < 1e-3 * with_reflex.metric("detection time").value)  # nothing has been noticed yet
    assert same.sum() > 20
    assert force[same] == pytest.approx(np.abs(before[same]))


def test_contact_is_as_stiff_as_leg_and_cover_in_series() -> None:
    stiffness = scenario("none").testbed["contact.stiffness"]
    cover = batch.run(scenario("none", speed_mps=0.05)).manifest["parameters"]["testbed"]
    assert float(stiffness) < body_region(REGION).stiffness_npm
    assert cover["contact.stiffness"] == stiffness
    assert cover["wall.stiffness"] == body_region(REGION).stiffness_npm


def test_rows(findings: Findings) -> None:
    rows = {row.quantity: row for row in findings.rows}
    for place in GAPS_M:
        for bumper in ROBOT_BUMPERS:
            assert rows[f"detection time, {bumper}, {place}"].met
            assert rows[f"lasting force, {bumper}, {place}"].met
        soft, hard = (rows[f"peak force, {bumper}, {place}"].ours for bumper in ("magnetic", "none"))
        assert soft is not None
        assert hard is not None
        assert soft < hard
        pushed = rows[f"lasting force, no reflex, {place}"].ours
        assert pushed is not None
        assert pushed > body_region(REGION).lasting_limit_n
    assert all((row.reason != "") == (row.met is False) for row in findings.rows)
    assert NOTICE in findings.notes
    assert NOTICE in findings.pictures[0].caption


def force_on_leg(runs: xarray.Dataset, run: int) -> tuple[np.ndarray, np.ndarray]:
    """Time since the contact, s, and the larger force of robot and wall, N."""
    contact_s = float(runs["testbed.truth.first_contact_time"].values[run, -1])
    sides = [np.abs(runs[f"testbed.truth.{side}_force"].values[run]) for side in ("contact", "wall")]
    return runs["time"].values - contact_s, np.max(sides, axis=0)


def test_the_figure_s_labels_say_what_it_draws(findings: Findings, runs: list[xarray.Dataset]) -> None:
    (table,), figure = runs, findings.pictures[0].figure
    limits = body_region(REGION)
    # Three bumpers at the wall, then before it; without reflex at the wall, then before it; two speeds of each bumper.
    at_wall = [force_on_leg(table, run) for run in (0, 1, 2, 6)]
    left = [curve(time_s, "s", force_n, "N") for time_s, force_n in at_wall]
    lasting = [limits.peak_limit_n] * 2 + [limits.lasting_limit_n] * 2
    left.append(curve([0.0, 0.5, 0.5, 1.5], "s", lasting, "N"))
    right: list[Curve] = []
    for slow in range(8, 20, 2):
        peaks_n = []
        for run in (slow, slow + 1):
            time_s, force_n = force_on_leg(table, run)
            peaks_n.append(force_n[(time_s >= 0.0) & (time_s < 0.5)].max())
        right.append(curve([0.1, 0.5], "m/s", peaks_n, "N"))
    check_planted(figure, lambda: check_panels(figure, [left, right]))
    assert across(figure.axes[1], "y") == [limits.peak_limit_n]


@pytest.mark.parametrize("harder", ["contact", "wall"])
def test_the_leg_feels_the_larger_force_of_robot_and_wall(harder: str) -> None:
    """0.1 s after the contact a blow of either side, of either sign; 0.8 s after it, a lasting force."""
    time = np.arange(2001) * 1e-3
    forces = {side: np.where((time >= 0.3) & (time < 1.5), 20.0, 0.0) for side in ("contact", "wall")}
    forces[harder][400], forces[harder][1100] = -200.0, 90.0
    columns = {f"testbed.truth.{side}_force": force for side, force in forces.items()}
    columns["testbed.truth.first_contact_time"] = np.full(time.size, 0.3)
    columns["controller.detection.count"] = (time >= 0.35).astype(np.int32)
    table = xarray.Dataset(
        {name: (("run", "time"), values[None, :]) for name, values in columns.items()}, {"time": ("time", time)}
    )
    found = Clamped(table, 0)
    assert (found.judgement.peak_n, found.judgement.lasting_n) == (200.0, 90.0)
    assert found.judgement.peak_time_s == pytest.approx(0.4)
    assert found.detection_ms == pytest.approx(50.0)
    assert found.force_n[350] == 20.0


def test_safe_speed_is_the_last_one_before_the_first_that_fails() -> None:
    def found(*verdicts: bool) -> dict[float, object]:
        return {0.1 * (i + 1): SimpleNamespace(judgement=SimpleNamespace(ok=ok)) for i, ok in enumerate(verdicts)}

    assert _safe_speed(found(True, True, False, True)) == pytest.approx(0.2)  # type: ignore[arg-type]
    assert _safe_speed(found(False, True)) is None  # type: ignore[arg-type]
    assert _safe_speed(found(True)) == pytest.approx(0.1)  # type: ignore[arg-type]
    assert SPEED_MPS == 0.22  # of the paper's 5.3


def test_our_own_reflex_has_a_row_per_bumper_that_says_where_it_fails() -> None:
    def found(lasting_n: float) -> dict[float, object]:
        judged = [SimpleNamespace(ok=ok, peak_n=100.0, lasting_n=lasting_n) for ok in (True, lasting_n < 130.0, True)]
        return {
            speed: SimpleNamespace(judgement=one, detection_ms=400.0)
            for speed, one in zip((0.1, 0.2, 0.5), judged, strict=True)
        }

    good, bad = (_own_row("spring", found(lasting_n)) for lasting_n in (100.0, 150.0))  # type: ignore[arg-type]
    assert (good.ours, good.met, good.reason) == (0.5, True, "")
    assert (bad.ours, bad.met) == (0.1, False)
    assert bad.reason == "at 0.2 m/s the leg is noticed after 400 ms and feels 100 N at first and 150 N lasting"
