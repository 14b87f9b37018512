"""The comparisons of `make platforms`: what is different is seen, on numbers small enough to do by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fmu.platforms.__main__ import deviation, different_bits
from fmu.platforms.reproduce import differing

EXPECTED = {(0, "force"): np.array([0.0, 4.0]), (0, "count"): np.array([1, 2]), (1, "zero"): np.array([0.0, 0.0])}


def changed(name: str, values: np.ndarray) -> dict[tuple[int, str], np.ndarray]:
    return {key: values if key[1] == name else old for key, old in EXPECTED.items()}


def test_a_deviation_is_relative_to_the_peak() -> None:
    assert deviation(EXPECTED, EXPECTED, range(2)) == (0.0, "")
    assert deviation(changed("force", np.array([1e-3, 4.0])), EXPECTED, range(2)) == (2.5e-4, "force")
    assert deviation(changed("zero", np.array([0.0, 1e-3])), EXPECTED, range(2)) == (1e-3, "zero")
    assert deviation(changed("zero", np.array([0.0, 1e-3])), EXPECTED, [0]) == (0.0, "")


def test_counts_and_numbers_that_are_none_are_never_near() -> None:
    assert deviation(changed("count", np.array([1, 3])), EXPECTED, range(2)) == (float("inf"), "count")
    nan = changed("force", np.array([np.nan, 4.0]))
    assert deviation(nan, EXPECTED, range(2)) == (float("inf"), "force")
    assert deviation(EXPECTED, nan, range(2)) == (float("inf"), "force")
    assert deviation(nan, nan, range(2)) == (0.0, "")


def test_bits_tell_zeros_apart() -> None:
    assert different_bits(EXPECTED, EXPECTED) == []
    assert different_bits(changed("zero", np.array([0.0, -0.0])), EXPECTED) == ["zero"]


def test_files_that_differ_or_are_missing_are_named(tmp_path: Path) -> None:
    for folder, files in {"a": {"x": b"1", "y": b"2", "z": b"3"}, "b": {"x": b"1", "y": b"0"}}.items():
        (tmp_path / folder).mkdir()
        for name, data in files.items():
            (tmp_path / folder / f"{name}.fmu").write_bytes(data)
    assert differing(tmp_path / "a", tmp_path / "b") == ["y.fmu", "z.fmu"]
    assert differing(tmp_path / "a", tmp_path / "a") == []
