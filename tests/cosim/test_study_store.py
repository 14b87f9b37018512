"""Nothing is lost and nothing is done twice: kills at random moments, caches, locks, failed designs, Ctrl-C."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
from giveway.base.errors import FileError
from giveway.library.work import RunningWork
from giveway.study import Study
from giveway.study.engine import Outcome, plan_runs, sweep
from giveway.study.messages import overview
from giveway.study.results_table import read_part
from giveway.study.store import KeyIndex, Store, read_manifest
from study_helpers import LATCH, SPRING, interrupt, part_files, small_study, stored_runs

KILLS = 20


def swept(study: Study, folder: Path) -> Outcome:
    return sweep(study.setup(), folder, threads=2)


def same_runs(one: Path, other: Path) -> None:
    first, second = stored_runs(one), stored_runs(other)
    assert first.keys() == second.keys()
    for name in first:
        np.testing.assert_array_equal(first[name], second[name], name)


def in_a_child(study: Study, folder: Path) -> int:
    """Run the study in a process of its own; its pid."""
    pid = os.fork()
    if pid == 0:
        try:
            sweep(study.setup(), folder, threads=1)
        finally:
            os._exit(0)
    return pid


def test_twenty_kills_at_random_moments_change_nothing(tmp_path: Path) -> None:
    study = small_study(vary=[], part_runs=4)
    study.vary(LATCH, low=0.0, high=90.0, levels=20).vary(SPRING, low=500.0, high=2500.0, levels=12)
    whole, killed = tmp_path / "a" / "whole", tmp_path / "b" / "killed"  # not side by side: no shared results
    started = time.perf_counter()
    count = swept(study, whole).runs
    budget_s = time.perf_counter() - started
    pick = random.Random(4)
    kills = 0
    seen: set[Path] = set()
    while kills < KILLS:
        pid = in_a_child(study, killed)
        # Somewhere from reading the folder to a few parts later.
        time.sleep(pick.uniform(0.0, 1.5 * budget_s / KILLS))
        os.kill(pid, signal.SIGKILL)
        _, status = os.waitpid(pid, 0)
        assert os.WIFSIGNALED(status), "the study ended before all kills: make it longer"
        kills += 1
        parts = set(part_files(killed))
        assert seen <= parts, "a part that was there is gone"
        for path in parts - seen:
            assert pyarrow.parquet.read_metadata(path).num_rows == 4
        seen = parts
    assert 0 < 4 * len(seen) < count  # it was killed on its way, and it went on each time
    last = swept(study, killed)
    assert last.ran == count - 4 * len(seen), "a stored part was run again"
    same_runs(whole, killed)
    assert not [path.name for path in killed.rglob(".*-*")], "left by a kill"


def test_a_finished_study_is_not_run_again(tmp_path: Path) -> None:
    assert swept(small_study(), tmp_path / "study").ran == 4
    again = swept(small_study(), tmp_path / "study")
    assert (again.ran, again.stored) == (0, 4)


def test_equal_designs_run_once(tmp_path: Path) -> None:
    study = small_study(vary=[{"quantity": LATCH, "values": [20.0, 30.0]}])
    study.tolerance("testbed.rope.hanging_mass", relative=0.5)  # no rope is attached, but its value is part of the run
    study.vary("bumper", values=["magnetic", "magnetic"])
    outcome = swept(study.tolerances(samples=1), tmp_path / "study")
    assert (outcome.runs, outcome.ran, outcome.reused) == (8, 4, 4)
    runs = stored_runs(tmp_path / "study")
    peaks = runs["peak force of the run"].reshape(2, 2, 2)
    np.testing.assert_array_equal(peaks[:, 0], peaks[:, 1])


def test_a_changed_study_takes_over_what_is_the_same(tmp_path: Path) -> None:
    swept(small_study(), tmp_path / "study")
    grown = small_study(vary=[{"quantity": LATCH, "values": [10.0, 20.0, 40.0, 50.0]}])
    outcome = swept(grown, tmp_path / "study")
    assert (outcome.ran, outcome.reused) == (2, 2)
    swept(grown, tmp_path / "elsewhere" / "study")
    same_runs(tmp_path / "study", tmp_path / "elsewhere" / "study")


def test_what_was_made_of_the_designs_of_another_study_is_removed_and_said(tmp_path: Path) -> None:
    study, folder = small_study(vary=[]).vary(LATCH, values=[20.0]), tmp_path / "study"
    swept(study, folder)
    files = [folder / "chosen" / "design-0" / "front" / "metrics.json",
             *(folder / "evidence" / "design-0" / f"evidence.{ending}" for ending in ("csv", "html"))]  # fmt: skip
    for path in files:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("of 20 N", encoding="utf-8")
    assert swept(study, folder).removed == ()
    assert all(path.is_file() for path in files)
    outcome = swept(study.constraint("peak force of the run", maximum=60.0), folder)  # the same runs, other limits
    assert outcome.removed == (Path("evidence/design-0/evidence.csv"), Path("evidence/design-0/evidence.html"))
    assert files[0].is_file()
    outcome = swept(small_study(vary=[]).vary(LATCH, values=[40.0]), folder)
    assert outcome.removed == (Path("chosen"),)
    assert not files[0].parent.exists()
    assert overview(study.setup(), outcome).endswith("; removed, of the study that was there before: chosen")


def test_studies_side_by_side_share_their_results(tmp_path: Path) -> None:
    swept(small_study(), tmp_path / "one")
    # Another quantity varies; the values of two of its designs are those of two designs of the first.
    other = small_study(
        vary=[{"quantity": LATCH, "values": [20.0, 40.0]}, {"quantity": SPRING, "values": [948.0, 1500.0]}]
    )
    outcome = swept(other, tmp_path / "two")
    assert (outcome.ran, outcome.reused) == (2, 2)


@pytest.mark.parametrize("change", ["speed", "duration", "time"])
def test_another_collision_is_another_run(change: str, tmp_path: Path) -> None:
    swept(small_study(), tmp_path / "one")
    other = small_study()
    if change == "duration":
        other.document["scenario"]["duration"] = 0.21
    else:
        other.document["collision"][0][change] *= 1.01
    assert swept(other, tmp_path / "two").ran == 4


def test_failed_designs_are_kept_with_their_reason(tmp_path: Path) -> None:
    study = small_study(vary=[{"quantity": LATCH, "values": [20.0]}]).vary("collision.offset", values=[0.0, 0.9, 0.1])
    study.vary("testbed.solver.method", values=[0])
    study.tolerance("testbed.bumper.travel", absolute=0.2).tolerances(samples=2, kind="corners")
    outcome = swept(study, tmp_path / "study")
    assert outcome.stored == outcome.runs == 9
    runs = stored_runs(tmp_path / "study")
    status, message = runs["status"].reshape(3, 3), runs["message"].reshape(3, 3)
    assert (status[1] == "refused").all()
    assert all("collision.offset: 0.9 is not allowed" in text for text in message[1])
    # A travel of 0.12 - 0.2 m is below what the model allows: the library says so.
    assert status[0].tolist() == ["ok", "wrong", "ok"]
    assert "travel" in message[0, 1]
    assert np.isnan(runs["peak force of the run"].reshape(3, 3)[1]).all()
    assert outcome.failed == 5


def test_what_cannot_be_is_not_taken_for_what_can(tmp_path: Path) -> None:
    outline = plan_runs(small_study().setup()).cases[0].outline
    end = 0.5 * float(np.hypot(*(outline[1] - outline[0])))
    # 0.9 m is beyond the end of the side: the slider is never placed, but its row may equal that of a run at the end.
    study = small_study(vary=[], part_runs=1).vary("collision.offset", values=[0.9, end])
    swept(study, tmp_path / "study")
    assert stored_runs(tmp_path / "study")["status"].tolist() == ["refused", "ok"]


def test_an_interrupted_batch_is_freed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[RunningWork] = []

    def interrupted(part: RunningWork, _timeout_s: float) -> tuple[bool, int]:
        started.append(part)
        raise KeyboardInterrupt

    monkeypatch.setattr(RunningWork, "wait", interrupted)
    outcome = swept(small_study(), tmp_path / "study")
    assert outcome.interrupted
    assert (outcome.stored, outcome.ran) == (0, 0)
    assert not started[0]._handle, "the library's threads may still write"
    assert not part_files(tmp_path / "study")


def test_two_processes_do_not_share_a_folder(tmp_path: Path) -> None:
    swept(small_study(), tmp_path / "study")
    store = Store(tmp_path / "study", "0" * 64)
    code = "import sys, pathlib; from giveway.study.store import Store; Store(pathlib.Path(sys.argv[1]), '1' * 64)"
    try:
        found = subprocess.run(
            [sys.executable, "-c", code, str(tmp_path / "study")], capture_output=True, text=True, check=False
        )
    finally:
        store.close()
    assert found.returncode != 0
    assert f"is in use by another giveway process (pid {os.getpid()})" in found.stderr
    Store(tmp_path / "study", "0" * 64).close()


def test_a_folder_of_something_else_is_refused(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear", encoding="utf-8")
    with pytest.raises(FileError, match="holds no study"):
        swept(small_study(), tmp_path / "mine")
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["letter.txt"]


def test_a_kill_while_the_first_manifest_is_written_is_no_matter(tmp_path: Path) -> None:
    (tmp_path / "study" / "parts").mkdir(parents=True)
    (tmp_path / "study" / ".manifest.json-abc").write_text("{", encoding="utf-8")
    assert swept(small_study(), tmp_path / "study").ran == 4
    assert not list((tmp_path / "study").glob(".manifest*"))


def test_the_manifest_says_where_it_comes_from(tmp_path: Path) -> None:
    swept(small_study(), tmp_path / "study")
    manifest = read_manifest(tmp_path / "study")
    assert manifest["complete"] is True
    assert manifest["runs"] == 4
    assert manifest["study"]["vary"][0]["quantity"] == LATCH
    assert len(manifest["library"]["library_sha256"]) == 64
    assert {"giveway", "numpy", "scipy", "SALib", "pyarrow"} <= set(manifest["versions"])
    assert manifest["seed"] == 1


def test_a_broken_part_is_named(tmp_path: Path) -> None:
    swept(small_study(), tmp_path / "study")
    part = part_files(tmp_path / "study")[0]
    part.write_bytes(part.read_bytes()[:100])
    with pytest.raises(FileError, match=r"part-000000000.*delete it"):
        swept(small_study(), tmp_path / "study")


def test_a_part_is_read_by_the_names_that_its_metrics_had(tmp_path: Path) -> None:
    small_study().run(tmp_path / "s")
    part = part_files(tmp_path / "s")[0]
    table = pyarrow.parquet.read_table(part)
    names = ["bumper travel" if name == "bumper compression" else name for name in table.column_names]
    pyarrow.parquet.write_table(table.rename_columns(names), part)
    column = read_part(part, ["bumper compression", "run"])
    assert column.column_names == ["bumper compression", "run"]
    assert column["bumper compression"].equals(table["bumper compression"])


def test_a_broken_part_beside_it_is_no_matter(tmp_path: Path) -> None:
    swept(small_study(), tmp_path / "one")
    part_files(tmp_path / "one")[0].write_bytes(b"PAR1")
    assert swept(small_study(), tmp_path / "two").ran == 4


def test_keys_are_found_before_and_after_they_are_merged() -> None:
    index, keys = KeyIndex(), [os.urandom(16) for _ in range(2000)]
    for first in range(0, 2000, 50):
        index.add(Path(f"{first}"), keys[first : first + 50])
    found = index.find([keys[1234], os.urandom(16), keys[0], b""])
    assert index.files[found[0, 0]] == Path("1200")
    assert found[:, 1].tolist() == [34, -1, 0, -1]


def test_ctrl_c_keeps_the_parts_and_says_how_to_go_on(tmp_path: Path) -> None:
    text = """
schema_version = 1
part_runs = 4
[scenario]
duration = 0.2
bumper = "magnetic"
[[collision]]
speed = 0.5
edge = 0
time = 0.12
[[vary]]
quantity = "testbed.bumper.latch_force"
low = 0.0
high = 90.0
levels = 3000
"""
    (tmp_path / "long.toml").write_text(text, encoding="utf-8")
    out, said = interrupt(tmp_path, ["sweep", "long.toml", "--out", "long"], parts=2)
    assert "`giveway sweep long.toml --out long` goes on from there" in said
    stored = stored_runs(tmp_path / "long")["run"]
    assert len(stored) >= 8
    assert f"{len(stored):,} of 3,000 runs are stored" in out
    assert not read_manifest(tmp_path / "long")["complete"]
