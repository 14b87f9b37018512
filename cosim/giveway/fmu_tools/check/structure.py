"""ModelStructure: complete, without superfluous entries."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from giveway.fmu_tools.archive import shown
from giveway.fmu_tools.check.common import FAULT, NOTE, REALS, Found, TestedFile
from giveway.fmu_tools.description import Unknown, VariableEntry

__all__ = ["event_indicators", "structure"]


def structure(file: TestedFile) -> Found:
    """ModelStructure names every output, derivative and unknown of the initialisation once, and nothing else."""
    description = file.described()
    derived = [v for v in description.variables if v.get("derivative")]
    wanted = {
        "outputs": [v for v in description.variables if v.causality == "output"],
        "derivatives": derived,
        "initial unknowns": _initial_unknowns(file, derived),
    }
    sections = {
        "outputs": description.outputs,
        "derivatives": description.derivatives,
        "initial unknowns": description.initial_unknowns,
        "event indicators": description.indicators,
        "clocked states": description.clocked_states,
    }
    # FMI 3.0, 2.4.8: clocked variables may be among the initial unknowns, as the FMU wishes to initialise them.
    optional = {description.key(v) for v in description.variables if v.is_clocked}
    if "ModelExchange" not in description.interfaces:
        wanted["derivatives"] = [file.by_key[u.key] for u in description.derivatives if u.key in file.by_key]
    for section, unknowns in sections.items():
        yield from _unknowns(section, unknowns, file.by_key)
        if section not in wanted:
            continue
        listed = dict.fromkeys(u.key for u in unknowns)
        expected = dict.fromkeys(description.key(v) for v in wanted[section])
        for key in expected:
            if key not in listed:
                yield FAULT, f"{shown(file.by_key[key].name)} is not among the {section}"
        for key in listed:
            if key in file.by_key and key not in expected and not (section == "initial unknowns" and key in optional):
                yield FAULT, f"{shown(file.by_key[key].name)} is among the {section}, but is none"
    for variable in derived:
        if file.state_of(variable) is None:
            of = shown(variable.get("derivative"))
            yield FAULT, f"{shown(variable.name)} is the derivative of {of}, which is no variable"


def _initial_unknowns(file: TestedFile, derived: list[VariableEntry]) -> list[VariableEntry]:
    """The required ones, without clocked variables."""
    states = {state.name for v in derived if (state := file.state_of(v)) is not None}
    states_and_rates = states | {v.name for v in derived}
    return [
        v
        for v in file.described().variables
        if v.initial in ("approx", "calculated")
        and v.variability != "constant"
        and (
            (v.causality == "output" and not v.is_clocked)
            or v.causality == "calculatedParameter"
            or v.name in states_and_rates
        )
    ]


def _unknowns(section: str, unknowns: tuple[Unknown, ...], by_key: Mapping[int, VariableEntry]) -> Found:
    for key, times in Counter(u.key for u in unknowns).items():
        if times > 1:
            yield FAULT, f"{shown(by_key[key].name) if key in by_key else key} is {times} times among the {section}"
    for unknown in unknowns:
        if unknown.key not in by_key:
            yield FAULT, f"{unknown.key} among the {section} is no variable"
            continue
        name = shown(by_key[unknown.key].name)
        if unknown.dependencies is None:
            if section in ("outputs", "derivatives"):
                yield (
                    NOTE,
                    f"{name} states no dependencies: importers take that for all inputs, and see algebraic loops",
                )
            if unknown.kinds is not None:
                yield FAULT, f"{name} has kinds of dependencies, but no dependencies"
            continue
        for key in unknown.dependencies:
            if key not in by_key:
                yield FAULT, f"{name} depends on {key}, which is no variable"
        if unknown.kinds is not None and len(unknown.kinds) != len(unknown.dependencies):
            yield FAULT, f"{name} has {len(unknown.dependencies)} dependencies, but {len(unknown.kinds)} kinds of them"


def event_indicators(file: TestedFile) -> Found:
    description = file.described()
    if description.version == 2 and "ModelExchange" in description.interfaces:
        count = description.attributes.get("numberOfEventIndicators", "0")
        if not count.isdigit():
            yield FAULT, f"numberOfEventIndicators is {shown(count)!r}"
    for unknown in description.indicators:
        variable = file.by_key.get(unknown.key)
        if variable is not None and (variable.type not in REALS or variable.variability != "continuous"):
            yield FAULT, f"the event indicator {shown(variable.name)} is not a continuous real"
