"""Variables: a get returns exactly the value that was set, and a forbidden value is refused by name, value and
range."""

import ctypes
import math
from pathlib import Path

import pytest
from fmu_driver import ERROR, MODELS, OK, Fmu, fmu_path


@pytest.mark.parametrize("value", [0.1, -0.0, 5.0, -5.0, 5e-324, 1 / 3, math.nextafter(5.0, 0.0)])
def test_a_real_comes_back_bit_for_bit(lag: Fmu, value: float) -> None:
    lag.start()
    assert lag.set("input.u", value) == OK
    assert lag.get("input.u").hex() == value.hex()


def test_integers_use_their_whole_range(lag: Fmu) -> None:
    lag.start()
    assert lag.get("input.number") == -(2**31)
    for value in (2**31 - 1, 0, -1):
        assert lag.set("input.number", value) == OK
        assert lag.get("input.number") == value


def test_booleans(lag: Fmu) -> None:
    lag.start()
    assert not lag.get("input.hold")
    assert lag.set("input.hold", 1) == OK
    assert lag.get("input.hold") == 1


def test_start_values_come_from_table_and_robot_file(lag: Fmu) -> None:
    lag.start()
    assert lag.get("lag.time_constant") == 0.25
    # The robot file has two of the three weights; the third is unused.
    assert [lag.get(f"lag.weights[{i}]") for i in range(3)] == [1.0, -2.5, 0.0]
    assert [lag.get(f"input.raw[{i}]") for i in range(2)] == [0.5, -0.5]
    assert lag.get("lag.repetitions") == 1


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("input.u", 5.5, "variable input.u is 5.5, but must be finite and in [-5, 5]"),
        ("input.u", math.nextafter(5.0, 6.0), "variable input.u is 5.0000000000000009, but"),
        ("input.u", math.nan, "variable input.u is nan, but must be finite and in [-5, 5]"),
        ("input.u", -math.inf, "variable input.u is -inf, but"),
        ("input.raw[1]", 5.5, "variable input.raw[1] is 5.5, but"),
        ("lag.time_constant", 0.0, "variable lag.time_constant is 0, but must be finite and in [0.001"),
        ("lag.repetitions", 5, "variable lag.repetitions is 5, but must be finite and in [1, 4]"),
        ("lag.repetitions", 0, "variable lag.repetitions is 0, but must be finite and in [1, 4]"),
    ],
)
def test_a_bad_value_is_refused_by_name_value_and_range(lag: Fmu, name: str, value: float, text: str) -> None:
    assert lag.instantiate()
    assert lag.set(name, value) == ERROR
    assert text in lag.last_message
    assert lag.setup() == OK
    assert lag.get(name) not in (value, math.nan)


def test_non_finite_values_pass_where_the_table_says_so(lag: Fmu) -> None:
    lag.start()
    for value in (math.nan, math.inf):
        assert lag.set("input.raw[0]", value) == OK
        assert lag.step(0.0 if math.isnan(value) else 0.01, 0.01) == OK
        assert str(lag.get("output.raw[0]")) == str(value)


def test_one_refused_value_leaves_all_as_they_were(lag: Fmu) -> None:
    lag.start()
    references = [lag.reference("input.u"), lag.reference("input.raw[0]"), lag.reference("input.raw[1]")]
    assert lag.set_references("real", references, [2.0, 3.0, 99.0]) == ERROR
    assert lag.get_references("real", references) == (OK, [1.0, 0.5, -0.5])


def test_outputs_cannot_be_set(lag: Fmu) -> None:
    lag.start()
    assert lag.set("output.y", 1.0) == ERROR
    assert "variable output.y is an output and cannot be set" in lag.last_message


def test_parameters_are_fixed_after_initialisation(lag: Fmu) -> None:
    assert lag.instantiate()
    assert lag.set("lag.limit", 4.0) == OK
    assert lag.setup() == OK
    assert lag.set("lag.limit", 5.0) == OK
    assert lag.exit_initialisation() == OK
    assert lag.set("lag.limit", 6.0) == ERROR
    assert "variable lag.limit is a fixed parameter and cannot be set in state 'step mode'" in lag.last_message
    assert lag.get("lag.limit") == 5.0


def test_outputs_in_the_initialisation_mode_follow_the_parameters(lag: Fmu) -> None:
    assert lag.instantiate()
    assert lag.setup() == OK
    assert lag.get("output.y") == 0.25
    assert lag.set("lag.time_constant", 0.5) == OK
    assert lag.get("output.y") == 0.5


def test_unknown_references_and_wrong_types(lag: Fmu) -> None:
    lag.start()
    status, _ = lag.get_references("real", [9999])
    assert status == ERROR
    assert "there is no variable with value reference 9999" in lag.last_message
    for reference in (9, 46):  # just outside both ends of the table
        assert lag.get_references("real", [reference])[0] == ERROR
    assert lag.get_references("integer", [lag.reference("input.u")])[0] == ERROR
    assert "variable input.u is real, not integer" in lag.last_message
    assert lag.set_references("real", [lag.reference("input.hold")], [1.0]) == ERROR
    assert "variable input.hold is boolean, not real" in lag.last_message


def test_time_is_a_variable_in_fmi3_only(lag: Fmu) -> None:
    lag.start()
    assert lag.step(0.0, 0.5) == OK
    status, values = lag.get_references("real", [0])
    assert (status, values) == ((OK, [0.5]) if lag.version == 3 else (ERROR, [0.0]))
    assert lag.set_references("real", [0], [1.0]) == ERROR


def test_null_pointers_are_refused(lag: Fmu) -> None:
    lag.start()
    suffix = "Float64" if lag.version == 3 else "Real"
    sizes = (ctypes.c_size_t(1),) if lag.version == 3 else ()
    for verb in ("Get", "Set"):
        assert lag.call(f"{verb}{suffix}", None, ctypes.c_size_t(1), None, *sizes) == ERROR
        assert "null pointer" in lag.last_message
        assert lag.call(f"{verb}Boolean", None, ctypes.c_size_t(1), None, *sizes) == ERROR
        assert "null pointer" in lag.last_message


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("model", MODELS)
def test_reset_gives_every_variable_its_start_value_back(model: str, version: int, tmp_path: Path) -> None:
    fmu = Fmu(fmu_path(model, version), version, tmp_path / "fmu")
    assert fmu.instantiate()
    assert fmu.setup() == OK, fmu.last_message
    fresh = fmu.snapshot()
    assert fmu.call("Reset") == OK
    given = [v.name for v in fmu.variables.values() if v.causality in ("parameter", "input")]
    settable = [name for name in given if fmu.kind(name) == "real"]
    changed = [name for name in settable if fmu.set(name, 0.99 * fresh[name] + 1e-3) == OK]
    assert len(changed) > len(settable) / 3
    assert fmu.call("Reset") == OK
    # A run leaves outputs of its own.
    assert fmu.setup(start=1.0) == OK, fmu.last_message
    assert fmu.exit_initialisation() == OK, fmu.last_message
    for k in range(20):
        assert fmu.step(1.0 + k * 1e-3, 1e-3) == OK, fmu.last_message
    assert fmu.call("Reset") == OK
    assert fmu.setup() == OK, fmu.last_message
    assert fmu.snapshot() == fresh
    fmu.free()


# So that the servos have something to do from their first tick on.
MOVED = {"drivetrain": {"servo.enabled": 1, "start.motor_angle": 0.05}, "testbed": {"command.wheel_speed[0]": 1.0}}


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("model", MODELS)
def test_a_run_after_a_reset_is_the_first_once_more(model: str, version: int, tmp_path: Path) -> None:
    """Also where the run before ended between two ticks."""
    step_s = 1e-3 if model == "controller" else 7e-4
    fmu = Fmu(fmu_path(model, version), version, tmp_path / "fmu")
    assert fmu.instantiate()
    ends = []
    for _ in range(2):
        for name, value in MOVED.get(model, {}).items():
            assert fmu.set(name, value) == OK, fmu.last_message
        assert fmu.setup() == OK, fmu.last_message
        assert fmu.exit_initialisation() == OK, fmu.last_message
        for k in range(24):
            assert fmu.step(k * step_s, step_s) == OK, fmu.last_message
        ends.append(fmu.snapshot())
        assert fmu.call("Reset") == OK
    assert ends[0] == ends[1]
    fmu.free()
