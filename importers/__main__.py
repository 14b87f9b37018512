"""`python -m importers`: from the repository's root; `make importers` prepares what it needs.

Writes importers/results.json and the table in docs/site/reference/importers.md; exits with 1 if an importer did
not behave as expected.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

from importers import vdmcheck
from importers.matrix import COLUMNS, IMPORTERS, run_cell, write_reference
from importers.table import markdown, put_into, write_results

ROOT = Path(__file__).parents[1]
MODELS = ("controller", "testbed", "drivetrain", "bumper")


def main() -> int:
    parser = argparse.ArgumentParser(prog="importers", description="Try the FMUs in other people's importers.")
    parser.add_argument("--python", type=Path, default=ROOT / "build/importers/tools/bin/python")
    parser.add_argument("--dry", action="store_true", help="print the table; leave the page and the results alone")
    options = parser.parse_args()
    work, fmus = ROOT / "build/importers/work", ROOT / "out/fmus"  # the files that `make fmus ALL=1` makes for users
    work.mkdir(parents=True, exist_ok=True)
    write_reference(work / "reference.npy")
    results: dict[str, dict[str, Any]] = {}
    for importer in IMPORTERS:
        cells: dict[str, Any] = {}
        for version, interface in COLUMNS:
            cell = run_cell(importer, version, interface, options.python.absolute(), fmus, work)
            print(f"{importer.name}, FMI {version} {interface}: {cell.text}", flush=True)
            cells[f"FMI {version} {interface}"] = {"text": cell.text, **asdict(cell)}
        results[importer.name] = cells
    results["VDMCheck2 1.1.3 (checks, does not run)"] = _checked(fmus)
    print(markdown(results))
    if not options.dry:
        write_results(ROOT / "importers/results.json", results)
        page = ROOT / "docs/site/reference/importers.md"
        page.write_text(put_into(page.read_text(encoding="utf-8"), results), encoding="utf-8")
    missed = [f"{name}, {column}" for name, cells in results.items() for column, c in cells.items() if not c["met"]]
    for name in missed:
        print(f"not as expected: {name}")
    return 1 if missed else 0


def _checked(fmus: Path) -> dict[str, Any]:
    """All four FMI 2 model descriptions; one description holds both interfaces."""
    jar = vdmcheck.install(ROOT / "build/importers/vdmcheck")
    said = [text for m in MODELS if (text := vdmcheck.check(jar, fmus / f"giveway_{m}_fmi2.fmu"))]
    text = "; ".join(said) or "no errors, all four"
    cells: dict[str, Any] = {
        f"FMI 2 {i}": {"text": text, "reason": "; ".join(said), "met": not said} for i in ("CS", "ME")
    }
    for interface in ("CS", "ME"):
        cells[f"FMI 3 {interface}"] = {"text": "no: FMI 2 only", "reason": "FMI 2 only", "met": True}
    return cells


if __name__ == "__main__":
    sys.exit(main())
