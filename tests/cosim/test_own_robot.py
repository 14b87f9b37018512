"""examples/own_robot: the README's table is what the example gives, and half the coupling step is half the error."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parents[2] / "examples" / "own_robot"


def load():
    spec = importlib.util.spec_from_file_location("own_robot", FOLDER / "own_robot.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_readme_has_the_errors_and_they_are_of_first_order(monkeypatch) -> None:
    example = load()
    found = example.errors()
    monkeypatch.setattr(example, "errors", lambda: found)
    assert example.table() in (FOLDER / "README.md").read_text(encoding="utf-8")
    coarse, middle, fine = (found[step_s].max() for step_s in (2e-4, 1e-4, 5e-5))
    assert 1.7 < coarse / middle < 2.4
    assert 1.7 < middle / fine < 2.4
    # The planted fault: pieces with another plate are another robot, however fine the step.
    monkeypatch.setattr(example, "PLATE_MASS", 1.0)
    reference = example.monolithic()
    other = np.abs(example.composed(2e-4) - reference).max(axis=0) / np.abs(reference).max(axis=0)
    assert other.max() > 2 * coarse
