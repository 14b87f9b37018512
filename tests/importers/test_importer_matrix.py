"""`make importers`: its table is that of the committed results, and a crash, a hang or a wrong run becomes a cell."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from importers import matrix
from importers.matrix import IMPORTERS, Importer, run_cell
from importers.table import BEGIN, END, markdown, put_into, read_results

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/site/reference/importers.md").read_text(encoding="utf-8")


def test_the_page_has_the_committed_results() -> None:
    results = read_results(ROOT / "importers/results.json")
    assert markdown(results) in PAGE
    assert put_into(PAGE, results) == PAGE
    assert put_into(PAGE.replace("| all; same bits", "| all"), results) == PAGE, "the planted fault"


def test_the_results_are_of_these_importers_and_as_expected() -> None:
    results = read_results(ROOT / "importers/results.json")
    assert set(results) - {importer.name for importer in IMPORTERS} == {"VDMCheck2 1.1.3 (checks, does not run)"}
    assert [name for name, cells in results.items() if not all(cell["met"] for cell in cells.values())] == []
    assert all(cell["text"] for cells in results.values() for cell in cells.values())


def test_a_page_without_marks_is_refused() -> None:
    with pytest.raises(SystemExit, match="has no lines"):
        put_into(PAGE.replace(BEGIN, "").replace(END, ""), {})


HEAD = 'import json, sys, ctypes, time\njob = json.load(open(sys.argv[1]))\nprint(\'{"stage": "load"}\', flush=True)\n'
STAGES = "".join(f'print(\'{{"stage": "{name}"}}\')\n' for name in ("initialise", "step", "closed loop"))
TRACE = """open(job["trace"], "w").write("time,x\\n" + "\\n".join(
    ",".join([float(k * 1e-3).hex(), float(k + OFFSET).hex()]) for k in range(601)))
"""


@pytest.mark.parametrize(
    ("body", "text", "met"),
    [
        ("ctypes.string_at(0)", "to load; crash: SIGSEGV", False),
        ("time.sleep(60)", "to load; no end within 2 s", False),
        ("sys.exit(3)", "to load; ended with exit code 3", False),
        ('print(\'{"stage": "initialise", "failed": "no token"}\')', "to load; no token", False),
        (STAGES + TRACE.replace("OFFSET", "0"), "all; same bits", True),
        (STAGES + TRACE.replace("OFFSET", "6"), "to closed loop; deviates by 1.0e-02", False),
    ],
)
def test_what_a_probe_does_becomes_a_cell(
    body: str, text: str, met: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(matrix, "TIMEOUT_S", 2.0)
    (tmp_path / "probe.py").write_text(HEAD + body)
    steps = np.arange(601.0)
    np.save(tmp_path / "reference.npy", np.column_stack([steps * 1e-3, steps]))
    importer = Importer("planted", str(tmp_path / "probe.py"), False, {}, {})
    cell = run_cell(importer, 3, "CS", Path(sys.executable), tmp_path, tmp_path)
    assert (cell.text, cell.met) == (text, met)
    # Where a failure is what is expected, only a failure will do.
    expected = Importer("planted", str(tmp_path / "probe.py"), False, {}, {(3, "CS"): "cannot"})
    assert run_cell(expected, 3, "CS", Path(sys.executable), tmp_path, tmp_path).met is not met
