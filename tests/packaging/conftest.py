"""What `make release` makes, for the deep tests: cross-compiled, which takes minutes in a new tree."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def dist() -> list[Path]:
    """Made once and checked, also under qemu and wine: wheels, source archive, FMUs, bills of materials."""
    made = subprocess.run(["make", "release"], cwd=ROOT, check=False, capture_output=True, text=True, timeout=7200)
    assert made.returncode == 0, made.stdout + made.stderr
    return sorted((ROOT / "dist").iterdir())


@pytest.fixture(scope="session")
def wheels(dist: list[Path]) -> dict[str, Path]:
    """The platform's tag -> wheel."""
    return {path.stem.rpartition("-")[2]: path for path in dist if path.suffix == ".whl"}
