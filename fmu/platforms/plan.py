"""Writes the plans that run_fmus.c runs, and reads its output."""

from __future__ import annotations

import struct
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

__all__ = ["Fmu", "Plan", "read_outputs"]

_KINDS = {"Float64": "r", "Int32": "i", "Boolean": "b"}
_SUFFIXES = {"linux": "so", "windows": "dll", "darwin": "dylib"}


@dataclass(frozen=True)
class Fmu:
    """An FMI 3.0 FMU: its token, and reference and kind (r, i, b) of each variable by name and causality."""

    path: Path
    name: str
    token: str
    ports: Mapping[str, tuple[int, str]]
    outputs: tuple[str, ...]
    starts: Mapping[str, float]  # of parameters and inputs of type real

    @classmethod
    def open(cls, path: Path) -> Fmu:
        with zipfile.ZipFile(path) as archive:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        ports: dict[str, tuple[int, str]] = {}
        outputs: list[str] = []
        starts: dict[str, float] = {}
        for variable in root.iterfind("ModelVariables/*"):
            name = variable.attrib["name"]
            ports[name] = (int(variable.attrib["valueReference"]), _KINDS[variable.tag])
            if variable.attrib["causality"] == "output":
                outputs.append(name)
            if variable.tag == "Float64" and "start" in variable.attrib:
                starts[name] = float(variable.attrib["start"])
        interface = root.find("CoSimulation")
        assert interface is not None
        identifier = interface.attrib["modelIdentifier"]
        token = root.attrib["instantiationToken"]
        return cls(path, identifier, token, ports, tuple(outputs), starts)

    def library(self, platform: str, folder: Path) -> Path:
        """The shared library of a platform, unpacked below ``folder``."""
        suffix = _SUFFIXES[platform.split("-")[1]]
        with zipfile.ZipFile(self.path) as archive:
            return Path(archive.extract(f"binaries/{platform}/{self.name}.{suffix}", folder / self.path.stem))


def _value(kind: str, value: float) -> str:
    return f"{struct.unpack('<Q', struct.pack('<d', value))[0]:016x}" if kind == "r" else str(int(value))


@dataclass
class Plan:
    """One run of instances of FMUs, as lines for run_fmus.c."""

    fmus: Sequence[Fmu]
    steps: int
    step_s: float
    lines: list[str] = field(default_factory=list)
    drives: list[tuple[str, Sequence[float]]] = field(default_factory=list)  # kind, one value a step
    columns: list[tuple[int, str, str]] = field(default_factory=list)  # instance, name, kind

    def set(self, instance: int, values: Mapping[str, float]) -> None:
        """Parameters or inputs before the initialisation."""
        for name, value in values.items():
            reference, kind = self.fmus[instance].ports[name]
            self.lines.append(f"set {instance} {kind} {reference} {_value(kind, value)}")

    def connect(self, source: int, target: int, names: Sequence[str]) -> None:
        """Connects outputs of one FMU to the inputs of another with the same names."""
        for name in names:
            start, kind = self.fmus[source].ports[name]
            end, _ = self.fmus[target].ports[name]
            self.lines.append(f"connect {source} {start} {target} {end} {kind}")

    def drive(self, instance: int, name: str, values: Sequence[float]) -> None:
        """An input with one value for each step."""
        reference, kind = self.fmus[instance].ports[name]
        self.lines.append(f"drive {instance} {kind} {reference}")
        self.drives.append((kind, values))

    def read_all(self) -> None:
        """Every output of every FMU."""
        for instance, fmu in enumerate(self.fmus):
            for name in fmu.outputs:
                reference, kind = fmu.ports[name]
                self.lines.append(f"read {instance} {kind} {reference}")
                self.columns.append((instance, name, kind))

    def write(self, path: Path, libraries: Sequence[str], others: Sequence[str] = ()) -> None:
        """``libraries``: how the runner finds the library of each FMU; ``others`` are only loaded and unloaded."""
        head = [f"library {other}" for other in others]
        head += [f"fmu {library} {fmu.token}" for library, fmu in zip(libraries, self.fmus, strict=True)]
        rows = [" ".join(_value(kind, values[k]) for kind, values in self.drives) for k in range(self.steps)]
        run = f"run {self.steps} {_value('r', self.step_s)}"
        path.write_text("\n".join([*head, *self.lines, run, *rows, ""]), encoding="ascii")


def read_outputs(text: str, plan: Plan) -> dict[tuple[int, str], NDArray[np.float64] | NDArray[np.int64]]:
    """Column of each output, by instance and name: shape (steps,). ``text`` holds the run twice, with the same bits."""
    rows = [line.split() for line in text.splitlines()]
    if [len(row) for row in rows] != [len(plan.columns)] * (2 * plan.steps):
        raise ValueError(
            f"{len(rows)} rows of outputs, but two runs have {2 * plan.steps} of {len(plan.columns)} values"
        )
    rows, again = rows[: plan.steps], rows[plan.steps :]
    if again != rows:
        raise ValueError("the second run in the same process, after a reload, has other outputs than the first")
    found: dict[tuple[int, str], NDArray[np.float64] | NDArray[np.int64]] = {}
    for column, (instance, name, kind) in enumerate(plan.columns):
        words = [row[column] for row in rows]
        if kind == "r":
            found[instance, name] = np.array([int(word, 16) for word in words], np.uint64).view(np.float64)
        else:
            found[instance, name] = np.array([int(word) for word in words], np.int64)
    return found
