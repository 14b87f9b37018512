"""modelDescription.xml for FMI 2.0 and 3.0: Co-Simulation and, for models with states, Model Exchange."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from xml.sax.saxutils import quoteattr

from .table import TIME_REFERENCE, Group, Table, Value, Variable
from .types import Quantity
from .units import DISPLAY_UNITS

__all__ = ["fmi2_model_description", "fmi3_model_description"]

AUTHOR = "giveway contributors"
_TOLERANCE = 1e-6  # for an importer's solver: our own relative tolerance (solver.relative_tolerance)


def _text(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value)


def _attributes(pairs: dict[str, str | None]) -> str:
    return "".join(f" {name}={quoteattr(value)}" for name, value in pairs.items() if value is not None)


def _header(table: Table, version: str) -> dict[str, str | None]:
    return {
        "modelName": f"giveway {table.name}",
        "description": table.description,
        "author": AUTHOR,
        "version": version,
        "copyright": f"Copyright (c) {AUTHOR}",
        "license": "MIT",
        "generationTool": f"giveway {version}",
        "variableNamingConvention": "structured",
    }


def _unit_definitions(table: Table) -> list[str]:
    lines = ["  <UnitDefinitions>"]
    for name, exponents in table.units.items():
        base = _attributes({**{symbol: str(exponent) for symbol, exponent in exponents.items()}, "factor": "1.0"})
        lines.append(f"    <Unit name={quoteattr(name)}>")
        lines.append(f"      <BaseUnit{base}/>")
        for display, (factor, offset) in DISPLAY_UNITS.get(name, {}).items():
            pairs = {"name": display, "factor": repr(factor), "offset": repr(offset) if offset else None}
            lines.append(f"      <DisplayUnit{_attributes(pairs)}/>")
        lines.append("    </Unit>")
    return [*lines, "  </UnitDefinitions>"]


def _type_attributes(quantity: Quantity) -> dict[str, str | None]:
    """Attributes of a quantity's type definition besides name and description: the same in both versions."""
    numbers = {"min": quantity.minimum, "nominal": quantity.nominal}
    return {
        "quantity": quantity.quantity,
        "unit": quantity.unit,
        "displayUnit": quantity.display_unit,
        **{name: None if number is None else _text(number) for name, number in numbers.items()},
    }


def _type_definitions(table: Table, fmi: int, types: dict[str, str]) -> list[str]:
    lines = ["  <TypeDefinitions>"]
    for quantity in table.quantities:
        own = {"name": quantity.name, "description": quantity.description}
        values, tag = _type_attributes(quantity), types[quantity.kind]
        if fmi == 3:
            lines.append(f"    <{tag}Type{_attributes({**own, **values})}/>")
        else:
            lines.append(f"    <SimpleType{_attributes(dict(own))}><{tag}{_attributes(values)}/></SimpleType>")
    return [*lines, "  </TypeDefinitions>"]


def _log_categories() -> list[str]:
    return [
        "  <LogCategories>",
        '    <Category name="logStatusError" description="Refused calls and values, and failures of the model"/>',
        "  </LogCategories>",
    ]


def _default_experiment(table: Table) -> str:
    pairs = {"startTime": "0.0", "stopTime": "1.0"}
    if table.has_equations:
        pairs["tolerance"] = _text(_TOLERANCE)
    pairs["stepSize"] = _text(table.step_size)
    return f"  <DefaultExperiment{_attributes(dict(pairs))}/>"


def _description(table: Table, group: Group, variable: Variable) -> dict[str, str | None]:
    """Attributes of a variable that are the same in both versions."""
    return {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "causality": group.causality,
        "variability": _variability(group),
        "initial": "calculated" if group.role in ("state", "derivative") else None,
        "description": group.description,
    }


def _initial(table: Table, group: Group) -> list[Variable] | None:
    """What ``group`` depends on at the start: inputs that act at once, and parameters. None: it is not an unknown."""
    if group.causality != "output" and group.role not in ("state", "derivative"):
        return None
    at_once = group.dependencies or ()
    inputs = [v for other, v in table.scalars if other.causality == "input" and other.name in at_once]
    return [*inputs, *(v for other, v in table.scalars if other.causality == "parameter")]


def _variability(group: Group) -> str:
    if group.causality == "parameter":
        return "fixed"
    return "continuous" if group.type == "real" else "discrete"


def _value_attributes(group: Group, variable: Variable) -> dict[str, str | None]:
    """Type, unit, range, nominal and start: the same attributes in both versions.

    Unit, display unit and nominal value are given only in the type: an importer's parser fails on a repetition.
    """
    optional = {"min": group.minimum, "max": group.maximum, "nominal": group.size, "start": variable.start}
    pairs: dict[str, str | None] = {"unit": group.unit, "displayUnit": group.display_unit}
    pairs.update({name: None if value is None else _text(value) for name, value in optional.items()})
    if group.quantity is None:
        return pairs
    said = _type_attributes(group.quantity)
    own = {n: None if n in ("unit", "displayUnit", "nominal") and v == said[n] else v for n, v in pairs.items()}
    return {"declaredType": group.quantity.name, **own}


def _references(variables: list[Variable]) -> str:
    return " ".join(str(variable.reference) for variable in variables)


def fmi3_model_description(table: Table, version: str) -> str:
    """FMI 3.0; the independent variable has reference 0."""
    types = {"real": "Float64", "integer": "Int32", "boolean": "Boolean"}
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    head = {"fmiVersion": "3.0", **_header(table, version), "instantiationToken": table.token}
    lines.append(f"<fmiModelDescription{_attributes(head)}>")
    common = {
        "modelIdentifier": f"giveway_{table.name}",
        "needsExecutionTool": "false",
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
    }
    if table.has_equations:
        exchange = {**common, "needsCompletedIntegratorStep": "true", "providesEvaluateDiscreteStates": "false"}
        lines.append(f"  <ModelExchange{_attributes(dict(exchange))}/>")
    simulation = {
        **common,
        "canHandleVariableCommunicationStepSize": "true",
        "providesIntermediateUpdate": "false",
        "hasEventMode": "false",
    }
    lines.append(f"  <CoSimulation{_attributes(dict(simulation))}/>")
    lines += [*_unit_definitions(table), *_type_definitions(table, 3, types), *_log_categories()]
    lines += [_default_experiment(table), "  <ModelVariables>"]
    lines.append(
        f'    <Float64 name="time" valueReference="{TIME_REFERENCE}" causality="independent" '
        'variability="continuous" unit="s" description="Simulated time"/>'
    )
    states = [variable for _, variable in table.with_role("state")]
    derivatives = table.with_role("derivative")
    of = dict(zip((v.reference for _, v in derivatives), (v.reference for v in states), strict=True))
    for group, variable in table.scalars:
        derivative = of.get(variable.reference)
        pairs = {
            **_description(table, group, variable),
            **_value_attributes(group, variable),
            "derivative": None if derivative is None else str(derivative),
        }
        lines.append(f"    <{types[group.type]}{_attributes(pairs)}/>")
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    outputs = [(group, v) for group, v in table.scalars if group.causality == "output"]
    for tag, unknowns in (("Output", outputs), ("ContinuousStateDerivative", derivatives)):
        for group, variable in unknowns:
            known = _references(table.followed(group))
            lines.append(f'    <{tag} valueReference="{variable.reference}" dependencies="{known}"/>')
    for group, variable in table.scalars:
        start = _initial(table, group)
        if start is not None:
            known = _references(start)
            lines.append(f'    <InitialUnknown valueReference="{variable.reference}" dependencies="{known}"/>')
    lines += [f'    <EventIndicator valueReference="{v.reference}"/>' for _, v in table.with_role("indicator")]
    lines += ["  </ModelStructure>", "</fmiModelDescription>"]
    return "\n".join(lines) + "\n"


def _interface(tag: str, attributes: Mapping[str, str], sources: Sequence[str]) -> list[str]:
    head = f"  <{tag}{_attributes(dict(attributes))}"
    if not sources:
        return [f"{head}/>"]
    files = [f"      <File name={quoteattr(name)}/>" for name in sources]
    return [f"{head}>", "    <SourceFiles>", *files, "    </SourceFiles>", f"  </{tag}>"]


def fmi2_model_description(table: Table, version: str, sources: Sequence[str] = ()) -> str:
    """FMI 2.0, without a variable for time: some importers refuse an explicit one. ``sources``: the files to
    compile."""
    types = {"real": "Real", "integer": "Integer", "boolean": "Boolean"}
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    head = {"fmiVersion": "2.0", **_header(table, version), "guid": table.token}
    if table.has_equations:
        head["numberOfEventIndicators"] = str(len(table.with_role("indicator")))
    lines.append(f"<fmiModelDescription{_attributes(head)}>")
    identifier = {"modelIdentifier": f"giveway_{table.name}", "needsExecutionTool": "false"}
    common = {
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
    }
    if table.has_equations:
        exchange = {**identifier, "completedIntegratorStepNotNeeded": "false", **common}
        lines += _interface("ModelExchange", exchange, sources)
    simulation = {
        **identifier,
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "false",
        "maxOutputDerivativeOrder": "0",
        "canRunAsynchronuously": "false",  # the standard's spelling
        **common,
    }
    lines += _interface("CoSimulation", simulation, sources)
    lines += [*_unit_definitions(table), *_type_definitions(table, 2, types), *_log_categories()]
    lines += [_default_experiment(table), "  <ModelVariables>"]
    indices = {variable.name: index for index, (_, variable) in enumerate(table.scalars, start=1)}

    def listed(variables: list[Variable]) -> str:
        return " ".join(str(indices[variable.name]) for variable in variables)

    states = [variable for _, variable in table.with_role("state")]
    derivatives = table.with_role("derivative")
    of = dict(zip((v.name for _, v in derivatives), (indices[v.name] for v in states), strict=True))
    for group, variable in table.scalars:
        derivative = of.get(variable.name)
        pairs = {**_value_attributes(group, variable), "derivative": None if derivative is None else str(derivative)}
        value = f"<{types[group.type]}{_attributes(pairs)}/>"
        attributes = _attributes(_description(table, group, variable))
        lines.append(f"    <ScalarVariable{attributes}>{value}</ScalarVariable>")
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    outputs = [(group, v) for group, v in table.scalars if group.causality == "output"]
    initial = [(group, v) for group, v in table.scalars if _initial(table, group) is not None]
    sections = {
        # dependencies="" means that there are none; without the attribute it would mean all.
        "Outputs": [(v, table.followed(group)) for group, v in outputs],
        "Derivatives": [(v, table.followed(group)) for group, v in derivatives],
        "InitialUnknowns": [(v, _initial(table, group) or []) for group, v in initial],
    }
    for section, unknowns in sections.items():
        if unknowns:
            lines.append(f"    <{section}>")
            for variable, known in unknowns:
                lines.append(f'      <Unknown index="{indices[variable.name]}" dependencies="{listed(known)}"/>')
            lines.append(f"    </{section}>")
    lines += ["  </ModelStructure>", "</fmiModelDescription>"]
    return "\n".join(lines) + "\n"
