"""Presliding: the static model against a closed form and the plant, and the calibration of three stiffnesses."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import giveway
import numpy as np
import pytest
from giveway import batch
from giveway.base.errors import GivewayError
from giveway.experiments.static_push_study.placements import Placement, default_outline, middles, random_placements
from giveway.experiments.static_push_study.trials import READ_S, STEP_S, Trial
from giveway.identification.presliding import Base, KnownPush, calibrate, felt_wrench, static_torques

BASE = Base(wheel_radius_m=0.1, wheel_distance_m=0.25, drivetrain_stiffness_nm_per_rad=700.0)
STIFFNESS = np.array([12e3, 25e3, 60e3])


def known(
    placement: Placement, stiffness: np.ndarray = STIFFNESS, base: Base = BASE, force_n: float = 10.0
) -> KnownPush:
    wrench = placement.wrench(force_n)
    torque = static_torques(base, stiffness, wrench)
    return KnownPush((wrench[0], wrench[1]), (placement.x_m, placement.y_m), tuple(torque))


def three() -> list[KnownPush]:
    return [known(placement) for placement in middles(default_outline())]


def compensated(base: Base, stiffness: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """Felt wrench plus what the rollers carry, written out wheel by wheel."""
    displacement = np.linalg.solve(base.wheel_jacobian, -torque / base.drivetrain_stiffness_nm_per_rad)
    wrench = felt_wrench(base, torque)
    for wheel, angle in enumerate(base.azimuth_rad):
        deflection = math.cos(angle) * displacement[0] + math.sin(angle) * displacement[1]
        wrench[0] += stiffness[wheel] * deflection * math.cos(angle)
        wrench[1] += stiffness[wheel] * deflection * math.sin(angle)
    return wrench


@pytest.mark.parametrize("placement", random_placements(default_outline(), 5, np.random.default_rng(1)))
def test_equal_rollers_take_one_share_of_the_force_and_nothing_of_the_moment(placement: Placement) -> None:
    sigma, k_w = 30e3, BASE.stiffness_at_floor_n_per_m
    wrench = placement.wrench(10.0)
    felt = felt_wrench(BASE, static_torques(BASE, np.full(3, sigma), wrench))
    np.testing.assert_allclose(felt, wrench * [k_w / (k_w + sigma), k_w / (k_w + sigma), 1.0], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("lean", [0.0, 0.4])
def test_the_plant_transfers_a_static_push_as_the_closed_form_says(lean: float) -> None:
    sigma = 30e3
    placement = Placement(-0.176, 0.1, lean)
    scenario = Trial(placement, (sigma, sigma, sigma)).scenario()
    names = [f"testbed.truth.wheel_torque[{wheel}]" for wheel in range(3)]
    table = batch.run_many([scenario], threads=1, traces=names)
    read = slice(-round(READ_S / STEP_S), None)
    torque = np.array([table[name].values[0, read].mean() for name in names])
    base = Base.of_robot()
    share = base.stiffness_at_floor_n_per_m / (base.stiffness_at_floor_n_per_m + sigma)
    # Half a percent: the drivetrains still oscillate, and the mean is over about one period.
    expected = placement.wrench(9.81) * [share, share, 1.0]
    np.testing.assert_allclose(felt_wrench(base, torque), expected, atol=0.005 * 9.81)


def test_three_pushes_give_three_different_stiffnesses() -> None:
    found = calibrate(three(), BASE)
    np.testing.assert_allclose(found.stiffness_n_per_m, STIFFNESS, rtol=1e-9)
    assert found.force_residual_n < 1e-9
    assert found.moment_residual_nm < 1e-9


def test_two_pushes_of_different_directions_are_enough() -> None:
    np.testing.assert_allclose(calibrate(three()[:2], BASE).stiffness_n_per_m, STIFFNESS, rtol=1e-9)


def test_wheels_may_sit_elsewhere() -> None:
    turned = dataclasses.replace(BASE, azimuth_rad=(0.5, 0.5 + 4 * math.pi / 3, 0.5 + 2 * math.pi / 3))
    pushes = [known(placement, base=turned) for placement in middles(default_outline())]
    np.testing.assert_allclose(calibrate(pushes, turned).stiffness_n_per_m, STIFFNESS, rtol=1e-9)


def test_the_stated_uncertainty_is_that_of_the_result() -> None:
    draw, noise_nm = np.random.default_rng(2), 0.005
    deviations = []
    for _ in range(300):
        pushes = [
            dataclasses.replace(push, torque_nm=tuple(np.add(push.torque_nm, draw.normal(0.0, noise_nm, 3))))
            for push in three()
        ]
        found = calibrate(pushes, BASE, noise_nm)
        deviations.append((found.stiffness_n_per_m - STIFFNESS) / found.sigma_n_per_m)
    # 300 draws tell a standard deviation to 4 %; the scaling only ever widens sigma.
    assert np.all(np.abs(np.mean(deviations, axis=0)) < 0.25)
    assert np.all((np.std(deviations, axis=0) > 0.7) & (np.std(deviations, axis=0) < 1.1))


def test_a_wrong_drivetrain_stiffness_is_repaired_by_the_stiffnesses_found_with_it() -> None:
    wrong = dataclasses.replace(BASE, drivetrain_stiffness_nm_per_rad=0.8 * BASE.drivetrain_stiffness_nm_per_rad)
    found = calibrate(three(), wrong)
    np.testing.assert_allclose(found.stiffness_n_per_m, 0.8 * STIFFNESS, rtol=1e-9)
    wrench = Placement(-0.176, 0.1, 0.3).wrench(10.0)
    torque = static_torques(BASE, STIFFNESS, wrench)
    np.testing.assert_allclose(compensated(wrong, found.stiffness_n_per_m, torque), wrench, rtol=1e-9, atol=1e-9)


def test_what_is_found_are_parameters_of_the_controller() -> None:
    parameters = calibrate(three(), BASE).controller_parameters()
    scenario = Trial(Placement(-0.176, 0.0, 0.0), (1e4, 1e4, 1e4), controller=parameters).scenario()
    assert scenario.parameters("controller")["estimator.presliding_stiffness[2]"] == pytest.approx(60e3)
    assert scenario.parameters("controller")["estimator.friction_model"] == 1


def scaled(push: KnownPush, by: float) -> KnownPush:
    return dataclasses.replace(push, torque_nm=tuple(by * torque for torque in push.torque_nm))


AHEAD = Placement(-0.176, 0.1, 0.0)
ALONG = [known(AHEAD), known(Placement(-0.176, -0.1, 0.0)), known(Placement(-0.176, 0.2, math.pi))]
ALMOST_ALONG = [known(AHEAD), known(Placement(-0.176, 0.0, 0.005))]


@pytest.mark.parametrize(
    ("pushes", "field", "says"),
    [
        ([], "pushes", "at least 2"),
        ([known(AHEAD)], "pushes", "at least 2"),
        (ALONG, "pushes", "at least two different directions"),
        (ALMOST_ALONG, "pushes", "uncertain by"),
        ([*ALONG, scaled(known(AHEAD), -1.0)], "pushes[3].torque_nm", "sign"),
        ([scaled(known(AHEAD), 1e3), *three()], "pushes[0].torque_nm", "unit"),
        (
            [*three(), dataclasses.replace(known(AHEAD), torque_nm=(0.0, math.nan, 0.0))],
            "pushes[3].torque_nm",
            "-10000 to 10000 N m",
        ),
        (
            [*three(), dataclasses.replace(known(AHEAD), torque_nm=(0.0, 0.1))],
            "pushes[3].torque_nm",
            "3 numbers in N m",
        ),
        ([*three(), dataclasses.replace(known(AHEAD), point_m=(20.0, 0.0))], "pushes[3].point_m", "-10 to 10 m"),
        ([*three(), dataclasses.replace(known(AHEAD), point_m=(-0.176, -0.1))], "pushes[3].torque_nm", "point"),
        ([*three(), dataclasses.replace(known(AHEAD), force_n=(0.0, 0.0))], "pushes[3].force_n", "other than zero"),
        ([*three(), known(AHEAD, np.full(3, 1.0))], "pushes", "did a roller slip"),
        ([known(placement, np.full(3, -20e3)) for placement in middles(default_outline())], "pushes", "smaller than"),
    ],
)
def test_pushes_that_cannot_tell_are_refused(pushes: list[KnownPush], field: str, says: str) -> None:
    with pytest.raises(GivewayError) as refused:
        calibrate(pushes, BASE)
    assert refused.value.field == field
    assert says in str(refused.value)


def test_noise_that_hides_the_stiffnesses_is_refused() -> None:
    with pytest.raises(GivewayError, match="uncertain"):
        calibrate(three(), BASE, torque_sigma_nm=0.1)


def test_the_page_calibrates() -> None:
    page = Path(__file__).parents[2] / "docs/site/how_to/calibrate_rollers_at_rest.md"
    block = next(text for text in page.read_text(encoding="utf-8").split("```python")[1:] if "calibrate(" in text)
    names: dict[str, Any] = {"giveway": giveway}
    exec(block.split("```")[0], names)
    # Its torques are those of 22, 30 and 26 kN/m, printed to 0.01 N m: noise of 0.003 N m where 0.005 is assumed.
    deviation = names["found"].stiffness_n_per_m - [22e3, 30e3, 26e3]
    assert np.all(np.abs(deviation) < 2.0 * names["found"].sigma_n_per_m)
    assert names["scenario"].controller["estimator.friction_model"] == 1


def test_a_base_needs_its_numbers() -> None:
    with pytest.raises(GivewayError, match=r"Base\.wheel_radius_m"):
        Base(0.0, 0.24, 668.0)


def test_a_wheel_whose_rollers_carry_nothing_is_not_refused() -> None:
    # Its stiffness comes out within the noise of zero, on either side.
    stiffness = np.array([12e3, 0.0, 60e3])
    found = calibrate([known(placement, stiffness) for placement in middles(default_outline())], BASE)
    # Torques of the model itself: rounding remains, 4e-12 N/m are seen.
    np.testing.assert_allclose(found.stiffness_n_per_m, stiffness, rtol=1e-12, atol=1e-9)
