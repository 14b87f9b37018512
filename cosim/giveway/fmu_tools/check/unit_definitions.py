"""Units: defined, used, and those of derivatives."""

from __future__ import annotations

import math
from collections.abc import Mapping

from giveway.fmu_tools.archive import shown
from giveway.fmu_tools.check.common import FAULT, NOTE, Found, TestedFile, effective
from giveway.fmu_tools.description import Unit

__all__ = ["units"]


def units(file: TestedFile) -> Found:
    description = file.described()
    units: dict[str, Unit] = {}
    for unit in description.units:
        if unit.name in units:
            yield FAULT, f"unit {shown(unit.name)} is defined twice"
        if unit.factor == 0.0 or math.isinf(unit.factor):
            yield FAULT, f"unit {shown(unit.name)} has the factor {unit.factor:g}"
        units[unit.name] = unit
    used: set[str] = set()
    for variable in description.variables:
        name = shown(variable.name)
        kind = variable.get("declaredType")
        if kind and kind not in description.types:
            yield FAULT, f"{name} is of the type {shown(kind)}, which is not defined"
        unit_name, display = (effective(description, variable, n) for n in ("unit", "displayUnit"))
        if unit_name:
            used.add(unit_name)
            if unit_name not in units:
                yield FAULT, f"{name} is in {shown(unit_name)}, which is not defined"
            elif display and display not in units[unit_name].display_units:
                yield FAULT, f"{name} is shown in {shown(display)}, which is no display unit of {shown(unit_name)}"
    for unit_name in sorted(set(units) - used):
        yield NOTE, f"unit {shown(unit_name)} is defined, but no variable has it"
    yield from _derivative_units(file, units)


def _derivative_units(file: TestedFile, units: Mapping[str, Unit]) -> Found:
    description = file.described()
    per_second = (0, 0, -1, 0, 0, 0, 0, 0)
    for variable in description.variables:
        state = file.state_of(variable)
        if state is None:
            continue
        unit, of = (units.get(effective(description, v, "unit")) for v in (variable, state))
        if unit is None or of is None or unit.base is None or of.base is None:
            continue
        expected = tuple(a + b for a, b in zip(of.base, per_second, strict=True))
        if unit.base != expected or not math.isclose(unit.factor, of.factor, rel_tol=1e-12):
            of_name, state_name = shown(of.name), shown(state.name)
            yield FAULT, f"{shown(variable.name)} is in {shown(unit.name)}, but its state {state_name} in {of_name}"
