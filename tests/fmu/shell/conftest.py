"""The small model of these tests, tests/fmu/shell/lag, in both FMI versions."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from fmu_driver import Fmu, fmu_path


@pytest.fixture(params=[2, 3], ids=["fmi2", "fmi3"])
def lag(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Fmu]:
    """Unpacked, not yet instantiated."""
    fmu = Fmu(fmu_path("lag", request.param), request.param, tmp_path / "fmu")
    yield fmu
    if fmu.instance is not None:
        fmu.free()
