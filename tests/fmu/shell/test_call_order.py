"""The state machine in use: wrong times, a failing model, reset. Every call in every state: test_every_call.py."""

import math
import re

import pytest
from fmu_driver import ERROR, OK, Fmu

CALLS = {
    "EnterInitializationMode": lambda fmu: fmu.setup(),
    "ExitInitializationMode": lambda fmu: fmu.exit_initialisation(),
    "DoStep": lambda fmu: fmu.step(0.0, 0.1),
    "Terminate": lambda fmu: fmu.call("Terminate"),
    "Reset": lambda fmu: fmu.call("Reset"),
    "Get": lambda fmu: fmu.get_references("real", [10])[0],
    "Set": lambda fmu: fmu.set_references("real", [10], [1.0]),
}


def test_a_refused_call_changes_nothing(lag: Fmu) -> None:
    lag.start()
    before = lag.snapshot()
    assert lag.exit_initialisation() == ERROR
    assert lag.step(0.5, 0.1) == ERROR
    assert lag.snapshot() == before
    assert lag.step(0.0, 0.1) == OK


def test_without_an_instance_nothing_crashes(lag: Fmu) -> None:
    for call in CALLS.values():
        assert call(lag) == ERROR
    lag.free()


@pytest.mark.parametrize("lag", [2], indirect=True)
def test_fmi2_needs_an_experiment(lag: Fmu) -> None:
    assert lag.instantiate()
    assert lag.call("EnterInitializationMode") == ERROR
    assert "not allowed before fmi2SetupExperiment" in lag.last_message


@pytest.mark.parametrize(
    ("time", "size", "text"),
    [
        (0.2, 0.1, "communication point is 0.2 s, but the last step ended at 0.1 s"),
        (0.0, 0.1, "communication point is 0 s, but the last step ended at 0.1 s"),
        (math.nan, 0.1, "communication point is nan s"),
        (0.1, 0.0, "communication step size is 0 s, but must be positive"),
        (0.1, -0.1, "communication step size is -0.1 s, but must be positive"),
        (0.1, math.inf, "communication step size is inf s, but must be positive"),
        (0.1, 1.0, "the step would end at 1.1 s, after the stop time, 1 s"),
    ],
)
def test_a_wrong_step_is_refused(lag: Fmu, time: float, size: float, text: str) -> None:
    assert lag.instantiate()
    assert lag.setup(stop=1.0) == OK
    assert lag.exit_initialisation() == OK
    assert lag.step(0.0, 0.1) == OK
    assert lag.step(time, size) == ERROR
    assert text in lag.last_message
    assert lag.step(0.1, 0.9) == OK


def test_summed_up_times_are_accepted(lag: Fmu) -> None:
    """An importer that sums up 0.001 deviates by rounding after a while, also from the stop time."""
    assert lag.instantiate()
    assert lag.setup(stop=1.0) == OK
    assert lag.exit_initialisation() == OK
    time = 0.0
    for k in range(1000):
        assert lag.step(time if k % 2 else k * 0.001, 0.001) == OK, lag.last_message
        time += 0.001


@pytest.mark.parametrize("added_up", [True, False])
@pytest.mark.parametrize("start", [1e7, 1e9, -1e9])
def test_times_of_any_size_are_accepted(lag: Fmu, start: float, added_up: bool) -> None:
    """A difference beyond rounding is refused, with enough digits in the message to see it."""
    assert lag.instantiate()
    assert lag.setup(start, start + 1.001) == OK
    assert lag.exit_initialisation() == OK
    time = start
    for k in range(1000):
        assert lag.step(time if added_up else start + k * 0.001, 0.001) == OK, lag.last_message
        time += 0.001
    assert lag.step(start + 0.9, 0.001) == ERROR
    assert len(set(re.findall(r"(-?[\d.e+]+) s\b", lag.last_message))) == 2, lag.last_message


@pytest.mark.parametrize(("share", "status"), [(0.9e-6, OK), (-0.9e-6, OK), (1.1e-6, ERROR), (-1.1e-6, ERROR)])
def test_a_communication_point_may_be_off_by_a_millionth_of_the_step(lag: Fmu, share: float, status: int) -> None:
    lag.start()
    assert lag.step(0.0, 1e-3) == OK
    assert lag.step(1e-3 + share * 1e-3, 1e-3) == status


def test_times_that_differ_in_the_last_bit_are_told_apart(lag: Fmu) -> None:
    assert lag.instantiate()
    assert lag.setup(math.nextafter(1.0, 2.0), 1.0) == ERROR
    assert "stop time is 1 s, but must not be before the start time, 1.0000000000000002 s" in lag.last_message


def test_steps_that_get_lost_in_rounding_are_refused(lag: Fmu) -> None:
    assert lag.instantiate()
    assert lag.setup(1e9) == OK
    assert lag.exit_initialisation() == OK
    assert lag.step(1e9, 1e-8) == ERROR
    assert "too small to be added to 1e+09 s" in lag.last_message
    assert lag.step(1e9, 1e-3) == OK


def test_a_start_time_that_is_too_coarse_is_refused(lag: Fmu) -> None:
    assert lag.instantiate()
    assert lag.setup(1.1e10) == ERROR
    assert "start time is 1.1e+10 s, but must be in [-1e+10, 1e+10]" in lag.last_message


@pytest.mark.parametrize(("start", "stop"), [(math.nan, None), (math.inf, None), (1.0, 0.5), (0.0, math.nan)])
def test_wrong_experiment_times_are_refused(lag: Fmu, start: float, stop: float | None) -> None:
    assert lag.instantiate()
    assert lag.setup(start, stop) == ERROR
    assert "time is" in lag.last_message


def test_a_model_that_cannot_start_says_why(lag: Fmu) -> None:
    assert lag.instantiate()
    assert lag.set("lag.limit", 0.0) == OK
    assert lag.setup() == OK
    assert lag.exit_initialisation() == ERROR
    assert lag.last_message == f"fmi{lag.version}ExitInitializationMode: lag.limit is 0 N.m, nothing can hold that"


def test_a_model_that_fails_says_why_and_steps_no_further_until_reset(lag: Fmu) -> None:
    assert lag.instantiate()
    assert lag.set("lag.limit", 0.5) == OK
    assert lag.setup() == OK
    assert lag.exit_initialisation() == OK
    time = 0.0
    while lag.step(time, 0.1) == OK:
        time += 0.1
        assert time < 2.0
    assert lag.last_message == f"fmi{lag.version}DoStep: the lag broke at {time:g} s: 100% over"
    assert lag.get("output.y") <= 0.5
    assert lag.step(time, 0.1) == ERROR
    assert "not allowed in state 'failed'" in lag.last_message
    assert lag.call("Reset") == OK
    assert lag.setup() == OK
    assert lag.exit_initialisation() == OK
    assert lag.get("lag.limit") == 10.0
    assert lag.step(0.0, 0.1) == OK


def test_reset_is_a_new_beginning(lag: Fmu) -> None:
    lag.start()
    fresh = lag.snapshot()
    lag.set("input.u", 3.0)
    lag.set("input.raw[0]", math.nan)
    assert lag.step(0.0, 0.1) == OK
    assert lag.snapshot() != fresh
    assert lag.call("Reset") == OK
    assert lag.setup() == OK
    assert lag.exit_initialisation() == OK
    assert lag.snapshot() == fresh


def test_two_instances_do_not_know_each_other(lag: Fmu) -> None:
    lag.start()
    first = lag.instance
    lag.start()
    second, lag.instance = lag.instance, first
    assert lag.set("input.u", -4.0) == OK
    assert lag.step(0.0, 0.1) == OK
    lag.instance, first = second, lag.instance
    assert lag.get("input.u") == 1.0
    assert lag.get("output.y") == 0.25
    lag.call("FreeInstance")
    lag.instance = first


def test_what_is_not_of_this_build_is_refused(lag: Fmu) -> None:
    for token in ("", "{00000000-0000-0000-0000-000000000000}", lag.token[:-1]):
        assert not lag.instantiate(token=token)
        assert "does not match" in lag.last_message


def test_instances_that_cannot_be(lag: Fmu) -> None:
    assert not lag.instantiate(name="")
    assert "the instance name is missing" in lag.last_message
    changes = [{"type": 0}] if lag.version == 2 else [{"event_mode": True}, {"intermediate": 1}]
    for change in changes:
        lag.messages.clear()
        assert not lag.instantiate(**change)
        assert "this FMU" in lag.last_message
