"""`giveway fmu info`: properties and content of an FMU, as tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from giveway.base.errors import FileError
from giveway.fmu_tools.archive import Archive, shown
from giveway.fmu_tools.check import open_safely
from giveway.fmu_tools.check.binaries import binary_of
from giveway.fmu_tools.description import INTERFACE_NAMES, Description, VariableEntry, effective
from giveway.fmu_tools.limits import Limits

__all__ = ["VARIABLE_HEADER", "describe", "variable_rows"]

VARIABLE_HEADER = ("name", "kind", "type", "start", "range", "unit", "meaning")


def describe(path: Path, limits: Limits | None = None) -> tuple[list[tuple[str, str]], Description]:
    """Facts about the FMU, (what, value), and its model description; FileError if it is not safe to read."""
    archive, description = open_safely(path, limits)
    with archive:
        platforms = _platforms(archive)
        sources = sum(name.startswith("sources/") for name in archive.files)
        unpacked = archive.unpacked_bytes
    said = {name: shown(value, 400) for name, value in description.attributes.items()}
    counts = Counter(variable.causality for variable in description.variables)
    rows = [
        ("model", f"{said.get('modelName', '')}: {said.get('description') or 'no description'}"),
        ("FMI version", said["fmiVersion"]),
        ("interfaces", ", ".join(INTERFACE_NAMES[name] for name in INTERFACE_NAMES if name in description.interfaces)),
        ("made by", f"{said.get('generationTool') or 'unknown'}, version {said.get('version') or 'unknown'}"),
        ("binaries for", ", ".join(platforms) or "none"),
        ("source files", str(sources)),
        ("size", f"{path.stat().st_size / 1e3:.0f} kB packed, {unpacked / 1e3:.0f} kB unpacked"),
        ("variables", ", ".join(f"{count} {shown(causality)}" for causality, count in sorted(counts.items()))),
        ("continuous states", str(len(description.derivatives))),
        ("event indicators", _indicators(description)),
    ]
    experiment = {name: shown(value, 40) for name, value in description.experiment.items()}
    if experiment:
        times = f"from {experiment.get('startTime', '0')} s to {experiment.get('stopTime', '?')} s"
        rows.append(
            ("default experiment", times + (f" at {experiment['stepSize']} s" if "stepSize" in experiment else ""))
        )
    return rows, description


def _indicators(description: Description) -> str:
    if description.version == 3:
        return str(len(description.indicators))
    return shown(description.attributes.get("numberOfEventIndicators", "0"), 20)


def _platforms(archive: Archive) -> list[str]:
    """Folders below binaries/, for Linux with the oldest sufficient GNU C library."""
    found: dict[str, str] = {}
    for name in archive.files:
        parts = name.split("/")
        if parts[0] != "binaries" or len(parts) != 3:
            continue
        found.setdefault(parts[1], "")
        if parts[2].endswith(".so"):
            binary = binary_of(archive, name)
            if isinstance(binary, FileError):
                found[parts[1]] = f" ({binary.value})"
            elif binary.newest_glibc is not None:
                found[parts[1]] = f" (glibc {'.'.join(str(number) for number in binary.newest_glibc)} or newer)"
    return sorted(shown(platform) + note for platform, note in found.items())


def variable_rows(description: Description, grep: str = "") -> Iterator[tuple[str, ...]]:
    """One row under `VARIABLE_HEADER` per variable whose name or description has ``grep`` in it."""
    wanted = grep.lower()
    chosen = (v for v in description.variables if wanted in f"{v.name} {v.get('description')}".lower())
    return (_row(description, variable) for variable in chosen)


def _row(description: Description, variable: VariableEntry) -> tuple[str, ...]:
    low, high = (effective(description, variable, name) for name in ("min", "max"))
    cells = (
        variable.name,
        variable.causality,
        variable.type,
        variable.get("start"),
        f"{low} to {high}" if low or high else "",
        effective(description, variable, "unit"),
        variable.get("description") or description.types.get(variable.get("declaredType"), {}).get("description", ""),
    )
    return tuple(shown(cell, 200) for cell in cells)
