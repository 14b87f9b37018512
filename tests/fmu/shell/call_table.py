"""Every function of FMI 2 and FMI 3: how to call it, and in which states the standard allows it.

The table is written from the standards (FMI 2.0.4: tables of 3.2.3 and 4.2.4; FMI 3.0.2: 2.3.1, 3.2 and 4.2), not from
the shell. Three deviations, all on the lenient side, since importers depend on them: derivatives and nominals may be
read in the initialisation mode (FMI 2), and discrete inputs may be set in continuous time, where they wait for the
next event.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass

from fmu_driver import Fmu

__all__ = ["CALLS", "STATES", "Call", "enter", "legal_states"]

INSTANTIATED, INITIALISATION, STEP = "instantiated", "initialisation mode", "step mode"
EVENT, CONTINUOUS = "event mode", "continuous-time mode"
TERMINATED, FAILED = "terminated", "failed"
STATES = {
    "CS": (INSTANTIATED, INITIALISATION, STEP, TERMINATED, FAILED),
    "ME": (INSTANTIATED, INITIALISATION, EVENT, CONTINUOUS, TERMINATED, FAILED),
}
ALL = frozenset(STATES["CS"] + STATES["ME"])
NONE: frozenset[str] = frozenset()
RUNNING = frozenset((STEP, EVENT, CONTINUOUS))
READABLE = RUNNING | {INITIALISATION, TERMINATED, FAILED}
WRITABLE = RUNNING | {INSTANTIATED, INITIALISATION}
EVALUABLE = frozenset((INITIALISATION, EVENT, CONTINUOUS, TERMINATED))


class Room:
    """A pointer argument that a test may replace by a null pointer.

    Attributes:
        required: without it the call must be refused.
    """

    def __init__(self, value: object, required: bool = True) -> None:
        self.value, self.required = value, required


Arguments = Callable[[Fmu], list[object]]


@dataclass(frozen=True)
class Call:
    """One function.

    Attributes:
        arguments: of a call that is right but for, perhaps, its state.
        allowed: where it succeeds.
        interface: "CS" or "ME" if only that has it.
        discarded: states where it is allowed but has no result (status "discard").
        prepare: the function that must come before it in an allowed state.
    """

    name: str
    arguments: Arguments
    allowed: frozenset[str]
    interface: str = ""
    discarded: frozenset[str] = NONE
    prepare: str = ""


def legal_states(call: Call, interface: str, exchange: bool) -> frozenset[str]:
    """The states of ``interface`` in which ``call`` succeeds; ``exchange``: the FMU has Model Exchange."""
    if call.interface not in ("", interface) or (call.interface == "ME" and not exchange):
        return NONE
    return call.allowed & frozenset(STATES[interface])


def _none(_fmu: Fmu) -> list[object]:
    return []


def _count(value: int) -> ctypes.c_size_t:
    return ctypes.c_size_t(value)


def _real(value: float = 0.0) -> ctypes.c_double:
    return ctypes.c_double(value)


_TYPES = {"real": ctypes.c_double, "integer": ctypes.c_int32}
_NAMES = {2: {"real": "Real", "integer": "Integer", "boolean": "Boolean"},
          3: {"real": "Float64", "integer": "Int32", "boolean": "Boolean"}}  # fmt: skip


def _ctype(fmu: Fmu, kind: str) -> type:
    return _TYPES.get(kind, ctypes.c_int if fmu.version == 2 else ctypes.c_bool)


def _access(kind: str, causality: str) -> Arguments:
    """References and values of the first variable of ``kind``; no variable at all if there is none."""

    def build(fmu: Fmu) -> list[object]:
        chosen = [v for v in fmu.variables.values() if v.causality == causality and fmu.kind(v.name) == kind][:1]
        references = (ctypes.c_uint32 * 1)(*(v.valueReference for v in chosen))
        start = [
            0 if v.start is None else float(v.start not in ("false", "0")) if kind == "boolean" else v.start
            for v in chosen
        ]
        numbers = [float(x) if kind == "real" else int(float(x)) for x in start]
        values = (_ctype(fmu, kind) * 1)(*numbers)
        size, needed = _count(len(chosen)), bool(chosen)
        tail = [size] if fmu.version == 3 else []
        return [Room(references, needed), size, Room(values, needed), *tail]

    return build


def _no_variables(sizes: int) -> Arguments:
    return lambda _fmu: [None, _count(0), *([None, _count(0)][:sizes] if sizes > 1 else [None])]


def _states(fmu: Fmu) -> int:
    return len(fmu.description.derivatives)


def _array(size: Callable[[Fmu], int]) -> Arguments:
    return lambda fmu: [Room((ctypes.c_double * max(size(fmu), 1))()), _count(size(fmu))]


def _indicators(fmu: Fmu) -> int:
    return fmu.description.numberOfEventIndicators if fmu.version == 2 else len(fmu.description.eventIndicators)


def _current_states(fmu: Fmu) -> list[object]:
    count = _states(fmu)
    values = (ctypes.c_double * max(count, 1))()
    fmu.call("GetContinuousStates", values, _count(count))
    return [Room(values), _count(count)]


def _time(_fmu: Fmu) -> list[object]:
    return [_real(0.0)]


def _experiment(_fmu: Fmu) -> list[object]:
    return [0, _real(), _real(), 0, _real()]


def _step(fmu: Fmu) -> list[object]:
    times: list[object] = [_real(0.0), _real(1e-3), 0]
    if fmu.version == 2:
        return times
    flags = [Room(ctypes.pointer(ctypes.c_bool()), required=False) for _ in range(3)]
    return [*times, *flags, Room(ctypes.pointer(ctypes.c_double()), required=False)]


def _completed(fmu: Fmu) -> list[object]:
    kind = ctypes.c_int if fmu.version == 2 else ctypes.c_bool
    return [1, *(Room(ctypes.pointer(kind()), required=False) for _ in range(2))]


def _update(fmu: Fmu) -> list[object]:
    if fmu.version == 2:
        return [Room((ctypes.c_double * 8)())]  # room enough for fmi2EventInfo
    flags = [Room(ctypes.pointer(ctypes.c_bool()), required=False) for _ in range(5)]
    return [*flags, Room(ctypes.pointer(ctypes.c_double()), required=False)]


def _state_names(fmu: Fmu) -> tuple[str, str]:
    return ("FMUstate", "DeSerializeFMUstate") if fmu.version == 2 else ("FMUState", "DeserializeFMUState")


def saved_state(fmu: Fmu) -> ctypes.c_void_p:
    """A new saved state."""
    state = ctypes.c_void_p()
    fmu.call(f"Get{_state_names(fmu)[0]}", ctypes.byref(state))
    return state


def serialised(fmu: Fmu) -> bytes:
    """The whole state of the instance, as bytes."""
    noun = _state_names(fmu)[0]
    state, size = saved_state(fmu), ctypes.c_size_t()
    fmu.call(f"Serialized{noun}Size", state, ctypes.byref(size))
    room = (ctypes.c_ubyte * size.value)()
    fmu.call(f"Serialize{noun}", state, room, size)
    fmu.call(f"Free{noun}", ctypes.byref(state))
    return bytes(room)


def _get_state(_fmu: Fmu) -> list[object]:
    return [Room(ctypes.pointer(ctypes.c_void_p()))]


def _set_state(fmu: Fmu) -> list[object]:
    return [Room(saved_state(fmu))]


def _free_state(fmu: Fmu) -> list[object]:
    return [Room(ctypes.pointer(saved_state(fmu)), required=False)]


def _state_size(fmu: Fmu) -> list[object]:
    return [Room(saved_state(fmu)), Room(ctypes.pointer(ctypes.c_size_t()))]


def _serialise(fmu: Fmu) -> list[object]:
    size = len(serialised(fmu))
    return [Room(saved_state(fmu)), Room((ctypes.c_ubyte * size)()), _count(size)]


def _deserialise(fmu: Fmu) -> list[object]:
    data = serialised(fmu)
    return [
        Room((ctypes.c_ubyte * len(data)).from_buffer_copy(data)),
        _count(len(data)),
        Room(ctypes.pointer(ctypes.c_void_p())),
    ]


def _status(kind: int, result: type) -> Arguments:
    return lambda _fmu: [kind, Room(ctypes.pointer(result()))]


def _number(_fmu: Fmu) -> list[object]:
    return [Room(ctypes.pointer(ctypes.c_size_t()))]


def _categories(_fmu: Fmu) -> list[object]:
    return [1, _count(1), Room((ctypes.c_char_p * 1)(b"logStatusError"))]


def _zeros(_fmu: Fmu) -> list[object]:
    return [_count(0)] * 9


def _shared(version: int) -> list[Call]:
    noun, deserialise = ("FMUstate", "DeSerializeFMUstate") if version == 2 else ("FMUState", "DeserializeFMUState")
    names = _NAMES[version]
    calls = [
        Call("SetDebugLogging", _categories, ALL),
        Call("ExitInitializationMode", _none, frozenset({INITIALISATION})),
        Call("Terminate", _none, RUNNING),
        Call("Reset", _none, ALL),
        Call(f"Get{noun}", _get_state, ALL),
        Call(f"Set{noun}", _set_state, ALL),
        Call(f"Free{noun}", _free_state, ALL),
        Call(f"Serialized{noun}Size", _state_size, ALL),
        Call(f"Serialize{noun}", _serialise, ALL),
        Call(deserialise, _deserialise, ALL),
        Call("GetDirectionalDerivative", _zeros, NONE),
        Call("DoStep", _step, frozenset({STEP}), "CS"),
        Call("EnterContinuousTimeMode", _none, frozenset({EVENT}), "ME", prepare="update"),
        Call("CompletedIntegratorStep", _completed, frozenset({CONTINUOUS}), "ME"),
        Call("SetTime", _time, frozenset({EVENT, CONTINUOUS}), "ME"),
        Call("SetContinuousStates", _current_states, frozenset({CONTINUOUS}), "ME"),
        Call("GetEventIndicators", _array(_indicators), EVALUABLE, "ME"),
        Call("GetContinuousStates", _array(_states), EVALUABLE, "ME"),
    ]
    for kind, name in names.items():
        calls.append(Call(f"Get{name}", _access(kind, "output"), READABLE))
        calls.append(Call(f"Set{name}", _access(kind, "input"), WRITABLE))
    return calls


_STEPPED = frozenset({STEP, TERMINATED, FAILED})
_FMI2 = [
    Call("SetupExperiment", _experiment, frozenset({INSTANTIATED})),
    Call("EnterInitializationMode", _none, frozenset({INSTANTIATED}), prepare="setup"),
    Call("GetString", _no_variables(1), READABLE),
    Call("SetString", _no_variables(1), WRITABLE),
    Call("SetRealInputDerivatives", _zeros, NONE),
    Call("GetRealOutputDerivatives", _zeros, NONE),
    Call("CancelStep", _none, NONE),
    Call("GetStatus", _status(0, ctypes.c_int), NONE, "CS", discarded=_STEPPED),
    Call("GetRealStatus", _status(2, ctypes.c_double), _STEPPED, "CS"),
    Call("GetIntegerStatus", _status(0, ctypes.c_int), NONE, "CS", discarded=_STEPPED),
    Call("GetBooleanStatus", _status(3, ctypes.c_int), _STEPPED, "CS"),
    Call("GetStringStatus", _status(1, ctypes.c_char_p), NONE, "CS", discarded=_STEPPED),
    Call("EnterEventMode", _none, frozenset({EVENT, CONTINUOUS}), "ME"),
    Call("NewDiscreteStates", _update, frozenset({EVENT}), "ME"),
    Call("GetDerivatives", _array(_states), EVALUABLE, "ME"),
    Call("GetNominalsOfContinuousStates", _array(_states), EVALUABLE | {INSTANTIATED}, "ME"),
]
_NO_TYPES = ("Float32", "Int8", "UInt8", "Int16", "UInt16", "UInt32", "Int64", "UInt64", "String")
_NOT_OFFERED = (
    "EnterConfigurationMode",
    "ExitConfigurationMode",
    "EnterStepMode",
    "EvaluateDiscreteStates",
    "GetNumberOfVariableDependencies",
    "GetVariableDependencies",
    "GetAdjointDerivative",
    "GetOutputDerivatives",
    "GetIntervalDecimal",
    "GetIntervalFraction",
    "GetShiftDecimal",
    "GetShiftFraction",
    "SetIntervalDecimal",
    "SetIntervalFraction",
    "SetShiftDecimal",
    "SetShiftFraction",
    "ActivateModelPartition",
)
_FMI3 = [
    Call("EnterInitializationMode", _experiment, frozenset({INSTANTIATED})),
    Call("EnterEventMode", _none, frozenset({CONTINUOUS}), "ME"),
    Call("UpdateDiscreteStates", _update, frozenset({EVENT}), "ME"),
    Call("GetContinuousStateDerivatives", _array(_states), EVALUABLE, "ME"),
    Call("GetNominalsOfContinuousStates", _array(_states), EVALUABLE, "ME"),
    Call("GetNumberOfContinuousStates", _number, ALL, "ME"),
    Call("GetNumberOfEventIndicators", _number, ALL, "ME"),
    *(Call(f"Get{name}", _no_variables(2), READABLE) for name in _NO_TYPES),
    *(Call(f"Set{name}", _no_variables(2), WRITABLE) for name in _NO_TYPES),
    Call("GetBinary", lambda _fmu: [None, _count(0), None, None, _count(0)], READABLE),
    Call("SetBinary", lambda _fmu: [None, _count(0), None, None, _count(0)], WRITABLE),
    Call("GetClock", lambda _fmu: [None, _count(0), None], READABLE),
    Call("SetClock", lambda _fmu: [None, _count(0), None], WRITABLE),
    *(Call(name, _zeros, NONE) for name in _NOT_OFFERED),
]
CALLS = {2: _shared(2) + _FMI2, 3: _shared(3) + _FMI3}


def enter(fmu: Fmu, interface: str, state: str) -> None:
    """A new instance, in ``state``."""
    assert fmu.instantiate() if interface == "CS" else fmu.instantiate_exchange()
    if state == INSTANTIATED:
        return
    if state == FAILED:
        _fail(fmu)
        return
    assert fmu.setup() == 0, fmu.last_message
    if state == INITIALISATION:
        return
    assert fmu.exit_initialisation() == 0, fmu.last_message
    if state == TERMINATED:
        assert fmu.call("Terminate") == 0
    elif state == CONTINUOUS:
        fmu.settle()
        assert fmu.call("EnterContinuousTimeMode") == 0, fmu.last_message


def _fail(fmu: Fmu) -> None:
    """An instance fails if the model refuses something: here a saved state with a valid header that ends early."""
    data = serialised(fmu)
    header, body = data[:40], data[40:-8]
    checksum = 0xCBF29CE484222325
    for byte in body:
        checksum = (checksum ^ byte) * 0x100000001B3 % 2**64
    forged = header[:24] + len(body).to_bytes(8, "little") + checksum.to_bytes(8, "little") + body
    noun, deserialise = _state_names(fmu)
    state = ctypes.c_void_p()
    room = (ctypes.c_ubyte * len(forged)).from_buffer_copy(forged)
    assert fmu.call(deserialise, room, _count(len(forged)), ctypes.byref(state)) == 0, fmu.last_message
    assert fmu.call(f"Set{noun}", state) == 3, "the model took half a state"
    fmu.call(f"Free{noun}", ctypes.byref(state))
