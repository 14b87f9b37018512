"""Units: defined, used, and those of derivatives."""

from __future__ import annotations

import math
from collections.abc import Mapping

from giveway.fmu_check.common import FAULT, NOTE, Found, TestedFile, effective, state_of
from giveway.fmu_description import Description, Unit

__all__ = ["units"]


def units(file: TestedFile) -> Found:
    description = file.described()
    units: dict[str, Unit] = {}
    for unit in description.units:
        if unit.name in units:
            yield FAULT, f"unit {unit.name} is defined twice"
        if unit.factor == 0.0 or not math.isfinite(unit.factor):
            yield FAULT, f"unit {unit.name} has the factor {unit.factor:g}"
        units[unit.name] = unit
    used: set[str] = set()
    for variable in description.variables:
        kind = variable.get("declaredType")
        if kind and kind not in description.types:
            yield FAULT, f"{variable.name} is of the type {kind}, which is not defined"
        name, shown = (effective(description, variable, n) for n in ("unit", "displayUnit"))
        if name:
            used.add(name)
            if name not in units:
                yield FAULT, f"{variable.name} is in {name}, which is not defined"
            elif shown and shown not in units[name].display_units:
                yield FAULT, f"{variable.name} is shown in {shown}, which is no display unit of {name}"
    for name in sorted(set(units) - used):
        yield NOTE, f"unit {name} is defined, but no variable has it"
    yield from _derivative_units(description, units)


def _derivative_units(description: Description, units: Mapping[str, Unit]) -> Found:
    per_second = (0, 0, -1, 0, 0, 0, 0, 0)
    for variable in description.variables:
        state = state_of(description, variable)
        if state is None:
            continue
        unit, of = (units.get(effective(description, v, "unit")) for v in (variable, state))
        if unit is None or of is None or unit.base is None or of.base is None:
            continue
        expected = tuple(a + b for a, b in zip(of.base, per_second, strict=True))
        if unit.base != expected or not math.isclose(unit.factor, of.factor, rel_tol=1e-12):
            yield FAULT, f"{variable.name} is in {unit.name}, but its state {state.name} in {of.name}"
