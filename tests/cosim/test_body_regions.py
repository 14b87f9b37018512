"""The limits of the body regions, and what is made of a force trace."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path

import giveway
import numpy as np
import pytest
import reference_metrics
from giveway.base import native
from giveway.base.errors import GivewayError, UnknownNameError
from giveway.robot.variables import table
from giveway.scenario.body_regions import NOTICE, body_region, body_regions, contact_peak, judge, source, speed_limit

# ISO/TS 15066:2016, Annex A: quasi-static force N and pressure N/cm2, factor of the transient ones, stiffness N/mm,
# mass kg. Open copies disagree, and the lowest counts (body_regions.toml): here a change has to be argued.
ANNEX_A = {
    "skull": (130, 110, 0, 150, 4.4),
    "face": (65, 65, 0, 75, 4.4),
    "neck": (150, 140, 2, 50, 1.2),
    "back and shoulders": (210, 160, 2, 35, 40),
    "chest": (140, 120, 2, 25, 40),
    "abdomen": (110, 140, 2, 10, 40),
    "pelvis": (180, 210, 2, 25, 40),
    "upper arm": (150, 190, 2, 30, 3),
    "forearm": (160, 180, 2, 40, 2),
    "hand": (140, 190, 2, 75, 0.6),
    "thigh and knee": (220, 220, 2, 50, 75),
    "lower leg": (130, 210, 2, 60, 75),
}
TIME_S = np.arange(4000) * 1e-3


def trace(*pieces: tuple[float, float, float]) -> np.ndarray:
    """A force that is ``n`` from ``start`` up to ``end`` s, for each piece."""
    force = np.zeros_like(TIME_S)
    for start, end, n in pieces:
        force[slice(*np.searchsorted(TIME_S, (start - 1e-9, end - 1e-9)))] = n
    return force


def test_limits_are_those_of_the_annex() -> None:
    found = {
        name: (
            r.lasting_limit_n,
            r.lasting_pressure_limit,
            r.peak_limit_n / r.lasting_limit_n,
            r.stiffness_npm / 1e3,
            r.mass_kg,
        )
        for name, r in body_regions().items()
    }
    assert found == ANNEX_A
    for region in body_regions().values():
        share = region.peak_limit_n / region.lasting_limit_n
        assert region.peak_pressure_limit == share * region.lasting_pressure_limit
    assert "15066:2016" in source()
    assert "the standard itself decides" in NOTICE


def test_two_mass_model_against_an_integrated_collision() -> None:
    """Robot and leg as two masses and a spring, integrated: the largest spring force is the formula's."""
    leg, robot_kg, speed, dt = body_region("lower leg"), 34.7, 0.22, 2e-5
    reciprocal_mass = 1.0 / leg.mass_kg + 1.0 / robot_kg
    compression, rate, largest = 0.0, speed, 0.0
    while compression >= 0.0:
        rate -= 0.5 * dt * leg.stiffness_npm * compression * reciprocal_mass
        compression += dt * rate
        rate -= 0.5 * dt * leg.stiffness_npm * compression * reciprocal_mass
        largest = max(largest, leg.stiffness_npm * compression)
    # Steps of omega dt = 50 rad/s x 20 us = 1e-3: leapfrog is (omega dt)^2/24 off, and the largest step misses the
    # peak by up to (omega dt)^2/8, in all 1.7e-7.
    assert contact_peak(leg, speed, robot_kg) == pytest.approx(largest, rel=2e-7)


def test_the_papers_speed_lies_at_the_limit_of_a_rigid_lower_leg() -> None:
    assert speed_limit("lower leg", 34.7) == pytest.approx(0.218, abs=5e-4)  # as many digits as are stated
    assert speed_limit("lower leg", 34.7 + 7.6) == pytest.approx(0.204, abs=5e-4)
    assert contact_peak("lower leg", speed_limit("lower leg", 34.7), 34.7) == pytest.approx(260.0)


def test_padding_is_in_series() -> None:
    leg = body_region("lower leg")
    rigid = contact_peak(leg, 0.2, 34.7)
    assert contact_peak(leg, 0.2, 34.7, padding_npm=leg.stiffness_npm) == pytest.approx(rigid / math.sqrt(2.0))
    assert speed_limit(leg, 34.7, padding_npm=723.0) > 4.0 * speed_limit(leg, 34.7)  # sqrt(60000/723) = 9.1
    assert speed_limit("face", 34.7) == 0.0


def test_peak_and_lasting_force_have_their_own_time() -> None:
    found = judge(TIME_S, trace((1.0, 1.1, 200.0), (1.1, 2.0, 120.0)), "lower leg")
    assert (found.peak_n, found.peak_time_s) == (200.0, pytest.approx(1.0))
    assert (found.lasting_n, found.lasting_time_s) == (120.0, pytest.approx(1.501))
    assert found.ok
    assert found.longest_contact_s == pytest.approx(0.999)


@pytest.mark.parametrize(
    ("pieces", "peak_ok", "lasting_ok"),
    [
        ([(1.0, 1.3, 260.0)], True, True),
        ([(1.0, 1.3, 260.1)], False, True),
        ([(1.0, 2.0, 130.0)], True, True),
        ([(1.0, 2.0, 130.1)], True, False),
        ([(1.0, 1.45, 200.0), (1.46, 2.0, 200.0)], True, False),  # chatter does not start a new contact
        ([(1.0, 1.3, 200.0), (1.9, 2.2, 200.0)], True, True),  # two separate blows
        ([], True, True),
    ],
)
def test_each_limit_fails_alone(pieces: list[tuple[float, float, float]], peak_ok: bool, lasting_ok: bool) -> None:
    found = judge(TIME_S, trace(*pieces), "lower leg")
    assert (found.peak_ok, found.lasting_ok) == (peak_ok, lasting_ok)
    assert found.ok == (peak_ok and lasting_ok)
    assert NOTICE in str(found)
    assert ("within" if found.ok else "above") in str(found)


def test_a_run_too_short_for_the_lasting_force_is_not_called_within_the_limits() -> None:
    """The force counts as lasting from 0.5 s after the first touch."""
    for end_s, known in ((1.49, False), (1.52, True)):
        rows = end_s > TIME_S
        found = judge(TIME_S[rows], trace((1.0, 3.0, 100.0))[rows], "lower leg", contact_area_m2=1e-3)
        assert found.lasting_known == known
        assert found.ok == known
        assert str(found).startswith(f"lower leg: {'' if known else 'not known to be '}within the limits: peak 100 N")
        assert ("lasting 100 N" in str(found)) == known
        assert ("lasting not known, the run ended too soon" in str(found)) != known
    above = judge(TIME_S[TIME_S < 1.2], trace((1.0, 3.0, 300.0))[TIME_S < 1.2], "lower leg")
    assert str(above).startswith("lower leg: above the limits: peak 300 N")


def test_no_transient_contact_with_the_face() -> None:
    assert judge(TIME_S, trace(), "face").ok
    touched = judge(TIME_S, trace((1.0, 1.1, 1.0)), "face")
    assert not touched.ok
    assert "no transient contact" in str(touched)


def test_noise_of_a_measured_trace_is_no_contact() -> None:
    noise = np.abs(np.random.default_rng(1).normal(0.0, 0.5, TIME_S.size))
    assert judge(TIME_S, noise + trace((1.0, 1.2, 50.0)), "hand", touch_n=5.0).longest_contact_s == pytest.approx(0.199)
    assert judge(TIME_S, noise, "face", touch_n=5.0).ok


@pytest.mark.parametrize("touch_n", [0.0, 40.0])
def test_any_trace_is_judged_as_by_the_reference(touch_n: float) -> None:
    """Blows and pauses of all lengths on an uneven grid; no arithmetic but differences of times, so the bits agree."""
    for seed in range(200):
        rng = np.random.default_rng(seed)
        time_s = np.cumsum(rng.uniform(0.001, 0.2, 60))
        force_n = np.repeat(rng.choice([0.0, 30.0, 60.0, 90.0], 20), 3) * rng.uniform(0.5, 1.0, 60)
        found = judge(time_s, force_n, "hand", touch_n=touch_n)
        reference = reference_metrics.judge_force(time_s, force_n, touch_n)
        assert dataclasses.astuple(reference) == (
            found.peak_n, found.peak_time_s, found.lasting_n, found.lasting_time_s, found.longest_contact_s,
            found.lasting_known,
        )  # fmt: skip


def test_wrong_input_is_named() -> None:
    with pytest.raises(UnknownNameError, match="lower leg"):
        judge(TIME_S, trace(), "lower lag")
    for time, force, words in (
        (TIME_S, -trace((1.0, 2.0, 1.0)), "force_n: .*negative"),
        (TIME_S, trace()[1:], "force_n: .*shape"),
        (TIME_S[::-1], trace(), "time_s: "),
        (TIME_S, np.where(TIME_S > 1.0, np.nan, 0.0), "force_n: .*NaN"),
    ):
        with pytest.raises(GivewayError, match=words):
            judge(time, force, "hand")
    with pytest.raises(GivewayError, match="touch_n: -1"):
        judge(TIME_S, trace(), "hand", touch_n=-1.0)
    for speed, mass, padding, words in (
        (-1.0, 1.0, 1.0, "speed_mps"),
        (1.0, 0.0, 1.0, "robot_kg"),
        (1.0, 1.0, 0.0, "padding"),
    ):
        with pytest.raises(GivewayError, match=words):
            contact_peak("hand", speed, mass, padding)


# Pressure


def test_the_mean_pressure_is_judged_where_the_area_is_known() -> None:
    force = trace((0.1, 0.2, 200.0), (2.0, 2.8, 90.0))
    unknown = judge(TIME_S, force, "lower leg")
    assert unknown.peak_pressure is unknown.lasting_pressure is None
    assert "pressure" not in str(unknown)
    wide = judge(TIME_S, force, "lower leg", contact_area_m2=10e-4)
    assert (wide.peak_pressure, wide.lasting_pressure) == pytest.approx((20.0, 9.0))
    assert wide.ok
    assert "mean pressure on 10 cm2: peak 20.0 N/cm2 (allowed: 420 N/cm2), lasting 9.0 N/cm2" in str(wide)
    # An edge of 0.4 cm2: 500 N/cm2 and 225 N/cm2 of 420 and 210, by forces that are allowed.
    edge = judge(TIME_S, force, "lower leg", contact_area_m2=0.4e-4)
    assert unknown.ok
    assert not edge.peak_ok
    assert not edge.lasting_ok
    assert "above the limits" in str(edge)
    assert not judge(TIME_S, trace((0.1, 0.2, 1.0)), "face", contact_area_m2=1e-3).peak_ok  # nothing transient at all


@pytest.mark.parametrize("area", [0.0, -1e-3, 2.0, math.nan, True, "10 cm2"])
def test_areas_out_of_range_are_refused(area: object) -> None:
    with pytest.raises(GivewayError, match="contact_area_m2"):
        judge(TIME_S, trace(), "hand", contact_area_m2=area)  # type: ignore[arg-type]


# What is hit


def test_a_scenario_with_a_body_region_is_hit_by_that_body() -> None:
    leg = giveway.Scenario("leg", 1.0, testbed={"slider.present": True}, body_region="lower leg")
    parameters = leg.parameters("testbed")
    cover = float(table("testbed")["contact.stiffness"].start or 0.0)
    assert parameters["slider.mass"] == 75.0
    assert parameters["contact.stiffness"] == 1.0 / (1.0 / 60000.0 + 1.0 / cover)
    assert leg.judged is body_region("lower leg")
    # The same slider, judged only.
    judged = giveway.Scenario("leg", 1.0, testbed={"slider.present": True, "slider.mass": 13.62}, judge_as="lower leg")
    assert judged.parameters("testbed")["slider.mass"] == 13.62
    assert "contact.stiffness" not in judged.parameters("testbed")
    assert judged.judged is body_region("lower leg")


def test_the_robot_files_cover_is_in_front_of_the_body(tmp_path: Path) -> None:
    path = tmp_path / "soft.toml"
    text = native.robot().read_text(encoding="utf-8")
    path.write_text(text.replace('value = 10100.0\nunit = "N/m"', 'value = 2.0\nunit = "N/mm"'), encoding="utf-8")
    hand = giveway.Scenario("hand", 1.0, testbed={"slider.present": True}, body_region="hand", robot=path)
    assert hand.parameters("testbed")["contact.stiffness"] == 1.0 / (1.0 / 75000.0 + 1.0 / 2000.0)


@pytest.mark.parametrize(("changes", "field", "words"), [
    ({"testbed": {"slider.mass": 13.62}}, "testbed.slider.mass", ("75 kg", "leave it out", 'judge_as = "lower leg"')),
    ({"testbed": {"contact.stiffness": 2e4}}, "testbed.contact.stiffness", ("60000 N/m", "leave it out", "judge_as")),
    ({"judge_as": "hand"}, "judge_as", ("body_region",)),
    ({"testbed": {"slider.present": False}}, "body_region", ("lower leg", "slider.present")),
    ({"body_region": None, "judge_as": "hnad"}, "judge_as", ("hand",)),
    ({"body_region": None, "contact_area_m2": 1e-3}, "contact_area_m2", ("body_region or judge_as",)),
    ({"contact_area_m2": 0.0}, "contact_area_m2", ("1e-06 to 1",)),
])  # fmt: skip
def test_what_contradicts_the_body_is_refused(changes: dict[str, object], field: str, words: Sequence[str]) -> None:
    testbed = {"slider.present": True, **changes.get("testbed", {})}  # type: ignore[dict-item]
    with pytest.raises(GivewayError) as refusal:
        giveway.Scenario(**{"name": "x", "duration_s": 1.0, "body_region": "lower leg", **changes, "testbed": testbed})
    assert refusal.value.field == field
    for word in words:
        assert word in str(refusal.value)


def test_the_simulated_peak_is_the_two_mass_models() -> None:
    """A bare rigid wall of a robot, hit by a hand: locked drives, so 0.6 kg against the robot's whole mass and more."""
    testbed = {
        "slider.present": True,
        "rope.attached": False,
        "slider.friction": 0.0,
        "slider.speed": 0.5,
        "slider.run_up": 0.05,
        "contact.damping": 0.0,
    }
    scenario = giveway.Scenario("hand", 0.3, bumper="none", testbed=testbed, body_region="hand")
    peak = giveway.run(scenario).metric("peak force of the run").value
    cover = float(table("testbed")["contact.stiffness"].start or 0.0)
    # Between the base alone and a wall that does not move at all: 0.9 % apart.
    assert contact_peak("hand", 0.5, 34.7, cover) <= peak <= contact_peak("hand", 0.5, 1e6, cover)
