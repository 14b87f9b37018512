"""What `make wheels` makes, for the deep tests: cross-compiled, which takes minutes in a new tree."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def wheels() -> dict[str, Path]:
    """The platform's tag -> wheel."""
    subprocess.run(["make", "wheels"], cwd=ROOT, check=True, capture_output=True, timeout=7200)
    return {path.stem.rpartition("-")[2]: path for path in (ROOT / "dist").glob("giveway-*.whl")}
