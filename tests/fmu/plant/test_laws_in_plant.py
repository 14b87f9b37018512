"""The laws of bumpers beside spring and magnet in the whole plant, against the multiplier form and its balances."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import random_cases
from bumper_law_reference import KINDS, LAWS
from kkt_reference import MOUNT_ROBOT, MOUNT_SLIDER, ROLLER_BRISTLE, Inputs, Modes, Parameters, Reference
from plant_probe import Plant
from plant_scenarios import collision

MOUNTS = (MOUNT_SLIDER, MOUNT_ROBOT)


def of_law(p: Parameters, name: str, lever_mass: float) -> Parameters:
    for key, value in LAWS[name].items():
        setattr(p, f"bumper_{key}", value)
    p.bumper_lever_mass = lever_mass  # of no meaning to the other laws
    return p


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("mount", MOUNTS)
def test_right_hand_side_and_energy(library, name, mount):
    """Random states, on the slider and on a robot that turns; a lever with and without inertia."""
    rng = np.random.default_rng(11)
    compressed = 0
    for number in range(40):
        p = of_law(random_cases.parameters(rng, KINDS[name], mount, 0, ROLLER_BRISTLE), name, 0.7 * (number % 2))
        p.bumper_travel = 0.05
        reference = Reference(p)
        plant = Plant(library, p)
        for _ in range(4):
            x, u, modes = random_cases.state(rng, reference)
            wanted, found = reference.evaluate(0.0, x, u, modes), plant.rhs(x, u, modes)
            rate = np.array(wanted["rate"])
            # Forces are solved for to 1e-13 m in the reference; some 1e4 m/s2 of the plate.
            assert np.abs(found - rate).max() < 1e-8 * max(1.0, np.abs(rate).max())
            outputs = plant.outputs(x, u, modes)
            assert outputs["bumper_force"] == pytest.approx(wanted["internal_force"], rel=1e-8, abs=1e-7)
            assert outputs["stored_energy"] == pytest.approx(reference.stored_energy(x, modes), rel=1e-9, abs=1e-8)
            compressed += p.slider_present and x[22] > 0.0
    assert compressed > 50


@pytest.mark.parametrize(("name", "mount"), list(itertools.product(LAWS, MOUNTS)))
def test_a_collision_keeps_its_energy(library, name, mount):
    """W - D - stored = 0 through a hit that compresses the bumper and lets go of it again."""
    reference, x, modes, inputs = collision((KINDS[name], mount, 0, {**as_fields(name), "bumper_travel": 0.05}))
    plant, times = Plant(library, reference.p), np.linspace(0.0, 0.6, 301)
    run = plant.simulate(x, modes, times, inputs, 1e-9, 1e-11)
    stored = [
        plant.outputs(state, Inputs(), mode)["stored_energy"] for state, mode in zip(run.states, run.modes, strict=True)
    ]
    residual = run.states[:, 24] - run.states[:, 25] - (np.array(stored) - stored[0])
    assert run.states[:, 22].max() > 0.005
    assert run.states[-1, 25] > 0.1  # J
    # The force's knees are no events: a step over one has a larger error, as a contact's corner has.
    assert np.abs(residual).max() < 5e-7 * run.states[-1, 25]


def as_fields(name: str) -> dict[str, object]:
    return {"bumper_lever_mass": 0.4, **{f"bumper_{key}": value for key, value in LAWS[name].items()}}


def test_a_lever_adds_its_inertia_to_the_plate(library):
    """Of a plate on a slider that nothing can move: c'' = -F/(m_p + m_l), F the lever's."""
    p = of_law(
        Parameters(bumper_kind=KINDS["lever"], rope_attached=0, slider_mass=1e9, slider_friction=0.0), "lever", 0.8
    )
    p.bumper_plate_mass, p.bumper_damping, p.bumper_guide_friction = 0.5, 0.0, 0.0
    x = np.zeros(28)
    x[18], x[22] = -0.5, 0.02
    rate = Plant(library, p).rhs(x, Inputs(), Modes())
    force = 1.6 * (3.0 + 400.0 * 1.6 * 0.02)
    assert rate[23] == pytest.approx(-force / 1.3, rel=1e-6)
