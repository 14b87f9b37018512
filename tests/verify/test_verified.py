"""c_core/VERIFIED.json is of these sources, and what is cheap to measure again still comes out as it says."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

from verify.context import Context
from verify.rung import all_rungs
from verify.sources import CORE, SCALARS, core_files, core_hash, subject_hash

ROOT = Path(__file__).parents[2]
RUNGS = all_rungs()


@pytest.fixture(scope="module")
def verified() -> dict[str, Any]:
    path = ROOT / "c_core" / "VERIFIED.json"
    assert path.is_file(), "c_core was never verified: run `make verify`"
    document: dict[str, Any] = json.loads(path.read_text())
    return document


@pytest.mark.parametrize("name", RUNGS)
def test_the_sources_are_those_that_were_verified(name: str, verified: dict[str, Any]) -> None:
    subject = RUNGS[name].subject
    recorded = verified["rungs"].get(name, {}).get("sources_sha256")
    assert recorded == subject_hash(ROOT, subject), (
        f"{', '.join(subject)}: changed since, or never verified; run `make verify ONLY={name}` and commit"
    )


def test_the_hash_of_the_c_core_is_that_of_the_rungs_about_all_of_it(verified: dict[str, Any]) -> None:
    assert verified["c_core_sha256"] == core_hash(ROOT)
    of_all = [name for name, rung in RUNGS.items() if rung.subject == CORE]
    assert {verified["rungs"][name]["sources_sha256"] for name in of_all} == {core_hash(ROOT)}
    assert len(of_all) >= 11


def test_every_rung_is_about_files_that_exist() -> None:
    for name, rung in RUNGS.items():
        assert all(any(ROOT.glob(pattern)) for pattern in rung.subject), name


def test_the_scalar_functions_include_no_other_header() -> None:
    """Their rungs stand while the rest of c_core changes."""
    source = ROOT / SCALARS[-1]
    made = subprocess.run(
        ["gcc", "-MM", f"-I{ROOT / 'c_core/include'}", str(source)], capture_output=True, text=True, check=True
    ).stdout
    files = made.replace("\\\n", " ").split()[1:]
    assert sorted(Path(file) for file in files) == sorted(ROOT / name for name in SCALARS)


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
