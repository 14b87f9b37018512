"""`giveway ssp`: controller and testbed as a System Structure Package (SSP 1.0), with a parameter set for each bumper.

Names, units and values come from the FMUs and their tables. SSP defines connections, but not the order of exchange: the
tools that read it (FMPy, ecos, libcosim) exchange values between steps, for both models at once, which delays the
command by one cycle compared with our order. Therefore the parameter sets reduce `electronics.command_delay` by one
cycle; the loop is then the same.

Parameters are bound twice, to the same values: at the system, where a set for the whole (``BUMPER.ssv``) names them
"testbed.NAME" and FMPy expects them, and at each component, where ecos and libcosim look (``BUMPER.MODEL.ssv``). The
system itself has no connectors, since those two refuse them. A component has no connector for an unconnected input
(plan, push), since FMPy 0.3.32 would connect it to something else; such inputs keep their start values.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from giveway.base import native
from giveway.base.errors import GivewayError, UnknownNameError
from giveway.base.files import check_file, replace_file
from giveway.experiments.motionless import SPEED_MPS
from giveway.experiments.placement import pulled_by_weight
from giveway.fmu_tools.description import Description, VariableEntry, effective, read_description
from giveway.robot.presets import PAPER, preset_values
from giveway.robot.variables import Value, table
from giveway.scenario.scenario import BUMPERS, ROBOT_BUMPERS
from giveway.simulation.master import COMMANDS, KINDS, SENSORS

if TYPE_CHECKING:
    from giveway.robot.robot_file import Robot

__all__ = ["DEFAULT_BUMPER", "parameter_set", "write_ssp"]

DEFAULT_BUMPER = "magnetic"
FMI_VERSION = 2  # SSP 1.0 does not support FMI 3
STOP_S = 1.0
_BASE = "http://ssp-standard.org/SSP1/SystemStructure"
_SSD, _SSV, _SSC = _BASE + "Description", _BASE + "ParameterValues", _BASE + "Common"
_BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_EPOCH = (1980, 1, 1, 0, 0, 0)


def write_ssp(out: Path, robot: Robot | None = None, *, sequential: bool = False) -> None:
    """Write ``out``: both FMI 2 FMUs, SystemStructure.ssd with the magnetic bumper, and a variant with each other one.
    The preset "paper" of the controller is a parameter set of its own, which nothing in the package refers to.

    Args:
        robot: instead of the robot that the FMUs were built with.
        sequential: for a tool that exchanges in our order; the command delay is not changed.
    """
    if out.suffix != ".ssp":
        raise GivewayError("--out", out, "a file that ends in .ssp")
    check_file(out)
    descriptions = {model: _description(model) for model in native.MODELS}
    files: dict[str, bytes] = {}
    for model in native.MODELS:
        files[f"resources/giveway_{model}.fmu"] = native.fmu(model, FMI_VERSION).read_bytes()
    for bumper in ROBOT_BUMPERS:
        values = parameter_set(bumper, robot, sequential=sequential)
        files[f"resources/{bumper}.ssv"] = _text(_parameter_values(bumper, values, descriptions))
        for model in _bound(values):
            own = {name: value for name, value in values.items() if name.startswith(f"{model}.")}
            files[f"resources/{bumper}.{model}.ssv"] = _text(_parameter_values(bumper, own, descriptions, local=True))
        name = "SystemStructure.ssd" if bumper == DEFAULT_BUMPER else f"{bumper}.ssd"
        files[name] = _text(_system(bumper, values, descriptions))
    paper = {f"controller.{name}": value for name, value in preset_values(PAPER).items()}
    files[f"resources/{PAPER}.controller.ssv"] = _text(_parameter_values(PAPER, paper, descriptions, local=True))
    with replace_file(out) as temporary, zipfile.ZipFile(temporary, "w") as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.create_system, entry.external_attr, entry.compress_type = 3, 0o100644 << 16, zipfile.ZIP_DEFLATED
            archive.writestr(entry, files[name])


def parameter_set(bumper: str, robot: Robot | None = None, *, sequential: bool = False) -> dict[str, Value]:
    """Parameters of the testbed with ``bumper``, by "model.name"; with ``robot`` also all values of that robot.

    The slider hits that robot as in the experiment "motionless".
    """
    testbed = table("testbed")
    if bumper not in BUMPERS:
        raise UnknownNameError("bumper", bumper, BUMPERS)
    values: dict[str, Value] = {}
    if robot is not None:
        for model in native.MODELS:
            values |= {f"{model}.{name}": value for name, value in table(model).robot_values(robot).items()}
        placed = pulled_by_weight("motionless", robot.path, SPEED_MPS)
        values |= {f"testbed.{name}": value for name, value in placed.items()}
    for variable in testbed.select("parameter"):
        if variable.name.startswith("bumper.") and variable.start is not None:
            values.setdefault(f"testbed.{variable.name}", variable.start)
    values["testbed.bumper.kind"] = BUMPERS[bumper]
    delay = "testbed.electronics.command_delay"
    cycles = values.get(delay, testbed["electronics.command_delay"].start)
    assert cycles is not None
    if not sequential and cycles < 1:
        allowed = "at least 1 cycle: one is taken out for tools that exchange between steps (or use --sequential)"
        raise GivewayError("electronics.command_delay", cycles, allowed)
    values[delay] = cycles if sequential else cycles - 1
    return values


def _description(model: str) -> Description:
    with zipfile.ZipFile(native.fmu(model, FMI_VERSION)) as archive:
        return read_description(archive.read("modelDescription.xml"))


def _text(root: Any) -> bytes:
    from lxml import etree

    text = etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)
    assert isinstance(text, bytes)
    return text


def _add(parent: Any, namespace: str, tag: str, **attributes: str) -> Any:
    from lxml import etree

    return etree.SubElement(parent, f"{{{namespace}}}{tag}", attributes)


def _root(namespace: str, prefix: str, tag: str, name: str) -> Any:
    from lxml import etree

    names = {prefix: namespace, "ssc": _SSC}
    attributes = {"name": name, "version": "1.0", "generationTool": "giveway"}
    return etree.Element(f"{{{namespace}}}{tag}", attributes, nsmap=names)


def _units(root: Any, namespace: str, used: Iterable[str], descriptions: Mapping[str, Description]) -> None:
    """The definitions of ``used`` from the FMUs."""
    defined = {unit.name: unit for description in descriptions.values() for unit in description.units}
    units = _add(root, namespace, "Units")
    for name in sorted(set(used)):
        base = defined[name].base or (0,) * len(_BASE_UNITS)
        exponents = {symbol: str(n) for symbol, n in zip(_BASE_UNITS, base, strict=True) if n != 0}
        _add(_add(units, _SSC, "Unit", name=name), _SSC, "BaseUnit", **exponents)


def _bound(values: Mapping[str, Value]) -> list[str]:
    """The models that ``values`` has parameters of."""
    return [model for model in native.MODELS if any(name.startswith(f"{model}.") for name in values)]


def _parameter_values(
    bumper: str, values: Mapping[str, Value], descriptions: Mapping[str, Description], *, local: bool = False
) -> Any:
    """The parameter set; ``local``: of one component, whose name is left out."""
    root = _root(_SSV, "ssv", "ParameterSet", bumper)
    parameters = _add(root, _SSV, "Parameters")
    used = []
    for name, value in values.items():
        model, _, variable = name.partition(".")
        entry = descriptions[model].by_name[variable]
        attributes = {"value": str(value).lower() if isinstance(value, bool) else repr(value)}
        if unit := effective(descriptions[model], entry, "unit"):
            attributes["unit"] = unit
            used.append(unit)
        _add(_add(parameters, _SSV, "Parameter", name=variable if local else name), _SSV, entry.type, **attributes)
    _units(root, _SSV, used, descriptions)
    return root


def _system(bumper: str, values: Mapping[str, Value], descriptions: Mapping[str, Description]) -> Any:
    root = _root(_SSD, "ssd", "SystemStructureDescription", "giveway")
    system = _add(root, _SSD, "System", name="giveway", description=f"Omnidirectional base with {bumper} bumper")
    _bind(system, f"{bumper}.ssv")
    elements = _add(system, _SSD, "Elements")
    used: set[str] = set()
    for model, description in descriptions.items():
        used |= _component(elements, model, description, bumper, values)
    connections = _add(system, _SSD, "Connections")
    for source, sink, passed in (("testbed", "controller", SENSORS), ("controller", "testbed", COMMANDS)):
        for kind in KINDS:
            for name in passed[kind]:
                ends = {"startElement": source, "startConnector": name, "endElement": sink, "endConnector": name}
                _add(connections, _SSD, "Connection", **ends)
    _units(root, _SSD, used, descriptions)
    _add(root, _SSD, "DefaultExperiment", startTime="0.0", stopTime=repr(STOP_S))
    return root


def _bind(element: Any, file: str) -> None:
    binding = _add(_add(element, _SSD, "ParameterBindings"), _SSD, "ParameterBinding", source=f"resources/{file}")
    binding.set("type", "application/x-ssp-parameter-set")


def _component(
    elements: Any, model: str, description: Description, bumper: str, values: Mapping[str, Value]
) -> set[str]:
    """One FMU with its inputs, outputs and the parameters that are bound; the units it uses."""
    kind = "application/x-fmu-sharedlibrary"
    component = _add(elements, _SSD, "Component", name=model, source=f"resources/giveway_{model}.fmu", type=kind)
    connectors = _add(component, _SSD, "Connectors")
    used = set()
    received = {name for passed in (SENSORS, COMMANDS) for kind in KINDS for name in passed[kind]}
    for entry in description.variables:
        connected = entry.causality == "output" or (entry.causality == "input" and entry.name in received)
        bound = entry.causality == "parameter" and f"{model}.{entry.name}" in values
        if connected or bound:
            unit = effective(description, entry, "unit")
            _connector(connectors, entry, entry.causality, unit)
            used.add(unit)
    if model in _bound(values):
        _bind(component, f"{bumper}.{model}.ssv")
    return used - {""}


def _connector(connectors: Any, entry: VariableEntry, kind: str, unit: str) -> None:
    connector = _add(connectors, _SSD, "Connector", name=entry.name, kind=kind)
    _add(connector, _SSC, entry.type, **({"unit": unit} if unit else {}))
