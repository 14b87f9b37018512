"""The model description: identity, names, start values; and FMPy's findings."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator
from importlib.metadata import version as version_of
from itertools import islice

from giveway.base.files import scratch_folder
from giveway.fmu_tools.archive import shown
from giveway.fmu_tools.check.common import DESCRIPTION, FAULT, NOTE, WARNING, Found, TestedFile, effective, number
from giveway.fmu_tools.check.documents import BUILD_DESCRIPTION
from giveway.fmu_tools.description import REALS, VariableEntry

__all__ = [
    "fmpy_validation",
    "identity",
    "names_and_references",
    "numbers",
    "start_presence",
    "start_values",
    "variable_names",
]

_SIGNED = {"Int8": 8, "Int16": 16, "Int32": 32, "Int64": 64, "Integer": 32, "Enumeration": 64}
_UNSIGNED = {"UInt8": 8, "UInt16": 16, "UInt32": 32, "UInt64": 64}
MOST_STARTS = 200_000  # checked numbers in start values, of all arrays together
MOST_FOR_FMPY = 5_000  # variables; its reader takes some 20 us and kB for each

# Naming convention "structured": a.b[1,2].c or der(a.b, 2); a part may be any text in single quotes.
_PART = r"(?:[A-Za-z_][A-Za-z0-9_]*|'(?:[A-Za-z0-9_!#$%&()*+,\-./:;<>=?@\[\]^{}|~ ]|\\['\"?\\abfnrtv])+')"
_INDEXED = rf"{_PART}(?:\[[0-9]+(?:,[0-9]+)*\])?"
_IDENTIFIER = rf"{_INDEXED}(?:\.{_INDEXED})*"
_STRUCTURED = re.compile(rf"{_IDENTIFIER}|der\({_IDENTIFIER}(?:,[0-9]+)?\)")


def numbers(file: TestedFile) -> Found:
    """Every number of the standard is a number in the file, and no section is missing."""
    for problem in file.described().problems:
        yield FAULT, shown(problem, 200)


def identity(file: TestedFile) -> Found:
    description = file.described()
    if not description.token.strip():
        yield FAULT, "the guid or instantiation token is empty"
    if not description.interfaces:
        yield FAULT, "there is no interface: no Model Exchange, Co-Simulation or Scheduled Execution"
    for interface, attributes in description.interfaces.items():
        identifier = attributes.get("modelIdentifier", "")
        if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", identifier):
            yield FAULT, f"{interface}: the model identifier {shown(identifier)!r} is not a name in C"
        saves = ("canGetAndSetFMUstate", "canGetAndSetFMUState")
        serialises = ("canSerializeFMUstate", "canSerializeFMUState")
        if any(attributes.get(n) == "true" for n in serialises) and not any(attributes.get(n) == "true" for n in saves):
            yield FAULT, f"{interface}: can serialise its state, but not get and set it"
    start, stop, step = (number(description.experiment.get(n, "")) for n in ("startTime", "stopTime", "stepSize"))
    if stop is not None and stop <= (start or 0.0):
        yield FAULT, f"the default experiment stops at {stop:g} s, not after its start at {start or 0.0:g} s"
    if step is not None and not step > 0.0:
        yield FAULT, f"the default step size is {step:g} s"


def variable_names(file: TestedFile) -> Found:
    """By the naming convention that the file states."""
    description = file.described()
    structured = description.attributes.get("variableNamingConvention") == "structured"
    for variable in description.variables:
        for name in (variable.name, *variable.aliases):
            if structured and not _STRUCTURED.fullmatch(name):
                yield FAULT, f"{shown(name)} is no name of the convention 'structured'"
            elif not name:
                yield FAULT, f"variable {variable.index} has no name"
            elif any(character in name for character in "\r\n\t"):
                yield FAULT, f"{shown(name)} has a line break or a tab"


def names_and_references(file: TestedFile) -> Found:
    description = file.described()
    for name, times in Counter(n for v in description.variables for n in (v.name, *v.aliases)).items():
        if times > 1:
            yield FAULT, f"{times} variables are called {shown(name)}"
    same: dict[tuple[str, int], list[VariableEntry]] = {}
    for variable in description.variables:
        # In FMI 2 references are unique per base type, and an alias has the reference of another variable.
        kind = variable.type if description.version == 2 else ""
        same.setdefault((kind, variable.reference), []).append(variable)
    for (_, reference), variables in same.items():
        if len(variables) > 1:
            names = shown(", ".join(v.name for v in variables[:10]), 200)
            shared = FAULT if description.version == 3 else NOTE
            yield shared, f"value reference {reference} is shared by {names}"
            units = {effective(description, v, "unit") for v in variables}
            if len(units) > 1:
                yield FAULT, f"value reference {reference} has different units: {names}"


def start_values(file: TestedFile) -> Found:
    description = file.described()
    left = MOST_STARTS
    for variable in description.variables:
        signed, unsigned = _SIGNED.get(variable.type), _UNSIGNED.get(variable.type)
        if variable.type not in REALS and signed is None and unsigned is None:
            continue
        name = shown(variable.name)
        low, high = (number(effective(description, variable, n)) for n in ("min", "max"))
        if low is not None and high is not None and low > high:
            yield FAULT, f"{name}: min {low:g} is above max {high:g}"
        nominal = number(effective(description, variable, "nominal"))
        if nominal is not None and not nominal > 0.0:
            yield FAULT, f"{name}: nominal {nominal:g} is not positive"
        for text in islice(_words(variable.get("start")), left):
            left -= 1
            start, word = number(text), shown(text, 40)
            whole = signed is not None or unsigned is not None
            if start is None or (whole and not (math.isfinite(start) and start == int(start))):
                yield FAULT, f"{name}: start {word!r} is not a value of type {variable.type}"
                continue
            if (low is not None and start < low) or (high is not None and start > high):
                yield FAULT, f"{name}: start {word} is outside its bounds, {low} to {high}"
            if whole:
                least = 0 if signed is None else -(2 ** (signed - 1))
                most = 2 ** (unsigned or 0) - 1 if signed is None else 2 ** (signed - 1) - 1
                if not least <= start <= most:
                    yield FAULT, f"{name}: start {word} does not fit into {variable.type}"
            elif not math.isfinite(start):
                yield FAULT, f"{name}: start {word} is not finite"
    if left == 0:
        yield NOTE, f"only the first {MOST_STARTS:,} numbers of start values were looked at"


def _words(text: str) -> Iterator[str]:
    return (found[0] for found in re.finditer(r"\S+", text))


def start_presence(file: TestedFile) -> Found:
    for variable in file.described().variables:
        needed = variable.causality == "input" or variable.initial in ("exact", "approx")
        clock = variable.type == "Clock"
        has_start = "start" in variable.attributes or variable.type in ("String", "Binary")
        name = shown(variable.name)
        if needed and not has_start and not clock:
            yield FAULT, f"{name} ({variable.causality}, {variable.initial or 'set'}) has no start value"
        if "start" in variable.attributes and (variable.initial == "calculated" or variable.causality == "independent"):
            yield FAULT, f"{name} is {variable.initial or 'independent'}, but has a start value"


def fmpy_validation(file: TestedFile) -> Found:
    """Findings of FMPy's own validation; it knows rules for pairs of causality and variability."""
    from fmpy import read_model_description
    from fmpy.model_description import ValidationError

    count = len(file.described().variables)
    if count > MOST_FOR_FMPY:
        yield NOTE, f"FMPy was not asked: {count:,} variables are more than {MOST_FOR_FMPY:,}"
        return
    with scratch_folder("giveway-check-") as folder:
        # It gets a folder with the two files that it reads, since it unpacks without limits.
        for name in {DESCRIPTION, BUILD_DESCRIPTION} & file.sound:
            path = folder / name
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(file.read(name))
        try:
            # Its rule for the initial unknowns does not know that clocked variables may be among them.
            read_model_description(str(folder), validate=True, validate_model_structure=False)
        except ValidationError as error:
            for text in error.problems:
                yield FAULT, shown(" ".join(text.split()), 400)
        except Exception as error:
            reason = shown(" ".join(str(error).split()), 400)
            if type(error) is Exception:  # its own words
                yield FAULT, reason
            else:  # it fails on unexpected content
                yield WARNING, f"FMPy {version_of('fmpy')} cannot read it ({type(error).__name__}: {reason})"
