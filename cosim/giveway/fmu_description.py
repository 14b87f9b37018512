"""A model description of FMI 2 or 3 as plain data, read so forgivingly that a checker can say what is wrong with it.

FMPy's own reader raises on the first fault; this one keeps what is there as text.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Description", "Unit", "Unknown", "VariableEntry", "read_description"]

_FMI2_TYPES = ("Real", "Integer", "Boolean", "String", "Enumeration")
_INTERFACES = ("ModelExchange", "CoSimulation", "ScheduledExecution")
_BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True)
class Unit:
    """Exponents of the base units, factor and offset; ``base`` is None if the file has none."""

    name: str
    base: tuple[int, ...] | None
    factor: float
    offset: float
    display_units: tuple[str, ...]


@dataclass(frozen=True)
class VariableEntry:
    """One variable as the file has it; attributes that are missing are empty texts.

    Attributes:
        index: position in ModelVariables, from 1.
        type: "Real", "Float64", ...
        attributes: of the variable, FMI 2's type element included; start, min and max as text.
    """

    index: int
    name: str
    reference: int
    type: str
    attributes: Mapping[str, str]

    def get(self, name: str) -> str:
        return self.attributes.get(name, "")

    @property
    def causality(self) -> str:
        return self.get("causality") or "local"

    @property
    def variability(self) -> str:
        continuous = self.type in ("Real", "Float32", "Float64")
        return self.get("variability") or ("continuous" if continuous else "discrete")

    @property
    def initial(self) -> str:
        """As written, else the standard's default for this causality and variability."""
        if self.get("initial"):
            return self.get("initial")
        if self.causality in ("input", "independent"):
            return ""
        if self.causality in ("parameter", "structuralParameter") or self.variability == "constant":
            return "exact"
        return "calculated"


@dataclass(frozen=True)
class Unknown:
    """One line of ModelStructure; ``key`` is FMI 2's index or FMI 3's reference, as are the dependencies."""

    key: int
    dependencies: tuple[int, ...] | None
    kinds: tuple[str, ...] | None


@dataclass(frozen=True)
class Description:
    """What a modelDescription.xml says."""

    version: int
    attributes: Mapping[str, str]
    interfaces: Mapping[str, Mapping[str, str]]
    source_files: Mapping[str, tuple[str, ...]]  # FMI 2, per interface
    units: tuple[Unit, ...]
    types: Mapping[str, Mapping[str, str]]
    experiment: Mapping[str, str]
    variables: tuple[VariableEntry, ...]
    outputs: tuple[Unknown, ...]
    derivatives: tuple[Unknown, ...]
    initial_unknowns: tuple[Unknown, ...]
    indicators: tuple[Unknown, ...]
    by_name: Mapping[str, VariableEntry] = field(default_factory=dict)

    def key(self, variable: VariableEntry) -> int:
        """What ModelStructure calls ``variable``."""
        return variable.index if self.version == 2 else variable.reference

    @property
    def token(self) -> str:
        return self.attributes.get("guid" if self.version == 2 else "instantiationToken", "")


def read_description(root: Any) -> Description:
    """From the root element of a modelDescription.xml (lxml)."""
    version = int((root.get("fmiVersion") or "0")[0])
    variables = tuple(_variables(root, version))
    structure = root.find("ModelStructure")
    if version == 2:
        sections = {tag: structure.iterfind(f"{tag}/Unknown") for tag in ("Outputs", "Derivatives", "InitialUnknowns")}
        found = {tag: tuple(_unknown(e, "index") for e in entries) for tag, entries in sections.items()}
        outputs, derivatives, initial = found["Outputs"], found["Derivatives"], found["InitialUnknowns"]
        indicators: tuple[Unknown, ...] = ()
    else:
        tags = ("Output", "ContinuousStateDerivative", "InitialUnknown", "EventIndicator")
        outputs, derivatives, initial, indicators = (
            tuple(_unknown(e, "valueReference") for e in structure.iterfind(tag)) for tag in tags
        )
    elements = {tag: root.find(tag) for tag in _INTERFACES}
    experiment = root.find("DefaultExperiment")
    return Description(
        version=version,
        attributes=dict(root.attrib),
        interfaces={tag: dict(e.attrib) for tag, e in elements.items() if e is not None},
        source_files={
            tag: tuple(f.get("name", "") for f in e.iterfind("SourceFiles/File"))
            for tag, e in elements.items()
            if e is not None
        },
        units=tuple(_unit(e) for e in root.iterfind("UnitDefinitions/Unit")),
        types=dict(_types(root)),
        experiment={} if experiment is None else dict(experiment.attrib),
        variables=variables,
        outputs=outputs,
        derivatives=derivatives,
        initial_unknowns=initial,
        indicators=indicators,
        by_name={variable.name: variable for variable in variables},
    )


def _variables(root: Any, version: int) -> list[VariableEntry]:
    found = []
    for index, element in enumerate(root.find("ModelVariables").iterchildren("*"), start=1):
        attributes = dict(element.attrib)
        kind = element.tag
        if version == 2:
            inner = next((child for child in element.iterchildren("*") if child.tag in _FMI2_TYPES), None)
            if inner is not None:
                kind = inner.tag
                attributes |= dict(inner.attrib)
        reference = int(attributes.get("valueReference", "-1"))
        found.append(VariableEntry(index, attributes.get("name", ""), reference, kind, attributes))
    return found


def _unknown(element: Any, key: str) -> Unknown:
    dependencies, kinds = element.get("dependencies"), element.get("dependenciesKind")
    return Unknown(
        key=int(element.get(key, "-1")),
        dependencies=None if dependencies is None else tuple(int(word) for word in dependencies.split()),
        kinds=None if kinds is None else tuple(kinds.split()),
    )


def _unit(element: Any) -> Unit:
    base = element.find("BaseUnit")
    return Unit(
        name=element.get("name", ""),
        base=None if base is None else tuple(int(base.get(symbol, "0")) for symbol in _BASE_UNITS),
        factor=1.0 if base is None else float(base.get("factor", "1")),
        offset=0.0 if base is None else float(base.get("offset", "0")),
        display_units=tuple(e.get("name", "") for e in element.iterfind("DisplayUnit")),
    )


def _types(root: Any) -> list[tuple[str, Mapping[str, str]]]:
    found: list[tuple[str, Mapping[str, str]]] = []
    for element in root.iterfind("TypeDefinitions/*"):
        attributes = dict(element.attrib)
        for child in element.iterchildren("*"):
            attributes |= dict(child.attrib)
        found.append((element.get("name", ""), attributes))
    return found
