"""ModelStructure: complete, and nothing too much."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from giveway.fmu_check.common import FAULT, NOTE, REALS, Found, TestedFile, state_of
from giveway.fmu_description import Description, Unknown, VariableEntry

__all__ = ["event_indicators", "structure"]


def structure(file: TestedFile) -> Found:
    """ModelStructure names every output, derivative and unknown of the initialisation once, and nothing else."""
    description = file.described()
    by_key = {description.key(v): v for v in description.variables}
    derived = [v for v in description.variables if v.get("derivative")]
    wanted = {
        "outputs": [v for v in description.variables if v.causality == "output"],
        "derivatives": derived,
        "initial unknowns": _initial_unknowns(description, derived),
    }
    sections = {
        "outputs": description.outputs,
        "derivatives": description.derivatives,
        "initial unknowns": description.initial_unknowns,
        "event indicators": description.indicators,
    }
    if "ModelExchange" not in description.interfaces:
        wanted["derivatives"] = [by_key[u.key] for u in description.derivatives if u.key in by_key]
    for section, unknowns in sections.items():
        yield from _unknowns(description, section, unknowns, by_key)
        if section not in wanted:
            continue
        listed = [u.key for u in unknowns]
        expected = [description.key(v) for v in wanted[section]]
        for key in expected:
            if key not in listed:
                yield FAULT, f"{by_key[key].name} is not among the {section}"
        for key in listed:
            if key in by_key and key not in expected:
                yield FAULT, f"{by_key[key].name} is among the {section}, but is none"
    for variable in derived:
        state = state_of(description, variable)
        if state is None:
            yield FAULT, f"{variable.name} is the derivative of {variable.get('derivative')}, which is no variable"


def _initial_unknowns(description: Description, derived: list[VariableEntry]) -> list[VariableEntry]:
    states = {state.name for v in derived if (state := state_of(description, v)) is not None}
    rates = {v.name for v in derived}
    return [
        v
        for v in description.variables
        if v.initial in ("approx", "calculated")
        and v.variability != "constant"
        and (v.causality in ("output", "calculatedParameter") or v.name in states | rates)
    ]


def _unknowns(
    description: Description, section: str, unknowns: tuple[Unknown, ...], by_key: Mapping[int, VariableEntry]
) -> Found:
    for key, times in Counter(u.key for u in unknowns).items():
        if times > 1:
            yield FAULT, f"{by_key[key].name if key in by_key else key} is {times} times among the {section}"
    for unknown in unknowns:
        if unknown.key not in by_key:
            yield FAULT, f"{unknown.key} among the {section} is no variable"
            continue
        name = by_key[unknown.key].name
        if unknown.dependencies is None:
            if section in ("outputs", "derivatives"):
                yield (
                    NOTE,
                    f"{name} states no dependencies: importers take that for all inputs, and see algebraic loops",
                )
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
            yield FAULT, f"numberOfEventIndicators is {count!r}"
    for unknown in description.indicators:
        variable = next((v for v in description.variables if v.reference == unknown.key), None)
        if variable is not None and (variable.type not in REALS or variable.variability != "continuous"):
            yield FAULT, f"the event indicator {variable.name} is not a continuous real"
