"""The model description: identity, names, start values; and what FMPy says of it."""

from __future__ import annotations

import math
import re
from collections import Counter

from giveway.fmu_check.common import FAULT, REALS, Found, TestedFile, effective, number
from giveway.fmu_description import VariableEntry

__all__ = ["fmpy_validation", "identity", "names_and_references", "start_presence", "start_values"]


_INTEGER_BITS = {"Int8": 8, "Int16": 16, "Int32": 32, "Int64": 64, "Integer": 32, "Enumeration": 64}


def identity(file: TestedFile) -> Found:
    description = file.described()
    if not description.token.strip():
        yield FAULT, "the guid or instantiation token is empty"
    if not description.interfaces:
        yield FAULT, "there is no interface: no Model Exchange, Co-Simulation or Scheduled Execution"
    for interface, attributes in description.interfaces.items():
        identifier = attributes.get("modelIdentifier", "")
        if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", identifier):
            yield FAULT, f"{interface}: the model identifier {identifier!r} is not a name in C"
        saves = ("canGetAndSetFMUstate", "canGetAndSetFMUState")
        serialises = ("canSerializeFMUstate", "canSerializeFMUState")
        if any(attributes.get(n) == "true" for n in serialises) and not any(attributes.get(n) == "true" for n in saves):
            yield FAULT, f"{interface}: can serialise its state, but not get and set it"
    start, stop, step = (number(description.experiment.get(n, "")) for n in ("startTime", "stopTime", "stepSize"))
    if stop is not None and stop <= (start or 0.0):
        yield FAULT, f"the default experiment stops at {stop:g} s, not after its start at {start or 0.0:g} s"
    if step is not None and not step > 0.0:
        yield FAULT, f"the default step size is {step:g} s"


def names_and_references(file: TestedFile) -> Found:
    description = file.described()
    for name, times in Counter(v.name for v in description.variables).items():
        if times > 1:
            yield FAULT, f"{times} variables are called {name}"
    same: dict[tuple[str, int], list[VariableEntry]] = {}
    for variable in description.variables:
        # In FMI 2 each base type counts for itself, and an alias has the reference of another variable.
        kind = variable.type if description.version == 2 else ""
        same.setdefault((kind, variable.reference), []).append(variable)
    for (_, reference), variables in same.items():
        if len(variables) > 1:
            names = ", ".join(v.name for v in variables)
            yield description.version == 3, f"value reference {reference} is shared by {names}"
            units = {v.get("unit") for v in variables}
            if len(units) > 1:
                yield FAULT, f"value reference {reference} has different units: {names}"


def start_values(file: TestedFile) -> Found:
    description = file.described()
    for variable in description.variables:
        bits = _INTEGER_BITS.get(variable.type)
        unsigned = re.fullmatch(r"UInt(\d+)", variable.type)
        if variable.type not in REALS and bits is None and unsigned is None:
            continue
        low, high = (number(effective(description, variable, n)) for n in ("min", "max"))
        if low is not None and high is not None and low > high:
            yield FAULT, f"{variable.name}: min {low:g} is above max {high:g}"
        nominal = number(effective(description, variable, "nominal"))
        if nominal is not None and not nominal > 0.0:
            yield FAULT, f"{variable.name}: nominal {nominal:g} is not positive"
        for text in variable.get("start").split():
            start = number(text)
            if start is None or ((bits or unsigned) and start != int(start)):
                yield FAULT, f"{variable.name}: start {text!r} is not a value of type {variable.type}"
                continue
            if (low is not None and start < low) or (high is not None and start > high):
                yield FAULT, f"{variable.name}: start {text} is outside its bounds, {low} to {high}"
            width = int(unsigned[1]) if unsigned else bits
            if width is not None:
                least, most = (0, 2**width - 1) if unsigned else (-(2 ** (width - 1)), 2 ** (width - 1) - 1)
                if not least <= start <= most:
                    yield FAULT, f"{variable.name}: start {text} does not fit into {variable.type}"
            elif not math.isfinite(start):
                yield FAULT, f"{variable.name}: start {text} is not finite"


def start_presence(file: TestedFile) -> Found:
    for variable in file.described().variables:
        needed = variable.causality == "input" or variable.initial in ("exact", "approx")
        clock = variable.type == "Clock"
        has_start = "start" in variable.attributes or variable.type in ("String", "Binary")
        if needed and not has_start and not clock:
            yield FAULT, f"{variable.name} ({variable.causality}, {variable.initial or 'set'}) has no start value"
        if "start" in variable.attributes and (variable.initial == "calculated" or variable.causality == "independent"):
            yield FAULT, f"{variable.name} is {variable.initial or 'independent'}, but has a start value"


def fmpy_validation(file: TestedFile) -> Found:
    """What FMPy's own validation says; it knows rules for names and for pairs of causality and variability."""
    from fmpy.validation import validate_fmu

    assert file.archive.filename is not None
    for text in validate_fmu(file.archive.filename):
        yield FAULT, " ".join(text.split())
