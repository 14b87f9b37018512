"""The committed reference results are what the examples give, and their lists of signals name what is in them."""

import csv
import io
from typing import Any

import numpy as np
import pytest
from giveway_modelica.compiler import Compiler, classes
from giveway_modelica.reference_results import COMMAND, FOLDER, ROWS, SIGNALS, table

# Of a signal's largest value: the solver's tolerance of 1e-7 per step, on a machine that rounds otherwise.
CLOSE = 1e-5


def read(text: str) -> tuple[list[str], np.ndarray]:
    rows = list(csv.reader(io.StringIO(text)))
    return rows[0], np.array(rows[1:], dtype=float)


def test_there_is_a_result_of_every_example() -> None:
    examples = {found.name.rsplit(".", 1)[1] for found in classes() if found.name.startswith("GiveWay.Examples.")}
    assert set(SIGNALS) == examples == {path.name for path in FOLDER.iterdir() if path.is_dir()}
    assert COMMAND in (FOLDER / "README.md").read_text()


def check_the_reference_result(result: Any, example: str) -> None:
    """It is what is committed."""
    names, committed = read((FOLDER / example / f"{example}.csv").read_text())
    assert (FOLDER / example / "comparisonSignals.txt").read_text().split() == names == ["time", *SIGNALS[example]]
    assert committed.shape == (ROWS, len(names))
    _, now = read(table(result, example))
    scale = np.maximum(np.abs(committed).max(axis=0), 1e-6)
    assert (np.abs(now - committed) / scale).max() < CLOSE, f"run `{COMMAND}`"


@pytest.mark.parametrize("example", [example for example in SIGNALS if example != "CircleRound"])
def test_the_reference_result_is_fresh(compiler: Compiler, example: str) -> None:
    check_the_reference_result(compiler.simulate(f"GiveWay.Examples.{example}"), example)
