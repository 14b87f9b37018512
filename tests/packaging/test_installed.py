"""Wheels, installed as users do: away from the repository, with pip and what PyPI has."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from bare_environment import Bare

ROOT = Path(__file__).parents[2]


@pytest.mark.deep
@pytest.mark.parametrize("version", ["3.11", "3.12", "3.13"])
def test_a_bare_environment_runs_the_demonstration(wheels: dict[str, Path], version: str, tmp_path: Path) -> None:
    """Without compilers: PATH holds nothing but the environment. A missing interpreter is named."""
    command = ["bash", ROOT / "verify" / "python.sh", version]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr
    bare = Bare(tmp_path, found.stdout.strip())
    bare.install(wheels["manylinux_2_17_x86_64"])
    bare.demonstrate()
    bare.consult()
    bare.remove()
