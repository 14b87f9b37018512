"""Wheels in the outline, a long edge as nose, a wall behind the slider: against brute force and closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from kkt_reference import CONTACT, KIND_NONE, NOSE_EDGE, STATES, WALL, Inputs, Modes, Parameters
from plant_probe import Plant

STILL = Parameters(bumper_kind=KIND_NONE, rope_attached=0, slider_run_up=0.0, slider_friction=0.0)
SPACING = 1e-4  # m, of the sampled outline


def sampled_sections(p: Parameters) -> np.ndarray:
    """Points of the outlines of body and wheels where a horizontal plane cuts them, from discs in space."""
    polygons = []
    if p.outline_body:
        polygons.append(np.array(p.outline))
    for azimuth in (0.0, 2.0 * math.pi / 3.0, -2.0 * math.pi / 3.0):
        # The rim, walked around in space; where it passes the plane are the ends of the cut.
        turn = np.linspace(-math.pi, math.pi, 2_000_001)
        height = p.wheel_radius * (1.0 + np.sin(turn))
        half = np.abs(p.wheel_radius * np.cos(turn))[np.argmin(np.abs(height - p.contact_height))]
        radial, rolling = (
            np.array([math.cos(azimuth), math.sin(azimuth)]),
            np.array([-math.sin(azimuth), math.cos(azimuth)]),
        )
        corners = [(1, -1), (1, 1), (-1, 1), (-1, -1)]
        polygons.append(
            np.array([(p.wheel_distance + 0.5 * u * p.wheel_width) * radial + w * half * rolling for u, w in corners])
        )
    points = []
    for polygon in polygons:
        for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            points.append(a + np.linspace(0.0, 1.0, int(np.linalg.norm(b - a) / SPACING) + 2)[:, None] * (b - a))
    return np.concatenate(points)


def rectangle(p: Parameters, q: np.ndarray) -> bool:
    """Whether q is inside a wheel's rectangle seen from above: points inside are tested by the multiplier form."""
    for azimuth in (0.0, 2.0 * math.pi / 3.0, -2.0 * math.pi / 3.0):
        u = q[0] * math.cos(azimuth) + q[1] * math.sin(azimuth) - p.wheel_distance
        w = q[1] * math.cos(azimuth) - q[0] * math.sin(azimuth)
        if abs(u) < 0.5 * p.wheel_width and abs(w) < p.wheel_radius:
            return True
    return False


def inside_body(p: Parameters, q: np.ndarray) -> bool:
    corners = np.array(p.outline)
    along = np.roll(corners, -1, axis=0) - corners
    return bool(np.all(along[:, 0] * (q[1] - corners[:, 1]) - along[:, 1] * (q[0] - corners[:, 0]) > 0.0))


@pytest.mark.parametrize(("body", "height"), [(1, 0.12), (1, 0.1016), (0, 0.02), (0, 0.18)])
def test_closest_point_of_body_and_wheels_against_a_sampled_outline(library, body: int, height: float) -> None:
    p = replace(STILL, outline_wheels=1, outline_body=body, contact_height=height, contact_nose_radius=0.02)
    samples, rng, wheels = sampled_sections(p), np.random.default_rng(3), 0
    for q in rng.uniform(-0.5, 0.5, (300, 2)):
        if rectangle(p, q) or (body and inside_body(p, q)):
            continue
        plant = Plant(library, replace(p, slider_target_x=q[0] + p.contact_nose_radius, slider_target_y=q[1]))
        x = np.zeros(STATES)
        depth = plant.indicators(x, Inputs(), Modes())[CONTACT]
        out = plant.outputs(x, Inputs(), Modes())
        point = np.array([out["contact_base_x"], out["contact_base_y"]])
        distances = np.linalg.norm(samples - q, axis=1)
        # Samples 0.1 mm apart: the sampled distance is too long by at most half of that.
        assert p.contact_nose_radius - depth == pytest.approx(distances.min(), abs=0.5 * SPACING)
        assert np.linalg.norm(point - q) == pytest.approx(p.contact_nose_radius - depth, abs=1e-12)
        assert np.linalg.norm(samples - point, axis=1).min() < SPACING
        wheels += abs(np.hypot(*point) - p.wheel_distance) < 0.03
    assert wheels > 15  # else the body would have been tested alone


def test_a_hand_on_the_floor_meets_the_wheel_not_the_body(library) -> None:
    """At 2 cm the wheel's cut is 2 sqrt(r^2 - (r - 2 cm)^2) long; a nose along the rolling direction meets its end."""
    height, gap = 0.02, 0.01
    p = replace(STILL, outline_wheels=1, outline_body=0, contact_height=height, slider_direction=math.pi / 2.0)
    half = math.sqrt(p.wheel_radius**2 - (p.wheel_radius - height) ** 2)
    plant = Plant(library, replace(p, slider_target_x=p.wheel_distance, slider_target_y=-half - gap))
    assert plant.indicators(np.zeros(STATES), Inputs(), Modes())[CONTACT] == pytest.approx(-gap, abs=1e-12)


def test_a_side_against_an_edge_is_held_at_both_ends(library) -> None:
    """Pressed 1 mm deep and straight: each corner of the side takes k times 1 mm, the moments cancel."""
    depth = 1e-3
    p = replace(STILL, contact_nose_shape=NOSE_EDGE, slider_target_x=min(x for x, _ in STILL.outline) + depth)
    plant = Plant(library, p)
    modes = Modes(contact=1)
    out = plant.outputs(np.zeros(STATES), Inputs(), modes)
    assert out["contact_force_x"] == pytest.approx(2.0 * p.contact_stiffness * depth, rel=1e-12)
    assert (out["contact_base_y"], out["contact_force_y"]) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert plant.rhs(np.zeros(STATES), Inputs(), modes)[5] == pytest.approx(0.0, abs=1e-12)
    # Turned, one corner is deeper, and the moment turns the side back onto the edge.
    for angle in (-1e-3, 1e-3):
        x = np.zeros(STATES)
        x[2] = angle
        assert plant.rhs(x, Inputs(), modes)[5] * angle < 0.0


def bounce(library, damping: float) -> tuple[Parameters, np.ndarray, list[tuple[float, int]], np.ndarray, np.ndarray]:
    p = replace(STILL, slider_mass=5.0, wall_present=1, wall_distance=0.01, wall_damping=damping, slider_run_up=1.0)
    x = np.zeros(STATES)
    x[19] = -0.4
    times = np.linspace(0.0, 0.1, 10001)
    plant = Plant(library, p)
    run = plant.simulate(x, Modes(), times, [(0.0, Inputs())], rtol=1e-10, atol=1e-13)
    force = np.array([plant.outputs(s, Inputs(), m)["wall_force"] for s, m in zip(run.states, run.modes, strict=True)])
    return p, run.states, run.events, force, times


def test_a_wall_without_damping_gives_the_slider_back_its_speed(library) -> None:
    """Half a period of the mass on the wall's spring: force v sqrt(k m), duration pi sqrt(m/k)."""
    p, states, events, force, times = bounce(library, 0.0)
    (meets, first), (leaves, second) = events
    assert (first, second) == (WALL, WALL)
    assert meets == pytest.approx(0.01 / 0.4, abs=1e-9)  # the solver's tolerance over some hundred steps
    assert leaves - meets == pytest.approx(math.pi * math.sqrt(p.slider_mass / p.wall_stiffness), rel=1e-8)
    assert states[-1, 19] == pytest.approx(0.4, rel=1e-8)
    # Sampled every 10 us of a half period of 16 ms: cos(2e-3 / 2).
    assert force.max() == pytest.approx(0.4 * math.sqrt(p.wall_stiffness * p.slider_mass), rel=1e-6)
    assert np.trapezoid(force, times) == pytest.approx(2.0 * 0.4 * p.slider_mass, rel=1e-6)


def test_a_damped_wall_takes_what_it_dissipates(library) -> None:
    p, states, _, _, _ = bounce(library, 1.0)
    lost = 0.5 * p.slider_mass * (0.4**2 - states[-1, 19] ** 2)
    assert lost > 0.1  # J
    assert states[-1, 25] == pytest.approx(lost, rel=1e-8)


def test_without_a_wall_nothing_stops_the_slider(library) -> None:
    p = replace(STILL, slider_run_up=1.0)
    x = np.zeros(STATES)
    x[19] = -0.4
    run = Plant(library, p).simulate(x, Modes(), np.array([0.0, 0.1]), [(0.0, Inputs())])
    assert run.events == []
    assert run.states[-1, 18] == pytest.approx(-0.04, rel=1e-12)
