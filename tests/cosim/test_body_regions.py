"""The limits of the body regions, and what is made of a force trace."""

from __future__ import annotations

import math

import numpy as np
import pytest
from giveway.body_regions import NOTICE, body_region, body_regions, contact_peak, judge, source, speed_limit
from giveway.errors import GivewayError, UnknownNameError

# ISO/TS 15066:2016, Annex A: quasi-static force N, factor of the transient one, stiffness N/mm, mass kg. Open copies
# disagree: this is the place where a change has to be argued.
ANNEX_A = {
    "skull": (130, 0, 150, 4.4),
    "face": (65, 0, 75, 4.4),
    "neck": (150, 2, 50, 1.2),
    "back and shoulders": (210, 2, 35, 40),
    "chest": (140, 2, 25, 40),
    "abdomen": (110, 2, 10, 40),
    "pelvis": (180, 2, 25, 40),
    "upper arm": (150, 2, 30, 3),
    "forearm": (160, 2, 40, 2),
    "hand": (140, 2, 75, 0.6),
    "thigh and knee": (220, 2, 50, 75),
    "lower leg": (130, 2, 60, 75),
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
        name: (r.lasting_limit_n, r.peak_limit_n / r.lasting_limit_n, r.stiffness_npm / 1e3, r.mass_kg)
        for name, r in body_regions().items()
    }
    assert found == ANNEX_A
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


def test_no_transient_contact_with_the_face() -> None:
    assert judge(TIME_S, trace(), "face").ok
    touched = judge(TIME_S, trace((1.0, 1.1, 1.0)), "face")
    assert not touched.ok
    assert "no transient contact" in str(touched)


def test_noise_of_a_measured_trace_is_no_contact() -> None:
    noise = np.abs(np.random.default_rng(1).normal(0.0, 0.5, TIME_S.size))
    assert judge(TIME_S, noise + trace((1.0, 1.2, 50.0)), "hand", touch_n=5.0).longest_contact_s == pytest.approx(0.199)
    assert judge(TIME_S, noise, "face", touch_n=5.0).ok


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
