"""The reference by itself: closed forms and balances, without any C++."""

import math

import numpy as np
import pytest
from kkt_reference import (
    KIND_MAGNETIC,
    KIND_NONE,
    KIND_SPRING,
    LATCH_IDEALISED,
    MOUNT_ROBOT,
    MOUNT_SLIDER,
    STATES,
    Inputs,
    Modes,
    Parameters,
    Reference,
    closest_on_outline,
)
from plant_scenarios import COLLISIONS, collision, disconnected, still


def test_free_spinning_base_moves_as_the_closed_form_says():
    """Without drive and friction, c(nu) turns the velocity at the rate kappa omega and does no
    work."""
    p = disconnected(Parameters())
    kappa = 1.5 * (p.wheel_inertia / p.wheel_radius**2 + p.roller_inertia / p.roller_radius**2)
    kappa /= p.base_mass + kappa
    x = np.zeros(STATES)
    x[3:6] = 0.3, -0.2, 2.0
    end = Reference(p).simulate(x, Modes(), np.array([0.0, 3.0]), [(0.0, Inputs())]).states[-1]
    turned = kappa * 2.0 * 3.0
    expected = complex(0.3, -0.2) * complex(math.cos(turned), math.sin(turned))
    assert end[3:6] == pytest.approx([expected.real, expected.imag, 2.0], abs=1e-10)
    assert abs(turned) > 0.05  # else this would say nothing


def test_static_push_is_shared_between_wheels_and_rollers():
    """At rest J_w^T T + sum(n_i f_i) balances the push: solved here by hand, wheels stuck, bristles
    elastic."""
    p = Parameters(slider_present=0, roller_presliding_stiffness=[2.0e4, 2.6e4, 3.1e4])
    r = Reference(p)
    theta, point = 0.4, np.array([0.1, -0.2])
    force = np.array([6.0, -8.0])
    turn = np.array([[math.cos(theta), -math.sin(theta)], [math.sin(theta), math.cos(theta)]])
    lever = turn @ point
    push = np.array([*force, lever[0] * force[1] - lever[1] * force[0]])
    angles = theta + np.array([0.0, 2.0, 4.0]) * math.pi / 3.0
    j_w = np.stack([-np.sin(angles), np.cos(angles), np.full(3, p.wheel_distance)], axis=1) / p.wheel_radius
    j_n = np.stack([np.cos(angles), np.sin(angles), np.zeros(3)], axis=1)
    k = p.drivetrain_stiffness * j_w.T @ j_w + j_n.T @ np.diag(p.roller_presliding_stiffness) @ j_n
    shift = np.linalg.solve(k, push)
    x = np.zeros(STATES)
    x[2] = theta
    x[12:15] = j_w @ shift
    x[15:18] = j_n @ shift
    rate = r.rhs(0.0, x, Inputs(push_force=tuple(force), push_point=tuple(point)), Modes())
    assert np.abs(rate[0:24]).max() < 1e-10  # 10 N on 34.7 kg are 0.3 m/s2


def test_unloaded_state_is_an_equilibrium():
    for mount in (MOUNT_SLIDER, MOUNT_ROBOT):
        for kind in (KIND_NONE, KIND_SPRING, KIND_MAGNETIC):
            p = Parameters(bumper_mount=mount, bumper_kind=kind, rope_attached=0, bumper_latch_model=LATCH_IDEALISED)
            r, x, modes = still(p)
            assert np.abs(r.rhs(0.0, x, Inputs(), modes)).max() < 1e-12


@pytest.mark.parametrize("name", ["none", "magnetic continuous on robot", "magnetic idealised on slider"])
def test_energy_closes(name):
    """D sums the dissipation of every element; the stored energy is computed from the state alone: only correct physics
    makes them agree."""
    r, x, modes, inputs = collision(COLLISIONS[name])
    run = r.simulate(x, modes, np.linspace(0.0, 0.6, 31), inputs)
    start = r.stored_energy(x, modes)
    residual = [s[24] - s[25] - (r.stored_energy(s, m) - start) for s, m in zip(run.states, run.modes, strict=True)]
    assert len(run.events) > 3
    # Local errors of 1e-10 over some thousand steps against Joules turned over.
    assert np.abs(residual).max() < 1e-8 * run.states[-1, 25]


def test_closest_point_against_a_finely_sampled_outline():
    rng = np.random.default_rng(11)
    outline = Parameters().outline
    corners = np.array(outline)
    share = np.linspace(0.0, 1.0, 4001)[:, None]
    samples = np.concatenate([a + share * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)])
    inward = [np.array([-(b - a)[1], (b - a)[0]]) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    seen = {True: 0, False: 0}
    for q in rng.uniform(-0.5, 0.5, (400, 2)):
        distance, *rest = closest_on_outline(q[0], q[1], outline)
        point, normal = np.array(rest[0:2]), np.array(rest[2:4])
        inside = all((q - a) @ w > 0.0 for a, w in zip(corners, inward, strict=True))
        seen[inside] += 1
        nearest = np.min(np.linalg.norm(samples - q, axis=1))
        assert (distance < 0.0) == inside
        # Samples are 0.15 mm apart: the sampled distance errs by h^2/(8 d) or, close to the
        # outline, h/2.
        assert abs(distance) == pytest.approx(nearest, abs=8e-5)
        assert point + distance * normal == pytest.approx(q, abs=1e-12)
    assert min(seen.values()) > 50


def test_relatching_conserves_momentum_and_accounts_for_its_loss():
    p = Parameters(bumper_kind=KIND_MAGNETIC, bumper_latch_model=LATCH_IDEALISED, rope_attached=0)
    r = Reference(p)
    x = np.zeros(STATES)
    x[19], x[23] = 0.2, -0.6
    after = r.relatch(x, Modes())
    momentum = (p.slider_mass - p.bumper_plate_mass) * 0.2 + p.bumper_plate_mass * 0.8
    assert after[19] * p.slider_mass == pytest.approx(momentum, rel=1e-12)
    reduced = p.bumper_plate_mass * (p.slider_mass - p.bumper_plate_mass) / p.slider_mass
    assert after[25] == pytest.approx(0.5 * reduced * 0.6**2, rel=1e-12)
