"""The comparison of a search with an even sample: its shares are the hypervolumes', and it goes on where it stopped."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from giveway.bench.known_fronts import PROBLEMS, binh_korn
from giveway.bench.optimum import Comparison, compare, shares_in_words
from giveway.cli import _main
from giveway.study.answers import load
from giveway.study.hypervolume import hypervolume
from study_helpers import JUDGED_LATCH_STUDY

STUDY = f"""\
schema_version = 1
method = "fixed-step"
{JUDGED_LATCH_STUDY}[[vary]]
quantity = "testbed.bumper.spring_rate"
low = 500.0
high = 3000.0
[[tolerance]]
quantity = "testbed.bumper.latch_force"
relative = 0.1
[[objective]]
metric = "peak force of the run"
[[objective]]
metric = "bumper compression"
[optimise]
reference = [200.0, 60.0]
population = 8
"""


def test_a_search_is_compared_with_an_even_sample(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "s.toml").write_text(STUDY, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    command = ["bench", "--optimum", "s.toml", "--sample", "64", "--runs", "24", "--seeds", "2", "--out", "b"]
    assert _main(command) == 0
    said = capsys.readouterr().out
    assert "24 searched runs reach" in said
    assert "of the hypervolume of 64 even ones (median of 2 seeds" in said
    for name in PROBLEMS:
        assert name in said
    found = list(compare(Path("s.toml"), Path("b"), 64, 24, 2, lambda _name, _share: None))
    point = np.array([200.0, 60.0])
    sample = load("b/sample")
    assert len(sample.designs) == sample.manifest["runs"] == 64  # without tolerances: a design is a run
    volume = hypervolume(sample.values[sample.feasible][:, :2], point)
    for one in found:
        answers = load(f"b/search-{one.seed}")
        assert (one.runs, one.front) == (24, int(answers.pareto.sum()))
        assert one.share == pytest.approx(hypervolume(answers.values[answers.feasible][:, :2], point) / volume)
        assert f"{one.share:.4f}" in said
    assert found[0].share != found[1].share
    stored = sorted(path.name for path in tmp_path.rglob("*.parquet"))
    assert _main(command) == 0
    assert sorted(path.name for path in tmp_path.rglob("*.parquet")) == stored


def test_binh_and_korn_is_as_published() -> None:
    """Also outside the box of its quantities, in which the second constraint is never reached."""
    costs, constraints = binh_korn(np.array([[8.0, -3.0], [5.0, 5.0]]))
    np.testing.assert_allclose(costs, [[292.0, 73.0], [200.0, 0.0]], rtol=1e-15)
    np.testing.assert_allclose(constraints, [[-7.0, 7.7], [0.0, -65.3]], rtol=1e-15)


def test_the_median_is_said_with_its_range() -> None:
    found = [Comparison(seed, 10, share, None, 3, 0.1) for seed, share in enumerate((0.9, 0.99, 0.95), 1)]
    words = "10 searched runs reach 0.9500 of the hypervolume of 1,000 even ones (median of 3 seeds, 0.9000 to 0.9900)."
    assert shares_in_words(found, 1000, 10) == words
    assert found[0].cells == ("1", "10", "0.9000", "-", "3", "0.10")


@pytest.mark.parametrize(("old", "new", "words"), [
    ("reference = [200.0, 60.0]", "", "optimise.reference: nothing is not allowed; allowed: a value of each objective"),
    ("[200.0, 60.0]", "[0.1, 0.1]", "optimise.reference: (0.1, 0.1) is not allowed; allowed: a point that some"),
    ("population = 8", "population = 800", "optimise.designs: 24 is not allowed"),
])  # fmt: skip
def test_what_cannot_be_compared_is_said(
    old: str, new: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "s.toml").write_text(STUDY.replace(old, new), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert _main(["bench", "--optimum", "s.toml", "--sample", "8", "--runs", "24", "--seeds", "1", "--out", "b"]) == 2
    assert words in capsys.readouterr().err
