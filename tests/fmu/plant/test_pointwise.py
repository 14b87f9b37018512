"""The C++ plant against the multiplier form at random states: one evaluation at a time, no
integrator between them.

Tolerance 1e-9 of the largest rate of a group (base accelerations, motor accelerations, ...): the
multiplier form solves a 25 x 25 system whose entries span 1e-6 (a roller's inertia) to 100 (1/r_r),
which costs up to six of sixteen digits. Measured: 1e-12.
"""

import ctypes
import itertools
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
import random_cases
from kkt_reference import BUMPER, CONTACT, GRAVITY, INDICATORS, KIND_NONE, MOUNT_ROBOT, ROLLER, Inputs, Reference
from plant_probe import Plant

TOLERANCE = 1e-9
# Rates compared together: each group shares a scale.
GROUPS = {
    "pose": slice(0, 3),
    "base acceleration": slice(3, 6),
    "motor speed": slice(6, 9),
    "motor acceleration": slice(9, 12),
    "wheel speed": slice(12, 15),
    "bristle": slice(15, 18),
    "slider, weight, bumper": slice(18, 24),
    "powers": slice(24, 26),
    "contact force": slice(26, 28),
}
COMBINATIONS = list(itertools.product((0, 1, 2), (0, 1), (0, 1), (0, 1)))
PARAMETER_SETS, STATES_PER_SET = 30, 5  # of each of the 24 combinations: 3600 states


def cases(seed: int):
    rng = np.random.default_rng(seed)
    for combination in COMBINATIONS:
        for _ in range(PARAMETER_SETS):
            reference = Reference(random_cases.parameters(rng, *combination))
            yield reference, [random_cases.state(rng, reference) for _ in range(STATES_PER_SET)]


def worst_error(
    library: ctypes.CDLL, faults: dict[str, float], limit: int | None = None
) -> tuple[dict[str, float], int]:
    """Worst relative difference of the right-hand sides by group; number of states beyond the
    tolerance."""
    worst = dict.fromkeys(GROUPS, 0.0)
    beyond = 0
    for reference, states in itertools.islice(cases(1), limit):
        plant = Plant(library, reference.p)
        faulty = Reference(replace(reference.p, **faults)) if faults else reference
        for x, u, modes in states:
            expected, found = faulty.rhs(0.0, x, u, modes), plant.rhs(x, u, modes)
            errors = {}
            for name, where in GROUPS.items():
                # 1e-3: a group that is at rest (say, 1e-3 m/s2) needs no relative accuracy.
                scale = max(1e-3, np.abs(expected[where]).max())
                errors[name] = np.abs(found[where] - expected[where]).max() / scale
                assert np.isfinite(errors[name]), random_cases.description(reference, modes)
                worst[name] = max(worst[name], errors[name])
            beyond += max(errors.values()) > TOLERANCE
    return worst, beyond


def test_right_hand_side(library, record_property):
    worst, beyond = worst_error(library, {})
    record_property("worst", {name: float(error) for name, error in worst.items()})
    assert beyond == 0, worst


@pytest.mark.parametrize(
    "fault",
    [{"fault_velocity_term": -1.0}, {"fault_contact_moment": -1.0}, {"fault_external_sign": -1.0}],
    ids=lambda fault: next(iter(fault)),
)
def test_a_planted_fault_turns_the_comparison_red(library, fault):
    """Sign of c(nu), of the contact force's moment, of the external wrench: each must fail the test
    above, and clearly."""
    worst, beyond = worst_error(library, fault, limit=240)
    assert beyond > 100
    assert worst["base acceleration"] > 1e-2


def test_the_random_states_reach_every_element():
    """Otherwise the comparison might agree only because nothing happens."""
    seen: Counter[str] = Counter()
    for reference, states in cases(1):
        p = reference.p
        for x, u, modes in states:
            e = reference.evaluate(0.0, x, u, modes)
            seen["contact"] += e["contact_normal"] > 0.0
            seen["contact, spinning"] += e["contact_normal"] > 0.0 and abs(x[5]) > 1.0
            seen["rope"] += e["tension"] > 0.0
            seen["slack"] += bool(p.slider_present and p.rope_attached and not modes.rope_taut)
            seen["landed"] += bool(modes.landed and x[20] > p.rope_drop_height)
            seen["end stop"] += bool(modes.end_stop and x[22] < 0.0)
            seen["wall"] += bool(modes.walled and x[18] < -p.wall_distance)
            seen["wheels"] += bool(p.outline_wheels and e["contact_normal"] > 0.0)
            seen["edge"] += bool(p.contact_nose_shape and e["contact_normal"] > 0.0)
            seen["bottom stop"] += bool(modes.bottom_stop and x[22] > p.bumper_travel)
            seen["latched"] += bool(modes.latched)
            seen["torque limit"] += max(map(abs, u.motor_torque)) > p.drivetrain_torque_limit
            seen["stuck"] += 0 in modes.gear
            seen["sliding"] += any(modes.gear)
            seen["lifted wheel"] += 0.0 in p.wheel_traction
            seen["no slider"] += not p.slider_present
    assert len(seen) == 16
    assert min(seen.values()) > 20, seen


def test_event_indicators(library):
    compared: Counter[int] = Counter()
    for reference, states in cases(2):
        plant = Plant(library, reference.p)
        for x, u, modes in states:
            expected, found = reference.indicators(0.0, x, u, modes), plant.indicators(x, u, modes)
            for i in range(INDICATORS):
                if reference.event_direction(i, modes):
                    # Torques of some N m, lengths of some mm, forces of some 10 N.
                    scale = max(abs(expected[i]), 1e-3 if i >= CONTACT else 1.0)
                    assert abs(found[i] - expected[i]) < TOLERANCE * scale, (
                        i,
                        random_cases.description(reference, modes),
                    )
                    compared[i] += 1
    assert len(compared) == INDICATORS
    assert min(compared.values()) > 500, compared


def test_transitions(library):
    """Every event from the states in which it can happen: new modes, and the jumps that go with
    them."""
    seen: Counter[str] = Counter()
    for reference, states in itertools.islice(cases(3), 0, None, 3):
        plant = Plant(library, reference.p)
        for start, u, modes in states:
            for i in range(INDICATORS):
                direction = reference.event_direction(i, modes)
                if not direction:
                    continue
                x = start.copy()
                if i < CONTACT:
                    x[9 + i] = 0.0
                elif i >= ROLLER:
                    side = 0.5 if seen[f"{i} -1"] % 2 else -0.5
                    x[12 + i - ROLLER] = (modes.roller[i - ROLLER] + side) * reference.pitch
                    x[12 + i - ROLLER] -= reference.p.roller_phase[i - ROLLER]
                elif i == BUMPER and not modes.latched:
                    x[22], x[23] = 0.0, -abs(x[23])
                fired = np.zeros(INDICATORS)
                fired[i] = direction
                expected, new = reference.transition(0.0, x, u, modes, i)
                found, found_modes = plant.transition(x, u, modes, fired)
                about = f"event {i}, {random_cases.description(reference, modes)}"
                assert found_modes == new, about
                # Speeds of some m/s, losses of some J.
                assert np.abs(found - expected).max() < TOLERANCE, about
                seen[f"{i} {direction}"] += 1
                seen["impact"] += bool(np.abs(expected - x).max() > 1e-3)
    # Those of gears and rollers only fall; the bumper's indicator falls, or rises off the end stop; everything else
    # goes both ways.
    assert len(seen) == 3 + 2 * 6 + 3 + 1
    assert min(seen.values()) > 20, seen


def test_outputs(library):
    for reference, states in itertools.islice(cases(4), 0, None, 3):
        p, plant = reference.p, Plant(library, reference.p)
        for x, u, modes in states:
            e, found = reference.evaluate(0.0, x, u, modes), plant.outputs(x, u, modes)
            force = e["contact_force"]
            expected = {f"wheel_torque[{i}]": e["torque"][i] for i in range(3)}
            expected |= {f"wheel_speed[{i}]": e["rate"][12 + i] for i in range(3)}
            expected |= {f"roller_force[{i}]": p.wheel_traction[i] * e["roller_force"][i] for i in range(3)}
            expected |= {
                "contact_force_x": force[0],
                "contact_force_y": force[1],
                "contact_force": np.hypot(*force),
            }
            expected |= {
                "rope_tension": e["tension"],
                "wall_force": e["wall_force"],
                "stored_energy": reference.stored_energy(x, modes),
                "yaw_rate": x[5],
            }
            # Of the largest acceleration, some 100 m/s2 of a wheel that a stop has caught.
            felt = reference.specific_force(x, e["rate"])
            scale = 1.0 + np.hypot(*felt) + x[5] ** 2
            assert [found["specific_force_x"], found["specific_force_y"]] == pytest.approx(felt, abs=TOLERANCE * scale)
            if p.bumper_kind != KIND_NONE and p.slider_present:
                expected["bumper_force"] = e["internal_force"]
            if p.slider_present:
                qx, qy = e["contact_point"]
                turn = complex(np.cos(x[2]), -np.sin(x[2]))
                base = complex(qx - x[0], qy - x[1]) * turn
                nose = reference.nose(x)
                expected |= {
                    "contact_point_x": qx,
                    "contact_point_y": qy,
                    "contact_base_x": base.real,
                    "contact_base_y": base.imag,
                }
                expected |= {
                    "nose_x": nose[0] + p.contact_nose_radius * reference.ex,
                    "nose_y": nose[1] + p.contact_nose_radius * reference.ey,
                }
            for name, value in expected.items():
                assert found[name] == pytest.approx(value, rel=TOLERANCE, abs=TOLERANCE), (
                    name,
                    random_cases.description(reference, modes),
                )


def test_a_jump_of_the_motor_torque_breaks_stuck_gears_away(library):
    seen: Counter[bool] = Counter()
    for reference, states in itertools.islice(cases(5), 0, None, 3):
        plant = Plant(library, reference.p)
        for x, u, modes in states:
            expected = reference.settle(0.0, x, u, modes)
            assert plant.accept_inputs(x, u, modes) == expected
            seen[expected != modes] += 1
    assert len(seen) == 2
    assert min(seen.values()) > 100, seen


def test_initial_state_is_steady(library):
    """The reference finds the start in equilibrium: no net force on anything, bristles settled.

    For a base that turns while it moves c(nu) remains, for one that turns a plate the centrifugal force: neither has to
    be in equilibrium. A plate on a base that leans starts where it rests on the level.
    """
    rng = np.random.default_rng(6)
    for combination in itertools.product(COMBINATIONS, ("rest", "moving", "turning")):
        p = random_cases.parameters(rng, *combination[0])
        p.wheel_traction, p.slider_present = [1.0, 1.0, 1.0], 1
        if p.bumper_mount == MOUNT_ROBOT:
            p.floor_slope = 0.0
        reference, plant = Reference(p), Plant(library, p)
        if combination[1] == "turning" and reference.on_robot:
            continue
        motion = rng.uniform(-1.0, 1.0, 7)
        motion[6] = 0.0
        # At rest stuck rollers may be loaded, up to half of their limit.
        bear = p.roller_coulomb_torque / p.roller_radius / np.array(p.roller_presliding_stiffness)
        offset = rng.uniform(-0.5, 0.5, 3) * bear if combination[1] == "rest" else np.zeros(3)
        motion[3:6] *= {"rest": 0.0, "moving": (1.0, 1.0, 0.0), "turning": (0.0, 0.0, 1.0)}[combination[1]]
        x, modes = plant.initial_state([*motion.tolist(), *offset.tolist()], Inputs())
        assert x[0:6] == pytest.approx(motion[0:6], abs=0.0)
        if combination[1] == "rest":
            assert x[15:18] == pytest.approx(offset, abs=0.0)
        assert modes.contact == (reference.touching(x)[0][0] > 0.0)
        modes.contact = 0  # the random nose may start anywhere
        e = reference.evaluate(0.0, x, Inputs(), modes)
        rate = np.array(e["rate"])
        # Forces of 10 N on kilograms, up to 100 N on the plate's half: rounding, times 1/r_r.
        assert np.abs(rate[3:6]).max() < 1e-10
        assert np.abs(rate[15:18]).max() < 1e-10
        if p.rope_attached:  # the slider is let go; the weight hangs still on the pretensioned rope
            assert e["tension"] == pytest.approx(p.rope_hanging_mass * GRAVITY, rel=1e-12)
            assert np.abs(rate[20:22]).max() < 1e-10
        else:
            assert np.abs(rate[18:24]).max() < 1e-10
        assert rate[12:15] == pytest.approx(x[9:12], abs=1e-12)
        assert (modes.rope_taut, modes.landed, modes.bottom_stop) == (p.rope_attached, 0, 0)
        assert modes.latched == int(reference.ideal)
        for i in range(INDICATORS):  # no mode is already past its event
            sign = reference.event_direction(i, modes)
            if sign and i > CONTACT:
                assert sign * reference.indicators(0.0, x, Inputs(), modes)[i] < 1e-12, i
