"""Every function in every state, of all FMUs and interfaces: allowed, or refused with a message and no effect."""

from __future__ import annotations

import ctypes
import math
import re
from pathlib import Path

import fmpy
import pytest
from call_table import CALLS, INSTANTIATED, STATES, Call, Room, enter, legal_states, saved_state, serialised
from fmu_driver import ERROR, INTEGRATED, MODELS, OK, Fmu, fmu_path

DISCARD = 2
KINDS = [(m, v, i) for m in (*MODELS, "lag") for v in (2, 3) for i in ("CS", "ME") if i == "CS" or m in INTEGRATED]
every_kind = pytest.mark.parametrize(("model", "version", "interface"), KINDS)


@pytest.fixture
def fmu(request: pytest.FixtureRequest, tmp_path: Path) -> Fmu:
    """Unpacked, not yet instantiated."""
    parameters = request.node.callspec.params
    model, version = parameters["model"], parameters["version"]
    return Fmu(fmu_path(model, version), version, tmp_path)


def plain(arguments: list[object], null: Room | None = None) -> list[object]:
    """The arguments as they are passed on, one of them perhaps as a null pointer."""
    return [None if a is null else a.value if isinstance(a, Room) else a for a in arguments]


def prepare(fmu: Fmu, call: Call) -> None:
    if call.prepare == "setup":
        fmu.call("SetupExperiment", 0, ctypes.c_double(), ctypes.c_double(), 0, ctypes.c_double())
    if call.prepare == "update":
        fmu.settle()


def expected_status(call: Call, interface: str, state: str, model: str) -> int:
    if state in legal_states(call, interface, model in INTEGRATED):
        return OK
    return DISCARD if call.interface == interface and state in call.discarded else ERROR


def faults(fmu: Fmu, call: Call, model: str, interface: str, state: str) -> list[str]:
    """What is wrong with one function in one state."""
    enter(fmu, interface, state)
    expected = expected_status(call, interface, state, model)
    if expected == OK:
        prepare(fmu, call)
    arguments = plain(call.arguments(fmu))
    before = serialised(fmu)
    fmu.messages.clear()
    status = fmu.call(call.name, *arguments)
    where, found = f"{call.name} in {state}", []
    if status != expected:
        found.append(f"{where}: status {status}, not {expected}; {fmu.last_message}")
    if expected == OK:
        found += [f"{where}: unasked for: {text}" for text in fmu.messages]
    else:
        if len(fmu.messages) != 1 or not re.match(rf"fmi{fmu.version}{call.name}: .*'{state}'", fmu.last_message):
            found.append(f"{where}: does not name call and state: {fmu.messages}")
        if serialised(fmu) != before:
            found.append(f"{where}: was refused, but has changed something")
    fmu.free()
    return found


@every_kind
def test_every_call_in_every_state_of_every_kind(fmu: Fmu, model: str, version: int, interface: str) -> None:
    found = [f for s in STATES[interface] for c in CALLS[version] for f in faults(fmu, c, model, interface, s)]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("version", [2, 3])
def test_the_table_has_every_function(version: int) -> None:
    header = Path(fmpy.__file__).parent / "c-code" / f"fmi{version}Functions.h"
    names = set(re.findall(rf"FMI{version}_Export\s+fmi{version}\w+TYPE\s+fmi{version}(\w+);", header.read_text()))
    apart = {name for name in names if name.startswith("Instantiate")} | {
        "FreeInstance",
        "GetVersion",
        "GetTypesPlatform",
    }
    assert {call.name for call in CALLS[version]} == names - apart


@pytest.mark.parametrize("wrong", ["allowed", "refused"])
def test_a_wrong_table_would_be_noticed(tmp_path: Path, wrong: str) -> None:
    """The planted fault: a state too many, or too few, in the table of one function."""
    fmu = Fmu(fmu_path("lag", 3), 3, tmp_path)
    call = next(call for call in CALLS[3] if call.name == "Terminate")
    state = INSTANTIATED if wrong == "allowed" else "step mode"
    changed = Call(call.name, call.arguments, call.allowed ^ {state})
    assert faults(fmu, changed, "lag", "CS", state)


def states_where_legal(call: Call, model: str, interface: str) -> list[str]:
    legal = legal_states(call, interface, model in INTEGRATED)
    return [state for state in STATES[interface] if state in legal][:1]


@every_kind
def test_null_pointers_are_refused(fmu: Fmu, model: str, version: int, interface: str) -> None:
    found, tried = [], 0
    for call in CALLS[version]:
        for state in states_where_legal(call, model, interface):
            enter(fmu, interface, state)
            prepare(fmu, call)
            for index, room in enumerate(call.arguments(fmu)):
                if not isinstance(room, Room):
                    continue
                arguments = call.arguments(fmu)
                fmu.messages.clear()
                status = fmu.call(call.name, *plain(arguments, arguments[index]))
                tried += 1
                if room.required and (status != ERROR or not fmu.last_message.startswith(f"fmi{version}{call.name}: ")):
                    found.append(f"{call.name}, argument {index}: status {status}, {fmu.messages}")
            fmu.free()
    assert not found, "\n".join(found)
    assert tried > 20


@every_kind
def test_wrong_counts_and_references_are_refused(fmu: Fmu, model: str, version: int, interface: str) -> None:
    enter(fmu, interface, "initialisation mode")
    many = (ctypes.c_uint32 * 1)(1)
    room = (ctypes.c_double * 1)()
    kinds = ("Real", "Integer", "Boolean") if version == 2 else ("Float64", "Int32", "Boolean")
    for count in (2**64 - 1, 2**32, len(fmu.variables) + 1):
        size = ctypes.c_size_t(count)
        for verb in ("Get", "Set"):
            for kind in kinds:
                assert fmu.call(f"{verb}{kind}", many, size, room, *([size] * (version == 3))) == ERROR
                assert re.search(rf"{verb}{kind}: {count} value references, but this FMU has \d+", fmu.last_message)
    used = {v.valueReference for v in fmu.variables.values()} | {0}
    for reference in {1, 999, 5000, 2**31, 2**32 - 1, max(used) + 1} - used:
        for kind in ("real", "integer", "boolean"):
            assert fmu.get_references(kind, [reference])[0] == ERROR
            assert f"value reference {reference}" in fmu.last_message
            assert fmu.set_references(kind, [reference], [0]) == ERROR
            assert f"value reference {reference}" in fmu.last_message
    if version == 3:
        size, other = ctypes.c_size_t(1), ctypes.c_size_t(2)
        assert fmu.call("GetFloat64", many, size, room, other) == ERROR
        assert "1 value references but 2 values" in fmu.last_message
    if interface == "ME":
        for name in ("GetContinuousStates", "GetEventIndicators", "GetNominalsOfContinuousStates"):
            for count in (0, 1000, 2**64 - 1):
                assert fmu.call(name, room, ctypes.c_size_t(count)) == ERROR
                assert f"{name}: {count} values, but this FMU has" in fmu.last_message
    fmu.free()


@every_kind
def test_an_instance_that_was_freed_is_gone(fmu: Fmu, model: str, version: int, interface: str) -> None:
    """A state freed twice, used afterwards, or never made: an error, not a crash; other states are unaffected."""
    enter(fmu, interface, "initialisation mode")
    living = fmu.twin()
    enter(living, interface, "initialisation mode")
    handle = fmu.instance
    fmu.free()
    for wrong in (handle, None, 1, 2**63 + 5):
        fmu.instance = wrong
        for call in CALLS[version]:
            assert fmu.call(call.name, *[ctypes.c_size_t(0)] * 9) == ERROR, call.name
        fmu.call("FreeInstance")
    newcomer = fmu.twin()
    enter(newcomer, interface, "initialisation mode")
    assert newcomer.instance not in (handle, living.instance)
    fmu.instance = handle
    fmu.call("FreeInstance")
    for instance in (living, newcomer):
        assert instance.exit_initialisation() == OK, instance.last_message
        instance.free()


@every_kind
def test_a_saved_state_that_was_freed_is_gone(fmu: Fmu, model: str, version: int, interface: str) -> None:
    enter(fmu, interface, "initialisation mode")
    noun = "FMUstate" if version == 2 else "FMUState"
    state = saved_state(fmu)
    copy = ctypes.c_void_p(state.value)
    assert fmu.call(f"Free{noun}", ctypes.byref(state)) == OK
    for wrong in (copy, *map(ctypes.c_void_p, NEVER_A_STATE)):
        before = wrong.value
        for name in (f"Free{noun}", *([f"Get{noun}"] if wrong is copy else [])):
            assert fmu.call(name, ctypes.byref(wrong)) == ERROR
            assert "no such saved state" in fmu.last_message
            assert wrong.value == before
        assert fmu.call(f"Set{noun}", wrong) == ERROR
        assert "no such saved state" in fmu.last_message
    assert fmu.exit_initialisation() == OK
    fmu.free()


# Possible values of an uninitialised pointer: addresses of code, heap and stack, small and negative numbers.
NEVER_A_STATE = (7, 0x401136, 0x55D1_2345_6789, 0x7FFD_1234_5671, 2**64 - 1)


@every_kind
def test_a_state_is_taken_into_an_uninitialised_pointer(fmu: Fmu, model: str, version: int, interface: str) -> None:
    enter(fmu, interface, "initialisation mode")
    noun = "FMUstate" if version == 2 else "FMUState"
    for garbage in NEVER_A_STATE:
        state = ctypes.c_void_p(garbage)
        assert fmu.call(f"Get{noun}", ctypes.byref(state)) == OK, fmu.last_message
        assert state.value != garbage
        assert fmu.call(f"Set{noun}", state) == OK
        assert fmu.call(f"Free{noun}", ctypes.byref(state)) == OK
    fmu.free()


@every_kind
def test_a_state_given_instead_of_its_address_is_not_followed(
    fmu: Fmu, model: str, version: int, interface: str
) -> None:
    enter(fmu, interface, "initialisation mode")
    noun = "FMUstate" if version == 2 else "FMUState"
    state = saved_state(fmu)
    copy = ctypes.c_void_p(state.value)
    assert fmu.call(f"Free{noun}", copy) == ERROR
    assert "must be the address" in fmu.last_message
    assert fmu.call(f"Set{noun}", state) == OK  # it is still there
    assert fmu.call(f"Free{noun}", ctypes.byref(state)) == OK
    assert fmu.call(f"Free{noun}", copy) == ERROR  # nor when it was freed
    fmu.free()


@every_kind
def test_parameters_are_fixed_and_results_are_not_settable(fmu: Fmu, model: str, version: int, interface: str) -> None:
    first = {v.causality: v for v in fmu.variables.values() if v.name != "time" and fmu.kind(v.name) == "real"}
    for state in STATES[interface]:
        enter(fmu, interface, state)
        for causality, variable in first.items():
            if causality == "input":
                continue  # in the table of all calls
            value = float(variable.start or 0.0)
            if causality == "parameter" and state in (INSTANTIATED, "initialisation mode"):
                assert fmu.set(variable.name, value) == OK, fmu.last_message
            else:
                assert fmu.set(variable.name, value) == ERROR
                said = fmu.last_message
                assert f"variable {variable.name} is" in said or f"state '{state}'" in said
        fmu.free()


def beyond(variable: object, kind: str) -> list[tuple[float, bool]]:
    """Values at and just outside the bounds of a variable: (value, allowed)."""
    tried: list[tuple[float, bool]] = []
    for bound, way in ((variable.min, -1), (variable.max, 1)):
        if bound is None:
            continue
        if kind == "integer":
            value = int(float(bound))
            tried.append((value, True))
            if -(2**31) < value < 2**31 - 1:
                tried.append((value + way, False))
        else:
            value = float(bound)
            tried += [(value, True), (math.nextafter(value, way * math.inf), False)]
    return tried


@pytest.mark.parametrize(("model", "version"), [(m, v) for m in MODELS for v in (2, 3)])
def test_every_bound_of_every_variable_holds(fmu: Fmu, model: str, version: int) -> None:
    """A value on the bound is accepted; the next floating-point number beyond it is refused by name, value and
    range."""
    assert fmu.instantiate()
    bounded = 0
    for name, variable in fmu.variables.items():
        if variable.causality not in ("input", "parameter"):
            continue
        kind = fmu.kind(name)
        if kind == "real" and variable.causality == "parameter":
            assert None not in (variable.min, variable.max), f"{name} has no range"
            assert fmu.set(name, math.nan) == ERROR, name
        for value, allowed in beyond(variable, kind):
            bounded += 1
            status = fmu.set(name, value)
            assert status == (OK if allowed else ERROR), f"{name} = {value!r}: {fmu.last_message}"
            if not allowed:
                pattern = rf": variable {re.escape(name)} is \S+, but must be finite and in \[\S+, \S+\]$"
                assert re.search(pattern, fmu.last_message), fmu.last_message
                shown = float(re.search(r" is (\S+), but", fmu.last_message)[1])
                assert shown == value
    assert bounded > 20
    fmu.free()
