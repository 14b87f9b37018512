"""The two parts of the Modelica Standard Library that GiveWay uses, Units and Icons, where a compiler finds them.

They come from the PyPI package rtc-tools-standard-library, which has no package.mo above them.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

PARTS = ("Units", "Icons")
PACKAGE = """within ;
package Modelica "Units and Icons of the Modelica Standard Library"
  annotation (version="4.0.0");
end Modelica;
"""


def standard_library(folder: Path) -> Path:
    """Put the library into ``folder``/Modelica and return ``folder``."""
    source = files("rtctools_standard_library") / "modelica" / "Modelica"
    target = folder / "Modelica"
    target.mkdir(parents=True, exist_ok=True)
    (target / "package.mo").write_text(PACKAGE)
    (target / "package.order").write_text("\n".join(PARTS) + "\n")
    for part in PARTS:
        (target / f"{part}.mo").write_text((source / f"{part}.mo").read_text())
    return folder
