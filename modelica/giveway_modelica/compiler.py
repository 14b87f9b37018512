"""GiveWay's classes through rumoca: which there are, and how they are compiled and simulated."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).parents[1] / "GiveWay"
CLASS = re.compile(r"^(partial )?(package|model|block|connector|function|record|class) (\w+)", re.MULTILINE)
EXPERIMENT = re.compile(r"experiment\(StopTime=([\d.e-]+), Tolerance=([\d.e-]+), Interval=([\d.e-]+)\)")


@dataclass(frozen=True)
class ModelicaClass:
    """A class and the file that it is in.

    Attributes:
        name: full, "GiveWay.Components.Motor".
        kind: "model", "block", "function", "connector", "record", "class" or "package".
    """

    name: str
    kind: str
    partial: bool
    path: Path

    @property
    def text(self) -> str:
        return self.path.read_text()

    @property
    def experiment(self) -> tuple[float, float, float] | None:
        """Stop time in s, relative tolerance and output interval in s."""
        found = EXPERIMENT.search(self.text)
        return (float(found[1]), float(found[2]), float(found[3])) if found else None


def classes(package: Path = PACKAGE) -> Iterator[ModelicaClass]:
    """All classes of the package at ``package``, one per file."""
    for path in sorted(package.rglob("*.mo")):
        found = CLASS.search(path.read_text())
        place = path.parent if path.name == "package.mo" else path.with_suffix("")
        name = ".".join((package.name, *place.relative_to(package).parts))
        if found is None:
            raise ValueError(f"{path}: no class")
        yield ModelicaClass(name, found[2], found[1] is not None, path)


class Compiler:
    """rumoca on one version of the package.

    Args:
        library: folder that holds the Standard Library (`standard_library`).
        scratch: folder for variants of classes.
    """

    def __init__(self, library: Path, scratch: Path, package: Path = PACKAGE) -> None:
        import rumoca

        self._library, self._scratch, self._package = library, scratch, package
        self._session = rumoca.Session(roots=[str(library)])
        self._loaded: dict[str, Any] = {}

    def load(self, name: str, changes: str = "") -> Any:
        """The compiled class; ``changes`` is a modification such as "robot(counts=1000000)"."""
        if not changes:
            if name not in self._loaded:
                self._loaded[name] = self._session.load(self._package / "package.mo", model=name)
            return self._loaded[name]
        return self.load_text(f"  extends {name}({changes});\n", f"{name} {changes}")

    def load_text(self, text: str, label: str) -> Any:
        """A compiled model of its own with this ``text`` inside."""
        import rumoca

        folder = self._scratch / re.sub(r"\W", "_", label)
        folder.mkdir(parents=True, exist_ok=True)
        # rumoca only reads libraries whose names it meets in the file: hence the icon.
        whole = f"model Variant\n  extends Modelica.Icons.Example;\n{text}end Variant;\n"
        (folder / "Variant.mo").write_text(whole)
        session = rumoca.Session(roots=[str(self._library), str(self._package)])
        return session.load(folder / "Variant.mo", model="Variant")

    def simulate(
        self, name: str, changes: str = "", tolerance: float | None = None, interval_s: float | None = None
    ) -> Any:
        """The result of an example with its own experiment settings, or another tolerance and output interval."""
        settings = next(found for found in classes(self._package) if found.name == name).experiment
        if settings is None:
            raise ValueError(f"{name} has no experiment annotation")
        stop_s, relative, interval = settings
        return simulated(self.load(name, changes), stop_s, tolerance or relative, interval_s or interval)


def simulated(loaded: Any, stop_s: float, tolerance: float, interval_s: float = 1e-3) -> Any:
    """The result of what `Compiler` has loaded."""
    import rumoca

    # Explicit steps: stiff ones restart too slowly at two thousand samples per second.
    config = rumoca.SimConfig(solver="rk-like", rtol=tolerance, atol=1e-2 * tolerance, dt=interval_s)
    return loaded.simulate(t=(0.0, stop_s), config=config)
