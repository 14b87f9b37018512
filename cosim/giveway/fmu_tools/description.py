"""A model description of FMI 2 or 3 as plain data, read tolerantly, so that a checker can report its faults.

It is read as a stream, without a tree, so a file of some tens of MB does not need hundreds. FMPy's reader raises on the
first fault; this one keeps all values as text, and lists invalid numbers.
"""

from __future__ import annotations

import math
import re
import sys
from array import array
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from giveway.fmu_tools.limits import Limits
from giveway.fmu_tools.xml_files import Budget, XmlError, read_xml

__all__ = [
    "INTERFACE_NAMES",
    "REALS",
    "Description",
    "Unit",
    "Unknown",
    "VariableEntry",
    "VersionError",
    "effective",
    "read_description",
]

REALS = ("Real", "Float32", "Float64")
INTERFACE_NAMES = {
    "CoSimulation": "Co-Simulation",
    "ModelExchange": "Model Exchange",
    "ScheduledExecution": "Scheduled Execution",
}
_FMI2_TYPES = ("Real", "Integer", "Boolean", "String", "Enumeration")
_FMI3_SECTIONS = ("Output", "ContinuousStateDerivative", "InitialUnknown", "EventIndicator", "ClockedState")
_FMI2_SECTIONS = {"Outputs": "Output", "Derivatives": "ContinuousStateDerivative", "InitialUnknowns": "InitialUnknown"}
_BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_ROOT = "fmiModelDescription"
_MOST_PROBLEMS = 100
_NONE = -1  # an invalid reference or index


class VersionError(XmlError):
    """A model description of another FMI version; ``version`` as in the file."""

    def __init__(self, version: str) -> None:
        super().__init__(f"it is FMI {version!r}")
        self.version = version


@dataclass(frozen=True)
class Unit:
    """Exponents of the base units, and factor; ``base`` is None if the file has none."""

    name: str
    base: tuple[int, ...] | None
    factor: float
    display_units: frozenset[str]


@dataclass(frozen=True, slots=True)
class VariableEntry:
    """One variable as in the file; missing attributes are empty texts.

    Attributes:
        index: position in ModelVariables, from 1.
        type: "Real", "Float64", ...
        attributes: of the variable, FMI 2's type element included; start, min and max as text.
        is_array: it has dimensions.
        aliases: other names of it (FMI 3).
    """

    index: int
    name: str
    reference: int
    type: str
    attributes: Mapping[str, str]
    is_array: bool = False
    aliases: tuple[str, ...] = ()

    def get(self, name: str) -> str:
        return self.attributes.get(name, "")

    @property
    def causality(self) -> str:
        return self.get("causality") or "local"

    @property
    def variability(self) -> str:
        if self.get("variability"):
            return self.get("variability")
        if self.causality in ("parameter", "calculatedParameter", "structuralParameter"):
            return "fixed"
        return "continuous" if self.type in REALS else "discrete"

    @property
    def initial(self) -> str:
        """As in the file, or the standard's default for this causality and variability."""
        if self.get("initial"):
            return self.get("initial")
        if self.causality in ("input", "independent"):
            return ""
        if self.causality in ("parameter", "structuralParameter") or self.variability == "constant":
            return "exact"
        return "calculated"

    @property
    def is_clocked(self) -> bool:
        """Whether it changes only with clocks, or is a clock."""
        return self.type == "Clock" or bool(self.get("clocks"))


@dataclass(frozen=True, slots=True)
class Unknown:
    """One line of ModelStructure; ``key`` is FMI 2's index or FMI 3's reference, as are the dependencies."""

    key: int
    dependencies: Sequence[int] | None
    kinds: tuple[str, ...] | None


@dataclass(frozen=True)
class Description:
    """The content of a modelDescription.xml.

    Attributes:
        problems: values that should be numbers but are not, with the line; they are read as -1.
    """

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
    clocked_states: tuple[Unknown, ...] = ()
    problems: tuple[str, ...] = ()
    by_name: Mapping[str, VariableEntry] = field(default_factory=dict)

    def key(self, variable: VariableEntry) -> int:
        """The key of ``variable`` in ModelStructure."""
        return variable.index if self.version == 2 else variable.reference

    @property
    def token(self) -> str:
        return self.attributes.get("guid" if self.version == 2 else "instantiationToken", "")


def effective(description: Description, variable: VariableEntry, name: str) -> str:
    """An attribute of the variable, or else of its declared type."""
    return variable.get(name) or description.types.get(variable.get("declaredType"), {}).get(name, "")


def read_description(content: bytes | Iterable[bytes], budget: Budget | None = None) -> Description:
    """Reads the bytes of a modelDescription.xml, whole or in pieces.

    Raises XmlError if it is not XML, exceeds the limits of ``budget`` (default: of `Limits`), or has another root;
    VersionError if it is neither FMI 2 nor 3.
    """
    budget = budget or Budget(Limits())
    reader = _Reader(budget)
    read_xml((content,) if isinstance(content, bytes) else content, budget, reader.start, reader.end)
    return reader.description()


class _Reader:
    """Collects the stream of elements; ``_path`` is the present position."""

    def __init__(self, budget: Budget) -> None:
        self._budget = budget
        self._path: list[str] = []
        self._root: dict[str, str] = {}
        self._version = 0
        self._interfaces: dict[str, dict[str, str]] = {}
        self._source_files: dict[str, list[str]] = {}
        self._experiment: dict[str, str] = {}
        self._variables: list[VariableEntry] = []
        self._units: list[Unit] = []
        self._types: dict[str, dict[str, str]] = {}
        self._unknowns: dict[str, list[Unknown]] = {section: [] for section in _FMI3_SECTIONS}
        self._seen: set[str] = set()
        self._problems: list[str] = []
        # The variable, unit or type whose children are being read.
        self._open: dict[str, str] = {}
        self._kind = ""
        self._line = 0
        self._is_array = False
        self._children: list[str] = []
        self._base: dict[str, str] | None = None

    def start(self, tag: str, attributes: dict[str, str], line: int) -> None:
        self._path.append(tag)
        level = len(self._path)
        if level == 1:
            self._begin(tag, attributes)
        elif level == 2:
            self._seen.add(tag)
            if tag in INTERFACE_NAMES:
                self._interfaces[tag] = attributes
                self._source_files[tag] = []
            elif tag == "DefaultExperiment":
                self._experiment = attributes
        elif level == 3:
            self._entry(self._path[1], tag, attributes, line)
        elif level == 4:
            self._inside(self._path[1], tag, attributes, line)

    def end(self) -> None:
        if len(self._path) == 3:
            parent, tag = self._path[1], self._path[2]
            if parent == "ModelVariables":
                self._variables.append(self._variable())
            elif (parent, tag) == ("UnitDefinitions", "Unit"):
                self._units.append(self._unit())
            elif parent == "TypeDefinitions":
                self._types[self._open.get("name", "")] = self._open
        self._path.pop()

    def _begin(self, tag: str, attributes: dict[str, str]) -> None:
        if tag != _ROOT:
            raise XmlError(f"the root element is {tag[-100:]}, not {_ROOT}")
        self._root = attributes
        version = attributes.get("fmiVersion", "")
        if not re.match(r"[23]\.", version):
            raise VersionError(version[:20])
        self._version = int(version[0])

    def _entry(self, parent: str, tag: str, attributes: dict[str, str], line: int) -> None:
        """An element at the third level: a variable, a unit, a type, FMI 3's unknowns."""
        if parent in ("ModelVariables", "UnitDefinitions", "TypeDefinitions"):
            self._open, self._kind, self._line = attributes, tag, line
            self._is_array, self._children, self._base = False, [], None
        elif parent == "ModelStructure" and self._version == 3 and tag in self._unknowns:
            self._unknowns[tag].append(self._unknown(attributes, "valueReference", line))

    def _inside(self, parent: str, tag: str, attributes: dict[str, str], line: int) -> None:
        """An element at the fourth level: a part of a variable, unit, type or interface; FMI 2's unknowns."""
        if parent == "ModelVariables":
            if self._version == 2 and tag in _FMI2_TYPES and self._kind not in _FMI2_TYPES:
                self._kind = tag
                self._open = self._open | attributes
            elif tag == "Dimension":
                self._is_array = True
            elif tag == "Alias":
                self._children.append(attributes.get("name", ""))
            elif tag == "Start":
                self._open.setdefault("start", attributes.get("value", ""))
        elif parent == "UnitDefinitions":
            if tag == "BaseUnit" and self._base is None:
                self._base = attributes
            elif tag == "DisplayUnit":
                self._children.append(attributes.get("name", ""))
        elif parent == "TypeDefinitions":
            self._open = self._open | {name: value for name, value in attributes.items() if name != "name"}
        elif parent == "ModelStructure" and self._version == 2 and tag == "Unknown":
            section = _FMI2_SECTIONS.get(self._path[2])
            if section is not None:
                self._unknowns[section].append(self._unknown(attributes, "index", line))
        elif parent in INTERFACE_NAMES and self._path[2] == "SourceFiles" and tag == "File":
            self._source_files[parent].append(attributes.get("name", ""))

    def _variable(self) -> VariableEntry:
        # Most values are one of a few; names and descriptions are not.
        attributes = {
            name: value if name in ("name", "description") else sys.intern(value) for name, value in self._open.items()
        }
        return VariableEntry(
            index=len(self._variables) + 1,
            name=attributes.get("name", ""),
            reference=self._whole(attributes, "valueReference", self._line),
            type=self._kind,
            attributes=attributes,
            is_array=self._is_array,
            aliases=tuple(self._children),
        )

    def _unknown(self, attributes: dict[str, str], key: str, line: int) -> Unknown:
        dependencies, kinds = attributes.get("dependencies"), attributes.get("dependenciesKind")
        return Unknown(
            key=self._whole(attributes, key, line),
            dependencies=None if dependencies is None else self._numbers(dependencies, line),
            kinds=None if kinds is None else tuple(sys.intern(kind) for kind in kinds.split()),
        )

    def _unit(self) -> Unit:
        base = self._base
        return Unit(
            name=self._open.get("name", ""),
            base=None if base is None else tuple(self._whole(base, symbol, self._line, "0") for symbol in _BASE_UNITS),
            factor=1.0 if base is None else self._real(base, "factor", "1"),
            display_units=frozenset(self._children),
        )

    def _whole(self, attributes: Mapping[str, str], name: str, line: int, default: str = "") -> int:
        return self._number(attributes.get(name, default), name, line)

    def _number(self, text: str, name: str, line: int) -> int:
        if re.fullmatch(r"\s*[+-]?[0-9]{1,20}\s*", text) and abs(int(text)) < 2**63:
            return int(text)
        self._complain(f"line {line}: {name} is {text[:40]!r}, not a whole number")
        return _NONE

    def _numbers(self, text: str, line: int) -> Sequence[int]:
        words = text.split()
        self._budget.add_dependencies(len(words))
        try:
            return array("q", map(int, words))
        except (ValueError, OverflowError):
            return array("q", (self._number(word, "dependencies", line) for word in words))

    def _real(self, attributes: Mapping[str, str], name: str, default: str) -> float:
        text = attributes.get(name, default)
        try:
            return float(text)
        except ValueError:
            self._complain(f"line {self._line}: {name} is {text[:40]!r}, not a number")
            return math.nan

    def _complain(self, text: str) -> None:
        if len(self._problems) < _MOST_PROBLEMS:
            self._problems.append(text)

    def description(self) -> Description:
        for tag in ("ModelVariables", "ModelStructure"):
            if tag not in self._seen:
                self._complain(f"there is no element {tag}")
        unknowns = {section: tuple(found) for section, found in self._unknowns.items()}
        return Description(
            version=self._version,
            attributes=self._root,
            interfaces=self._interfaces,
            source_files={tag: tuple(files) for tag, files in self._source_files.items()},
            units=tuple(self._units),
            types=self._types,
            experiment=self._experiment,
            variables=tuple(self._variables),
            outputs=unknowns["Output"],
            derivatives=unknowns["ContinuousStateDerivative"],
            initial_unknowns=unknowns["InitialUnknown"],
            indicators=unknowns["EventIndicator"],
            clocked_states=unknowns["ClockedState"],
            problems=tuple(self._problems),
            by_name={variable.name: variable for variable in self._variables},
        )
