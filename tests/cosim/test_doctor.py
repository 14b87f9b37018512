"""`giveway doctor`: fine where all is fine, and wrong where a file is missing or a run has other bits."""

from __future__ import annotations

import json
from pathlib import Path

import giveway
import numpy as np
import pytest
from cosim_helpers import Cli
from giveway.base import native
from giveway.doctor import findings, golden


def states(text: str) -> dict[str, str]:
    document = json.loads(text)
    assert document["schema_version"] == 1
    return {one["about"]: one["state"] for one in document["findings"]}


def test_all_is_fine_here(process: Cli) -> None:
    answer = process("doctor", "--json")
    assert answer.returncode == 0
    found = states(answer.stdout)
    runs = ("golden run, batch library", "golden run, FMUs of FMI 3", "golden run, FMUs of FMI 2")
    assert {found[name] for name in ("giveway", "native files", "processor", *runs)} == {"fine"}
    assert found["extra optimise"] == "fine"


def test_other_bits_are_wrong(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of one sample in the last digit."""
    real = golden.digest

    def other(result: giveway.Result) -> str:
        values = result.traces["testbed.sensor.torque[1]"].values
        values[500] = np.nextafter(values[500], np.inf)
        return real(result)

    monkeypatch.setattr(golden, "digest", other)
    answer = cli("doctor")
    assert answer.returncode == 1
    assert answer.stdout.count("has other bits") == 3


def test_missing_files_and_extras_are_named(cli: Cli, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    found = native.file

    def without(name: str) -> Path:
        if name == "giveway_drivetrain_fmi2.fmu":
            raise native.NativeMissingError(name, tmp_path, "nowhere")
        return found(name)

    monkeypatch.setattr(native, "file", without)
    monkeypatch.setattr(findings.importlib.metadata, "requires", lambda _: ["nonsense>=1; extra == 'more'", "numpy>=1"])
    answer = cli("doctor")
    assert answer.returncode == 1
    assert "giveway_drivetrain_fmi2.fmu not found" in answer.stdout
    assert "pip install 'giveway[more]'" in answer.stdout
    assert "golden run" not in answer.stdout
