"""The state of every FMU: saved, restored, moved to another process; refused when incomplete or of another FMU."""

from __future__ import annotations

import ctypes
import subprocess
import sys
from pathlib import Path

import pytest
from fmu_driver import ERROR, OK
from state_runner import AMPLITUDES, STEP_S, StatefulFmu

MODELS = tuple(AMPLITUDES)
HEADER_BYTES = 40
# The testbed's slider is in contact from step 153 on; the controller has taken its tare by 100.
SAVED, LAST = 165, 230
START = 3000  # steps of a clock that does not start at zero

pytestmark = pytest.mark.parametrize("version", [2, 3])


@pytest.fixture
def make(tmp_path: Path, version: int):
    made: list[StatefulFmu] = []

    def make_one(model: str) -> StatefulFmu:
        # States pass between instances of one binary: a second instance is not a second copy of the library.
        first = next((fmu for fmu in made if fmu.model == model), None)
        fmu = StatefulFmu(model, version, tmp_path / model) if first is None else first.twin()
        made.append(fmu)
        return fmu

    yield make_one
    for fmu in made:
        if fmu.instance is not None:
            fmu.free()


@pytest.mark.parametrize("model", MODELS)
def test_another_process_goes_on_bit_for_bit(model: str, version: int, make, tmp_path: Path) -> None:
    fmu = make(model)
    fmu.start()
    before = fmu.run(0, SAVED)
    state = fmu.get_state()
    (tmp_path / "state").write_bytes(fmu.serialise(state))
    fmu.free_state(state)
    after = fmu.run(SAVED, LAST)
    assert len(set(before + after)) > 10, "nothing happens, so this test could not fail"
    command = [sys.executable, str(Path(__file__).parent / "state_runner.py"), model, str(version)]
    command += [str(tmp_path / "state"), str(SAVED), str(LAST), str(tmp_path / "other")]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    assert [bytes.fromhex(line) for line in done.stdout.split()] == after


@pytest.mark.parametrize("model", MODELS)
def test_a_state_put_back_repeats_the_run(model: str, version: int, make) -> None:
    fmu = make(model)
    fmu.start()
    fmu.run(0, SAVED)
    state = fmu.get_state()
    once = fmu.run(SAVED, LAST)
    assert fmu.set_state(state) == OK, fmu.last_message
    assert fmu.run(SAVED, LAST) == once
    # An instance that was never started accepts it too, and the handle can be filled again.
    other = make(model)
    assert other.instantiate()
    assert other.set_state(state) == OK, other.last_message
    assert other.run(SAVED, LAST) == once
    fmu.free_state(state)


@pytest.mark.parametrize("model", MODELS)
def test_a_state_knows_when_its_run_started(model: str, version: int, make) -> None:
    fmu = make(model)
    assert fmu.instantiate()
    assert fmu.setup(start=START * STEP_S) == OK, fmu.last_message
    assert fmu.exit_initialisation() == OK, fmu.last_message
    fmu.run(START, START + SAVED)
    state = fmu.get_state()
    once = fmu.run(START + SAVED, START + LAST)
    other = make(model)
    assert other.instantiate()
    assert other.set_state(state) == OK, other.last_message
    assert other.run(START + SAVED, START + LAST) == once
    fmu.free_state(state)


@pytest.mark.parametrize("model", MODELS)
def test_states_before_the_run_are_states(model: str, version: int, make) -> None:
    fmu = make(model)
    assert fmu.instantiate()
    state = fmu.get_state()
    fmu.setup()
    fmu.exit_initialisation()
    first = fmu.run(0, 20)
    assert fmu.set_state(state) == OK, fmu.last_message
    assert fmu.step(0.0, 1e-3) == ERROR, "it is not initialised again"
    assert fmu.set_state(state) == OK, fmu.last_message
    fmu.setup()
    fmu.exit_initialisation()
    assert fmu.run(0, 20) == first
    fmu.free_state(state)


@pytest.mark.parametrize("model", MODELS)
def test_what_is_not_whole_or_not_its_own_is_refused(model: str, version: int, make) -> None:
    fmu = make(model)
    fmu.start()
    fmu.run(0, 5)
    state = fmu.get_state()
    data = fmu.serialise(state)
    foreign = make("lag" if model != "lag" else "bumper")
    foreign.start()
    foreign_state = foreign.get_state()
    flipped = bytearray(data)
    flipped[HEADER_BYTES + 7] ^= 1
    newer = bytearray(data)
    newer[8] += 1
    for wrong, reason in (
        (b"", "shorter than its header"),
        (data[: HEADER_BYTES - 1], "shorter than its header"),
        (data[:-1], "truncated"),
        (data + b"x", "truncated, or something was added"),
        (bytes(flipped), "altered"),
        (bytes(newer), "another version"),
        (b"PK" + data[2:], "not a saved state of giveway"),
        (foreign.serialise(foreign_state), "another FMU"),
    ):
        status, handle = fmu.deserialise(wrong)
        assert status == ERROR
        assert not handle
        assert reason in fmu.last_message
    foreign.free_state(foreign_state)
    # None of it has touched the instance.
    expected = fmu.run(5, 10)
    assert fmu.set_state(state) == OK
    assert fmu.run(5, 10) == expected
    fmu.free_state(state)


def test_too_little_room_is_refused(version: int, make) -> None:
    fmu = make("lag")
    fmu.start()
    state = fmu.get_state()
    room = (ctypes.c_ubyte * 10)()
    assert fmu.call(f"Serialize{fmu._noun}", state, room, ctypes.c_size_t(10)) == ERROR
    assert "room for 10 bytes" in fmu.last_message
    assert bytes(room) == bytes(10)
    fmu.free_state(state)


def test_null_pointers_are_refused(version: int, make) -> None:
    fmu = make("lag")
    fmu.start()
    assert fmu.call(f"Get{fmu._noun}", None) == ERROR
    assert fmu.call(f"Set{fmu._noun}", None) == ERROR
    assert "null pointer" in fmu.last_message


STATE_COUNTS = {"testbed": 41, "drivetrain": 7, "bumper": 3}
EULER_S = 1e-4


def integrate(fmu: StatefulFmu, first: int, last: int) -> list[tuple[float, ...]]:
    """Model Exchange by explicit Euler steps of 0.1 ms, an event update at each 0.5 ms; the states after each."""
    count = STATE_COUNTS[fmu.model]
    rows = []
    for k in range(first, last):
        states = fmu.array("GetContinuousStates", count)
        rates = fmu.array(fmu.derivatives_function, count)
        assert fmu.call("SetTime", ctypes.c_double((k + 1) * EULER_S)) == OK, fmu.last_message
        stepped = [x + EULER_S * rate for x, rate in zip(states, rates, strict=True)]
        assert fmu.set_states(stepped) == OK, fmu.last_message
        if (k + 1) % 5 == 0:
            assert fmu.call("EnterEventMode") == OK, fmu.last_message
            fmu.settle()
            assert fmu.call("EnterContinuousTimeMode") == OK, fmu.last_message
        rows.append(tuple(fmu.array("GetContinuousStates", count)))
    return rows


@pytest.mark.parametrize("model", STATE_COUNTS)
def test_model_exchange_goes_on_bit_for_bit(model: str, version: int, make) -> None:
    fmu = make(model)
    assert fmu.instantiate_exchange()
    for name, value in {"testbed": {"start.vx": 0.1}, "drivetrain": {"motor.torque": 6.0}}.get(model, {}).items():
        assert fmu.set(name, value) == OK, fmu.last_message
    if model == "bumper":
        assert fmu.set("carrier.velocity", 0.1) == OK
    assert fmu.setup() == OK, fmu.last_message
    assert fmu.exit_initialisation() == OK, fmu.last_message
    fmu.settle()
    assert fmu.call("EnterContinuousTimeMode") == OK
    integrate(fmu, 0, 52)  # in the middle between two ticks
    state = fmu.get_state()
    after = integrate(fmu, 52, 120)
    assert len(set(after)) > 10
    other = make(model)
    assert other.instantiate_exchange()
    status, carried = other.deserialise(fmu.serialise(state))
    assert status == OK, other.last_message
    assert other.set_state(carried) == OK, other.last_message
    assert integrate(other, 52, 120) == after
    # A state of the other interface does not fit.
    stepping = make(model)
    assert stepping.instantiate()
    assert stepping.set_state(carried) == ERROR
    assert "other interface" in stepping.last_message
    other.free_state(carried)
    fmu.free_state(state)
