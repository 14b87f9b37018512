"""`giveway fmu info`: what an FMU is and what it holds, as tables."""

from __future__ import annotations

import zipfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from giveway.errors import FileError

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription, ScalarVariable

__all__ = ["VARIABLE_HEADER", "describe", "read_for_use", "variable_rows"]

VARIABLE_HEADER = ("name", "kind", "type", "start", "range", "unit", "meaning")


def read_for_use(path: Path) -> ModelDescription:
    """The model description by FMPy, as an importer sees it; FileError if it is not usable."""
    import fmpy

    try:
        return fmpy.read_model_description(str(path), validate=False)
    except Exception as error:  # FMPy raises plain Exception for anything wrong with a file
        raise FileError(path, f"is not a usable FMU: {error}", "`giveway fmu check` says more") from None


def describe(path: Path) -> list[tuple[str, str]]:
    """Facts about the FMU, (what, value)."""
    description = read_for_use(path)
    with zipfile.ZipFile(path) as archive:
        infos = archive.infolist()
        platforms = _platforms(archive)
    sources = sum(i.filename.startswith("sources/") and not i.is_dir() for i in infos)
    interfaces = {
        "Co-Simulation": description.coSimulation,
        "Model Exchange": description.modelExchange,
        "Scheduled Execution": getattr(description, "scheduledExecution", None),
    }
    counts = Counter(variable.causality for variable in description.modelVariables)
    experiment = description.defaultExperiment
    rows = [
        ("model", f"{description.modelName}: {description.description or 'no description'}"),
        ("FMI version", str(description.fmiVersion)),
        ("interfaces", ", ".join(name for name, found in interfaces.items() if found is not None)),
        ("made by", f"{description.generationTool or 'unknown'}, version {description.version or 'unknown'}"),
        ("binaries for", ", ".join(platforms) or "none"),
        ("source files", str(sources)),
        ("size", f"{path.stat().st_size / 1e3:.0f} kB packed, {sum(i.file_size for i in infos) / 1e3:.0f} kB unpacked"),
        ("variables", ", ".join(f"{count} {causality}" for causality, count in sorted(counts.items()))),
        ("continuous states", str(description.numberOfContinuousStates)),
        ("event indicators", str(description.numberOfEventIndicators)),
    ]
    if experiment is not None:
        times = f"from {experiment.startTime or 0} s to {experiment.stopTime or '?'} s"
        rows.append(("default experiment", times + (f" at {experiment.stepSize} s" if experiment.stepSize else "")))
    return rows


def _platforms(archive: zipfile.ZipFile) -> list[str]:
    """Folders below binaries/, for Linux with the oldest GNU C library that will do."""
    from giveway.fmu_binaries import read_binary

    found: dict[str, str] = {}
    for name in archive.namelist():
        parts = name.split("/")
        if parts[0] != "binaries" or len(parts) != 3 or not parts[2]:
            continue
        found.setdefault(parts[1], "")
        if parts[2].endswith(".so"):
            with TemporaryDirectory() as folder:
                copy = Path(folder) / "library.so"
                copy.write_bytes(archive.read(name))
                try:
                    newest = read_binary(copy).newest_glibc
                except FileError:
                    newest = None
            if newest is not None:
                found[parts[1]] = f" (glibc {'.'.join(str(number) for number in newest)} or newer)"
    return sorted(platform + note for platform, note in found.items())


def variable_rows(path: Path, grep: str = "") -> list[tuple[str, ...]]:
    """One row under `VARIABLE_HEADER` per variable whose name or description has ``grep`` in it."""
    wanted = grep.lower()
    chosen = [v for v in read_for_use(path).modelVariables if wanted in f"{v.name} {v.description or ''}".lower()]
    return [_row(variable) for variable in chosen]


def _row(variable: ScalarVariable) -> tuple[str, ...]:
    low, high = variable.min, variable.max
    bounds = "" if low is None and high is None else f"{low or ''} to {high or ''}"
    start = "" if variable.start is None else str(variable.start)
    kinds: Sequence[str] = (variable.causality, variable.type)
    return (variable.name, *kinds, start, bounds, variable.unit or "", variable.description or "")
