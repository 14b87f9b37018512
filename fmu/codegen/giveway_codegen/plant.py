"""C++: the plant's parameters from the variable tables, and the code that assigns their values."""

from __future__ import annotations

from .errors import TableError
from .table import Group, Table

__all__ = ["parameters_header", "reader_header"]

_TYPES = {"number": "T", "wheels": "T", "divisor": "math::Divisor<T>", "whole": "std::int32_t"}


def _member(group: Group) -> str:
    element = _TYPES.get(group.plant or "", group.plant)
    count = "Wheels" if group.plant == "wheels" else group.count
    kind = element if count is None else f"std::array<{element}, {count}>"
    unit = f" [{group.unit}]" if group.unit else ""
    return f"    {kind} {group.identifier}; // {group.description}{unit}"


def _enumeration(group: Group) -> str:
    names = ", ".join(f"{name} = {number}" for number, name in enumerate(group.choices))
    return f"enum class {group.plant} : std::uint8_t {{ {names} }};"


def parameters_header(table: Table) -> str:
    """The struct of all plant parameters of the testbed's table, and a walk over them."""
    groups = table.plant_parameters
    enumerations = "\n".join(_enumeration(group) for group in groups if group.choices)
    members = "\n".join(_member(group) for group in groups)
    wheels = {group.count or 0 for group in groups if group.plant == "wheels"}
    if len(wheels) > 1:
        raise TableError(f'{table.name}: plant = "wheels" with counts {sorted(wheels)}: a robot has one')
    visits = "\n".join(f'    visit("{group.identifier}", structs.{group.identifier}...);' for group in groups)
    return f"""// Generated from the variable table of {table.name}; do not edit.
#pragma once

#include <array>
#include <cstdint>

#include "scalar.hpp"

namespace giveway::plant {{

{enumerations}

// Of the robot that the table describes.
inline constexpr int table_wheels = {max(wheels, default=0)};

// SI units.
template <class T, int Wheels = table_wheels> struct TableParameters {{
{members}
}};

// visit(name, member of each struct ...) for one parameter after the other.
template <class Visitor, class... Structs> constexpr void visit_parameters(Visitor&& visit, Structs&... structs) {{
{visits}
}}

}} // namespace giveway::plant
"""


def _assignment(group: Group) -> str:
    name = group.identifier
    if group.count is not None:
        return f"    std::copy_n(v.{name}, p.{name}.size(), p.{name}.begin());"
    if group.plant in ("number", "divisor"):
        return f"    p.{name} = v.{name};"
    target = _TYPES.get(group.plant or "", f"plant::{group.plant}")
    return f"    p.{name} = static_cast<{target}>(v.{name});"


def reader_header(table: Table) -> str:
    """Code that copies a model's variables to the plant parameters in its table."""
    lines = "\n".join(_assignment(group) for group in table.plant_parameters)
    return f"""// Generated from the variable table of {table.name}; do not edit.
#pragma once

#include <algorithm>
#include <cstdint>

#include "plant_parameters.hpp"
#include "{table.name}_variables.hpp"

namespace giveway::{table.name} {{

// Those that this table does not have keep their values.
inline void read_plant_parameters(const Variables& v, plant::TableParameters<double>& p) {{
{lines}
}}

}} // namespace giveway::{table.name}
"""
