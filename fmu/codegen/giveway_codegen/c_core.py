"""C++: the variables of a model of c_core <-> the configuration, input and output of its module."""

from __future__ import annotations

from .table import RETURNED, Group, Table

__all__ = ["members_header"]


def _copies(groups: list[Group], source: str, target: str) -> str:
    """One assignment for each group; ``source`` and ``target`` are formats of a group's variable and member."""
    lines = []
    for group in groups:
        if group.c_core == RETURNED:
            continue
        variable = group.identifier if group.count is None else f"{group.identifier}[i]"
        names = {"variable": variable, "member": group.c_core}
        copy = f"assign({target.format(**names)}, {source.format(**names)});"
        if group.count is None:
            lines.append(f"    {copy}")
        else:
            lines.append(f"    for (std::size_t i = 0; i < {group.count}; ++i) {{\n        {copy}\n    }}")
    return "\n".join(lines)


def members_header(table: Table) -> str:
    """How the structs of c_core get and give the values of the variables."""
    module = table.c_core
    of = {
        causality: [group for group in table.groups if group.causality == causality]
        for causality in ("parameter", "input", "output")
    }
    read = ("v.{variable}", "c.{member}")
    return f"""// Generated from the variable table of {table.name}; do not edit.
#pragma once

#include <cstddef>

#include "giveway/{module}.h"
#include "{table.name}_variables.hpp"

namespace giveway::{table.name} {{

// A real is rounded to the library's real type. A negative count becomes a huge one, which the library refuses.
template <class To, class From> void assign(To& to, const From& from) {{ to = static_cast<To>(from); }}

inline {module}_config_t configuration(const Variables& v) {{
    {module}_config_t c{{}};
{_copies(of["parameter"], *read)}
    return c;
}}

inline {module}_input_t inputs(const Variables& v) {{
    {module}_input_t c{{}};
{_copies(of["input"], *read)}
    return c;
}}

// All outputs but that which a step returns.
inline void write_outputs(const {module}_output_t& c, Variables& v) {{
{_copies(of["output"], "c.{member}", "v.{variable}")}
}}

}} // namespace giveway::{table.name}
"""
