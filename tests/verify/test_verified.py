"""c_core/VERIFIED.json is of these sources, and what is cheap to measure again still comes out as it says."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

from verify.context import Context
from verify.rung import all_rungs
from verify.sources import core_files, core_hash

ROOT = Path(__file__).parents[2]
RUNGS = all_rungs()


@pytest.fixture(scope="module")
def verified() -> dict[str, Any]:
    path = ROOT / "c_core" / "VERIFIED.json"
    assert path.is_file(), "c_core was never verified: run `make verify`"
    document: dict[str, Any] = json.loads(path.read_text())
    return document


def test_the_sources_are_those_that_were_verified(verified: dict[str, Any]) -> None:
    assert verified["sources_sha256"] == core_hash(ROOT), "c_core has changed since: run `make verify` and commit"


def test_every_rung_was_climbed(verified: dict[str, Any]) -> None:
    assert list(verified["rungs"]) == list(RUNGS), "the ladder has changed since: run `make verify` and commit"


@pytest.mark.parametrize("name", [name for name, rung in RUNGS.items() if rung.remeasure])
def test_cheap_figures_come_out_the_same(name: str, verified: dict[str, Any], tmp_path: Path) -> None:
    remeasure = RUNGS[name].remeasure
    assert remeasure is not None
    values = remeasure(Context(ROOT, tmp_path, os.environ["PATH"]))
    assert values
    recorded = verified["rungs"][name]["values"]
    assert {key: recorded.get(key) for key in values} == dict(values)


def test_the_hash_sees_every_file_and_its_name(tmp_path: Path) -> None:
    for path in core_files(ROOT):
        copy = tmp_path / path.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(path.read_bytes())
    whole = core_hash(tmp_path)
    assert whole == core_hash(ROOT)
    seen = {whole}
    for path in core_files(tmp_path):
        content = path.read_bytes()
        path.write_bytes(content + b"\n")
        seen.add(core_hash(tmp_path))
        path.rename(path.with_stem("moved"))
        path.with_stem("moved").write_bytes(content)
        seen.add(core_hash(tmp_path))
        path.with_stem("moved").rename(path)
    assert len(seen) == 1 + 2 * len(core_files(tmp_path))
    assert core_hash(tmp_path) == whole
