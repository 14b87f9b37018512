"""C++: the Variables struct, its start values, the table that variables are looked up in, and an FMU's entry."""

from __future__ import annotations

from .table import Group, Table, Value

__all__ = ["fmu_entry", "header", "source"]

_CPP_TYPES = {"real": "double", "integer": "std::int32_t", "boolean": "bool"}


def _declaration(group: Group) -> str:
    size = "" if group.count is None else f"[{group.count}]"
    unit = f" [{group.unit}]" if group.unit else ""
    return f"    {_CPP_TYPES[group.type]} {group.identifier}{size}; // {group.description}{unit}"


# Variables for an importer that integrates; the shell fills them on request.
_LOCAL_MEMBERS = {"state": "states", "derivative": "derivatives", "indicator": "indicators"}


def _members(table: Table) -> list[str]:
    lines = [_declaration(group) for group in table.groups if group.role is None]
    for role, member in _LOCAL_MEMBERS.items():
        count = len(table.with_role(role))
        if count:
            lines.append(f"    double {member}[{count}];")
    return lines


def header(table: Table) -> str:
    members = "\n".join(_members(table))
    return f"""// Generated from the variable table of {table.name}; do not edit.
#pragma once

#include <cstdint>

namespace giveway {{
class Model;
struct ModelInfo;
}} // namespace giveway

namespace giveway::{table.name} {{

// Plain data: a copy is a checkpoint. Inputs and parameters are written by the importer.
struct Variables {{
{members}
}};

// Everything zero, then the start values of the inputs and parameters.
void set_start_values(Variables &variables);

const ModelInfo &model_info();

// Defined by the model itself; nullptr when out of memory.
Model *create_model();

}} // namespace giveway::{table.name}
"""


def _literal(value: Value) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        # -2147483648 is not a literal in C++
        return str(value) if value != -(2**31) else "(-2147483647 - 1)"
    return repr(value)


def _bound(value: Value | None, infinity: str) -> str:
    return infinity if value is None else repr(float(value))


def source(table: Table) -> str:
    starts: list[str] = []
    rows: dict[int, str] = {}  # by reference
    for group in table.groups:
        for index, variable in enumerate(group.variables):
            if group.role is not None:
                continue
            member = group.identifier if group.count is None else f"{group.identifier}[{index}]"
            # -0.0 == 0, but Variables{} holds +0.0
            if variable.start is not None and (variable.start != 0 or str(variable.start).startswith("-")):
                starts.append(f"    variables.{member} = {_literal(variable.start)};")
            offset = f"offsetof(Variables, {group.identifier})"
            if index:
                offset += f" + {index} * sizeof({_CPP_TYPES[group.type]})"
            rows[variable.reference] = (
                f'    {{{variable.reference}u, "{variable.name}", VariableType::{group.type}, '
                f"Causality::{group.causality}, {_bound(group.minimum, '-infinity')}, "
                f"{_bound(group.maximum, 'infinity')}, {offset}, {str(group.allow_nonfinite).lower()}}},"
            )
    for role, member in _LOCAL_MEMBERS.items():
        for index, (_, variable) in enumerate(table.with_role(role)):
            offset = f"offsetof(Variables, {member}) + {index} * sizeof(double)"
            rows[variable.reference] = (
                f'    {{{variable.reference}u, "{variable.name}", VariableType::real, Causality::local, '
                f"-infinity, infinity, {offset}, false}},"
            )
    start_lines = "\n".join(starts)
    row_lines = "\n".join(row for _, row in sorted(rows.items()))
    states = table.with_role("state")
    nominals = ", ".join(repr(group.nominal) for group, _ in states)
    nominal_table = f"constexpr double state_nominals[] = {{{nominals}}};\n\n" if states else ""
    layout = ", ".join(
        f"offsetof(Variables, {member})" if table.with_role(role) else "0" for role, member in _LOCAL_MEMBERS.items()
    )
    nominal_member = "state_nominals" if states else "nullptr"
    equations = f"{nominal_member}, {len(states)}, {len(table.with_role('indicator'))}, {layout}"
    return f"""// Generated from the variable table of {table.name}; do not edit.
#include "{table.name}_variables.hpp"

#include "model.hpp"

#include <cstddef>
#include <limits>

namespace giveway {{
namespace {{

using {table.name}::Variables;

constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr VariableInfo variable_infos[] = {{
{row_lines}
}};

{nominal_table}constexpr ModelInfo info = {{"{table.name}", "{table.token}", variable_infos, {len(rows)}, {equations}}};

}} // namespace

const ModelInfo &{table.name}::model_info() {{ return info; }}

void {table.name}::set_start_values(Variables &variables) {{
    variables = Variables{{}};
{start_lines}
}}

}} // namespace giveway
"""


def fmu_entry(table: Table) -> str:
    return f"""// Generated from the variable table of {table.name}; do not edit.
// The one model that the shell of this FMU binary calls.
#include "{table.name}_variables.hpp"

#include "model.hpp"

namespace giveway {{

const ModelInfo &model_info() {{ return {table.name}::model_info(); }}

Model *create_model() {{ return {table.name}::create_model(); }}

}} // namespace giveway
"""
