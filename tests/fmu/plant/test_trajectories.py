"""Whole runs: the C++ plant in giveway's own solver against the reference in scipy's DOP853, both
restarted at every event.

Tolerances: the integrators run at relative 1e-10 (C++) and 1e-11. Over the some thousand steps and
ten to forty events of a run, each passing on its instant's error, they agree to 9e-8 of each
signal's peak; bound: 1e-6. An instant at which an indicator creeps through zero (a motor coming to
rest) is as good as the state over the indicator's slope: 4e-9 s seen; bound: 1e-7 s. Tightened
further, the two converge towards each other (3e-9 at 1e-12).
"""

import functools

import numpy as np
import pytest
from kkt_reference import BUMPER, CONTACT, KIND_NONE, STATES, WALL, Reference
from plant_probe import Plant
from plant_scenarios import COLLISIONS, all_runs, collision, pushed, spinning

SIGNAL_TOLERANCE = 1e-6
EVENT_TOLERANCE_S = 1e-7
TIMES = np.linspace(0.0, 0.6, 241)
RUNS = all_runs()


def simulated(run, reference: Reference | None = None):
    """The reference's run."""
    own, x, modes, inputs = run
    return (reference or own).simulate(x, modes, TIMES, inputs, rtol=1e-11, atol=1e-14)


@functools.cache
def expected_of(name: str):
    return simulated(RUNS[name])


def differences(library, run, expected):
    """Worst error of each state over its peak; both lists of events."""
    own, x, modes, inputs = run
    found = Plant(library, own.p).simulate(x, modes, TIMES, inputs, rtol=1e-10, atol=1e-14)
    peak = np.abs(expected.states).max(axis=0)
    error = np.abs(found.states - expected.states).max(axis=0) / np.where(peak > 0.0, peak, 1.0)
    return error, sorted(expected.events), sorted(found.events), found


@pytest.mark.parametrize("name", RUNS)
def test_run(library, name, record_property):
    expected = expected_of(name)
    error, expected_events, found_events, found = differences(library, RUNS[name], expected)
    assert [i for _, i in found_events] == [i for _, i in expected_events]
    apart = max(abs(a - b) for (a, _), (b, _) in zip(found_events, expected_events, strict=True))
    record_property("worst signal error", float(error.max()))
    record_property("worst event error, s", float(apart))
    assert apart < EVENT_TOLERANCE_S
    worst = int(error.argmax())
    # Each of some 50 hand-overs restarts a bristle at an instant that is known to the tolerance: 1.3e-6 seen.
    bound = 5.0 * SIGNAL_TOLERANCE if "one by one" in name else SIGNAL_TOLERANCE
    assert error[worst] < bound, f"state {worst} of {STATES}: {error[worst]}"
    assert found.modes[-1] == expected.modes[-1]


def test_the_collisions_are_collisions():
    """Each bumper is compressed, each latch releases, the light dummy's latch closes again: the runs above are
    meaningful."""
    for name in COLLISIONS:
        reference, *_ = RUNS[f"collision, {name}"]
        run = expected_of(f"collision, {name}")
        assert np.hypot(*run.states[-1, 26:28]) > 1.0, name  # N s
        if reference.p.bumper_kind != KIND_NONE and not reference.p.outline_wheels:
            assert run.states[:, 22].max() > 0.02, name
        if reference.ideal:
            assert [i for _, i in run.events].count(BUMPER) == 1 + ("closes again" in name), name
        if reference.p.wall_present:
            assert [i for _, i in run.events].count(WALL) > 3, name
        if reference.p.contact_nose_shape:  # both ends of a side came to press, each by itself
            touching = [
                sum(depth > 0.0 for depth, *_ in reference.touching(s))
                for s, m in zip(run.states, run.modes, strict=True)
                if m.contact
            ]
            assert min(touching) == 1 < max(touching), name
        assert CONTACT in [i for _, i in run.events], name


@pytest.mark.parametrize(
    ("run", "fault", "states"),
    [
        (collision(COLLISIONS["spring on slider"]), {"fault_contact_moment": -1.0}, [2, 5]),
        (
            collision(COLLISIONS["magnetic continuous on robot"]),
            {"fault_contact_moment": 0.0},
            [2, 5],
        ),
        (spinning(1), {"fault_velocity_term": -1.0}, [0, 1, 3, 4]),
        (pushed(), {"fault_external_sign": -1.0}, [0, 1, 3, 4]),
    ],
    ids=["moment on slider", "moment on robot", "velocity term", "external wrench"],
)
def test_a_planted_fault_turns_the_comparison_red(library, run, fault, states):
    reference = Reference(type(run[0].p)(**{**vars(run[0].p), **fault}))
    error, *_ = differences(library, run, simulated(run, reference))
    assert error[states].min() > 1000.0 * SIGNAL_TOLERANCE
