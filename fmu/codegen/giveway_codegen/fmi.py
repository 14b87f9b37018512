"""modelDescription.xml for FMI 2.0 and 3.0, Co-Simulation."""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

from .table import TIME_REFERENCE, Group, Table, Value, Variable

__all__ = ["fmi2_model_description", "fmi3_model_description"]

AUTHOR = "giveway contributors"


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
        base = _attributes({symbol: str(exponent) for symbol, exponent in exponents.items()})
        lines.append(f"    <Unit name={quoteattr(name)}><BaseUnit{base}/></Unit>")
    return [*lines, "  </UnitDefinitions>"]


def _log_categories() -> list[str]:
    return [
        "  <LogCategories>",
        '    <Category name="logStatusError" description="Refused calls and values, and failures of the model"/>',
        "  </LogCategories>",
    ]


def _default_experiment(table: Table) -> str:
    pairs = {"startTime": "0.0", "stopTime": "1.0", "stepSize": _text(table.step_size)}
    return f"  <DefaultExperiment{_attributes(dict(pairs))}/>"


def _variability(group: Group) -> str:
    if group.causality == "parameter":
        return "fixed"
    return "continuous" if group.type == "real" else "discrete"


def _value_attributes(group: Group, variable: Variable) -> dict[str, str | None]:
    """Unit, range, nominal and start: the same words in both versions."""
    optional = {"min": group.minimum, "max": group.maximum, "nominal": group.nominal, "start": variable.start}
    pairs: dict[str, str | None] = {"unit": group.unit}
    pairs.update({name: None if value is None else _text(value) for name, value in optional.items()})
    return pairs


def _references(variables: list[Variable]) -> str:
    return " ".join(str(variable.reference) for variable in variables)


def fmi3_model_description(table: Table, version: str) -> str:
    """FMI 3.0; the independent variable has reference 0."""
    types = {"real": "Float64", "integer": "Int32", "boolean": "Boolean"}
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    head = {"fmiVersion": "3.0", **_header(table, version), "instantiationToken": table.token}
    lines.append(f"<fmiModelDescription{_attributes(head)}>")
    interface = {
        "modelIdentifier": f"giveway_{table.name}",
        "needsExecutionTool": "false",
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canGetAndSetFMUState": "false",
        "canHandleVariableCommunicationStepSize": "true",
        "providesIntermediateUpdate": "false",
        "hasEventMode": "false",
    }
    lines.append(f"  <CoSimulation{_attributes(dict(interface))}/>")
    lines += [*_unit_definitions(table), *_log_categories(), _default_experiment(table)]
    lines.append("  <ModelVariables>")
    lines.append(
        f'    <Float64 name="time" valueReference="{TIME_REFERENCE}" causality="independent" '
        'variability="continuous" unit="s" description="Simulated time"/>'
    )
    for group, variable in table.scalars:
        pairs = {
            "name": variable.name,
            "valueReference": str(variable.reference),
            "causality": group.causality,
            "variability": _variability(group),
            "description": group.description,
            **_value_attributes(group, variable),
        }
        lines.append(f"    <{types[group.type]}{_attributes(pairs)}/>")
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    parameters = [v for group, v in table.scalars if group.causality == "parameter"]
    initial = []
    for group, variable in table.scalars:
        if group.causality == "output":
            inputs = table.members(group.dependencies)
            unknown = f'valueReference="{variable.reference}" dependencies'
            lines.append(f'    <Output {unknown}="{_references(inputs)}"/>')
            initial.append(f'    <InitialUnknown {unknown}="{_references([*inputs, *parameters])}"/>')
    lines += initial
    lines += ["  </ModelStructure>", "</fmiModelDescription>"]
    return "\n".join(lines) + "\n"


def fmi2_model_description(table: Table, version: str) -> str:
    """FMI 2.0, without a variable for time: some importers refuse an explicit one."""
    types = {"real": "Real", "integer": "Integer", "boolean": "Boolean"}
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    head = {"fmiVersion": "2.0", **_header(table, version), "guid": table.token}
    lines.append(f"<fmiModelDescription{_attributes(head)}>")
    interface = {
        "modelIdentifier": f"giveway_{table.name}",
        "needsExecutionTool": "false",
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "false",
        "maxOutputDerivativeOrder": "0",
        "canRunAsynchronuously": "false",  # the standard's spelling
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "false",
        "canSerializeFMUstate": "false",
    }
    lines.append(f"  <CoSimulation{_attributes(dict(interface))}/>")
    lines += [*_unit_definitions(table), *_log_categories(), _default_experiment(table)]
    lines.append("  <ModelVariables>")
    indices = {variable.name: index for index, (_, variable) in enumerate(table.scalars, start=1)}

    def listed(variables: list[Variable]) -> str:
        return " ".join(str(indices[variable.name]) for variable in variables)

    for group, variable in table.scalars:
        pairs = {
            "name": variable.name,
            "valueReference": str(variable.reference),
            "causality": group.causality,
            "variability": _variability(group),
            "description": group.description,
        }
        value = _attributes(_value_attributes(group, variable))
        lines.append(f"    <ScalarVariable{_attributes(dict(pairs))}><{types[group.type]}{value}/></ScalarVariable>")
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    parameters = [v for group, v in table.scalars if group.causality == "parameter"]
    outputs, initial = [], []
    for group, variable in table.scalars:
        if group.causality == "output":
            inputs = table.members(group.dependencies)
            unknown = f'<Unknown index="{indices[variable.name]}" dependencies'
            # dependencies="" says that there are none; leaving it out would mean: all inputs.
            outputs.append(f'      {unknown}="{listed(inputs)}"/>')
            initial.append(f'      {unknown}="{listed([*inputs, *parameters])}"/>')
    if outputs:
        lines += ["    <Outputs>", *outputs, "    </Outputs>"]
        lines += ["    <InitialUnknowns>", *initial, "    </InitialUnknowns>"]
    lines += ["  </ModelStructure>", "</fmiModelDescription>"]
    return "\n".join(lines) + "\n"
