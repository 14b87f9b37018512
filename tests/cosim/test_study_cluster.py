"""Parts on workers of Dask: the bits of one machine, whoever dies; and who may help."""

from __future__ import annotations

import gc
import os
import random
import re
import signal
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cluster_processes import HOST, free_port, other_giveway, scheduler, worker
from giveway.base.errors import ClusterError, GivewayError
from giveway.cli import _main
from giveway.cluster import pool
from giveway.study import Study, study_file
from giveway.study.engine import sweep
from giveway.study.golden import golden_works
from study_helpers import LATCH, LATCH_STUDY, SPRING, part_files, small_study, stored_runs

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")

STUDY = f"""\
schema_version = 1
part_runs = 10
{LATCH_STUDY}levels = 30
[[vary]]
quantity = "testbed.bumper.spring_rate"
low = 500.0
high = 2500.0
levels = 20
"""


def many(latches: int, springs: int = 12, **changes: Any) -> Study:
    study = small_study(vary=[], **{"part_runs": 20, **changes})
    return study.vary(LATCH, low=0.0, high=90.0, levels=latches).vary(SPRING, low=500.0, high=2500.0, levels=springs)


def same_runs(one: Path, other: Path) -> None:
    first, second = stored_runs(one), stored_runs(other)
    assert first.keys() == second.keys()
    for name in first:
        np.testing.assert_array_equal(first[name], second[name], name)


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    options = {"host": HOST, "dashboard_address": f"{HOST}:0", "memory_limit": 0, "silence_logs": 60}
    # 15 s after a worker was lost Dask gives it up, if another one just then starts in its place.
    patience = dask.config.set({"distributed.deploy.lost-worker-timeout": "1 hour"})
    with patience, distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, **options) as found:
        yield found


class Killer(threading.Thread):
    """Kills a worker process now and then; its nanny starts another one."""

    def __init__(self, cluster: Any, kills: int, folder: Path) -> None:
        super().__init__(daemon=True)
        self._cluster, self._wanted, self._folder = cluster, kills, folder
        self.kills, self._pick = 0, random.Random(7)

    def run(self) -> None:
        dead: set[int] = set()
        while self.kills < self._wanted:
            time.sleep(self._pick.uniform(0.2, 0.6))
            alive = [nanny.process.pid for nanny in self._cluster.workers.values() if nanny.process is not None]
            alive = [pid for pid in alive if pid is not None and pid not in dead]
            if alive and part_files(self._folder):
                dead.add(pid := self._pick.choice(alive))
                os.kill(pid, signal.SIGKILL)
                self.kills += 1


def sweep_while_workers_die(cluster: Any, study: Study, kills: int, folder: Path) -> None:
    whole, killed = folder / "a" / "whole", folder / "b" / "killed"  # not side by side: no shared results
    sweep(study.setup(), whole, threads=2)
    killer = Killer(cluster, kills, killed)
    killer.start()
    outcome = sweep(study.setup(), killed, dask=cluster.scheduler_address)
    assert killer.kills > 0, "no worker was killed: make the study longer"
    assert outcome.stored == outcome.runs
    same_runs(whole, killed)


def test_workers_die_and_the_bits_are_those_of_one_machine(cluster: Any, tmp_path: Path) -> None:
    sweep_while_workers_die(cluster, many(90), 2, tmp_path)


@pytest.mark.deep
def test_many_workers_die(cluster: Any, tmp_path: Path) -> None:
    sweep_while_workers_die(cluster, many(600, part_runs=40, method="fixed-step"), 12, tmp_path)
    sweep_while_workers_die(cluster, many(600, part_runs=40), 12, tmp_path / "exact")


def test_a_search_goes_the_same_way(cluster: Any, tmp_path: Path) -> None:
    pytest.importorskip("pymoo")
    study = small_study(vary=[]).vary(LATCH, low=0.0, high=60.0).vary(SPRING, low=500.0, high=2500.0)
    study.objective("peak force of the run").objective("bumper compression")
    options: dict[str, Any] = {"designs": 36, "population": 12, "progress": False}
    study.optimise(tmp_path / "a" / "here", threads=2, **options)
    study.optimise(tmp_path / "b" / "there", dask=cluster.scheduler_address, **options)
    same_runs(tmp_path / "a" / "here", tmp_path / "b" / "there")


def patched_double(old: float, new: float) -> dict[str, Any]:
    return {"pattern": re.escape(struct.pack("<d", old)), "replacement": struct.pack("<d", new)}


ODD = {
    "another version": (
        {"file": "base/version.py", "pattern": rb"VERSION = importlib.*?\(.*?\)", "replacement": b'VERSION = "9.9"'},
        "version of giveway: 9.9, here ",
    ),
    "no worker at all": (
        {"file": "cluster/worker.py", "pattern": rb"from giveway.base.version", "replacement": b"from giveway.none"},
        "No module named 'giveway.none'",
    ),
    "another gravity": (
        {"file": "native/giveway_batch.so", **patched_double(9.81, 9.810000000000002)},
        "golden runs, event-exact: ",
    ),
    "one wrong bit": (
        {
            "file": "cluster/worker.py",
            "pattern": rb"    return done, time",
            "replacement": b"    done.numbers[0, 5] = done.numbers[0, 5] * 1.0000000000000002\n    return done, time",
        },
        " of a run: ",
    ),
}


@pytest.mark.parametrize("name", ["another gravity", pytest.param("one wrong bit", marks=pytest.mark.deep)])
def test_an_odd_worker_is_refused_and_the_others_go_on(
    name: str, cluster: Any, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    changed, reason = ODD[name]
    package = other_giveway(tmp_path / "other", **changed)
    setup = many(60).setup()
    with worker(cluster.scheduler_address, package), distributed.Client(cluster, set_as_default=False) as client:
        client.wait_for_workers(3, timeout=60)
        outcome = sweep(setup, tmp_path / "b" / "study", dask=cluster.scheduler_address)
    assert outcome.stored == outcome.runs
    said = [line for line in capfd.readouterr().err.splitlines() if "is refused" in line]
    assert len(said) == 1
    assert said[0].startswith("giveway: worker tcp://127.0.0.1:")
    assert reason in said[0]
    sweep(setup, tmp_path / "a" / "study", threads=2)
    same_runs(tmp_path / "a" / "study", tmp_path / "b" / "study")


@pytest.mark.deep
@pytest.mark.parametrize("name", ODD)
def test_with_odd_workers_only_it_ends(name: str, tmp_path: Path) -> None:
    changed, reason = ODD[name]
    package = other_giveway(tmp_path / "other", **changed)
    address = f"tcp://{HOST}:{(port := free_port())}"
    with scheduler(port), worker(address, package):
        began = time.monotonic()
        with pytest.raises(ClusterError, match="has no worker that is accepted: worker tcp://") as caught:
            sweep(small_study().setup(), tmp_path / "study", dask=address)
    assert reason in str(caught.value)
    assert time.monotonic() - began < pool.WORKERS_WAIT_S
    assert not part_files(tmp_path / "study")


@pytest.mark.deep
def test_a_dead_scheduler_takes_nothing_with_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study, folder = many(100), tmp_path / "b" / "study"
    address = f"tcp://{HOST}:{(port := free_port())}"

    def kill(process: subprocess.Popen[bytes]) -> None:
        while len(part_files(folder)) < 3:
            time.sleep(0.01)
        process.kill()

    with scheduler(port) as process, worker(address), monkeypatch.context() as impatient:
        impatient.setattr(pool, "CONNECT_S", 3.0)  # nobody starts it again while the command waits
        threading.Thread(target=kill, args=(process,), daemon=True).start()
        with pytest.raises(
            ClusterError, match="has lost its scheduler; what is stored is kept; the same command goes on"
        ):
            sweep(study.setup(), folder, dask=address)
    stored = len(part_files(folder))
    assert stored >= 3
    with scheduler(port), worker(address):
        outcome = sweep(study.setup(), folder, dask=address)
    assert outcome.ran == outcome.runs - 20 * stored, "a stored part was run again"
    sweep(study.setup(), tmp_path / "a" / "study", threads=2)
    same_runs(tmp_path / "a" / "study", folder)


@pytest.mark.deep
def test_a_new_scheduler_at_the_same_address_is_found(tmp_path: Path) -> None:
    study, folder = many(300), tmp_path / "b" / "study"
    address = f"tcp://{HOST}:{(port := free_port())}"
    ended: list[Any] = []
    with scheduler(port) as first, worker(address):
        running = threading.Thread(target=lambda: ended.append(sweep(study.setup(), folder, dask=address)))
        running.start()
        while len(part_files(folder)) < 3:
            time.sleep(0.01)
        first.kill()
        first.wait()
        with scheduler(port), worker(address):
            running.join(120.0)
    assert ended, "it did not go on"
    assert ended[0].stored == ended[0].runs
    sweep(study.setup(), tmp_path / "a" / "study", threads=2)
    same_runs(tmp_path / "a" / "study", folder)


def children(pid: int) -> set[int]:
    threads = Path(f"/proc/{pid}/task").glob("*/children")  # Dask starts its processes from a thread
    found = {int(one) for path in threads for one in path.read_text().split()}
    return found.union(*(children(one) for one in found))


def runs(pid: int) -> bool:
    """Whether the process is there, other than dead with nobody who asks for it."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2][0] not in "XZ"
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_ctrl_c_ends_it_cleanly_and_it_goes_on(tmp_path: Path) -> None:
    (tmp_path / "latch.toml").write_text(STUDY, encoding="utf-8")
    options = ["--out", "b/x", "--threads", "2", "--dask", "local"]
    command = [sys.executable, "-m", "giveway", "sweep", "latch.toml", *options]
    with subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        while len(part_files(tmp_path / "b" / "x")) < 3:
            time.sleep(0.02)
            assert process.poll() is None, process.communicate()
        helpers = children(process.pid)
        assert len(helpers) >= 2
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: all processes of the command get it
        out, said = process.communicate(timeout=120)
    assert process.returncode == 130, out + said
    assert "Traceback" not in said
    assert "`giveway sweep latch.toml --out b/x --dask local` goes on from there" in said
    end = time.monotonic() + 10.0
    while any(map(runs, helpers)):
        assert time.monotonic() < end, "left behind"
        time.sleep(0.05)
    setup, stored = study_file.read(tmp_path / "latch.toml"), len(part_files(tmp_path / "b" / "x"))
    assert sweep(setup, tmp_path / "b" / "x", threads=2).ran == 600 - 10 * stored
    sweep(setup, tmp_path / "a" / "x", threads=2)
    same_runs(tmp_path / "a" / "x", tmp_path / "b" / "x")


def test_ctrl_c_while_a_result_comes_leaves_no_complaint(cluster: Any, caplog: pytest.LogCaptureFixture) -> None:
    with pool.joined(cluster.scheduler_address, None, golden_works()) as workers:
        client, gather = workers._client, workers._client._gather

        async def late(*told: Any, **options: Any) -> Any:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.5)  # the loop hears of it and of what follows at once, when the fetch is about to look
            return await gather(*told, **options)

        client._gather = late
        with pytest.raises(KeyboardInterrupt):
            workers.wait(60.0)
    gc.collect()
    assert [record for record in caplog.records if record.name == "asyncio"] == []


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--dask", "nowhere"], "giveway: --dask: nowhere is not allowed; allowed: local, or the address of a Dask "),
        (
            ["--dask", f"tcp://{HOST}:1"],
            f"giveway: --dask: tcp://{HOST}:1 is not allowed; allowed: local, or the address",
        ),
        (
            ["--dask", f"tcp://{HOST}:1", "--threads", "2"],
            "giveway: threads: 2 is not allowed; allowed: nothing beside",
        ),
    ],
)
def test_a_wrong_address_is_refused(
    options: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "latch.toml").write_text(STUDY, encoding="utf-8")
    assert _main(["sweep", str(tmp_path / "latch.toml"), "--out", str(tmp_path / "x"), *options]) == 2
    assert capsys.readouterr().err.startswith(said)
    assert not (tmp_path / "x").exists()


def test_without_the_extra_it_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    (tmp_path / "latch.toml").write_text(STUDY, encoding="utf-8")
    assert _main(["sweep", str(tmp_path / "latch.toml"), "--out", str(tmp_path / "x"), "--dask", "local"]) == 2
    said = capsys.readouterr().err
    assert said == "giveway: distributed is not installed; `pip install 'giveway[dask]'` installs it\n"
    assert not (tmp_path / "x").exists()


def test_it_is_imported_only_where_it_is_needed(tmp_path: Path) -> None:
    (tmp_path / "latch.toml").write_text(STUDY, encoding="utf-8")
    code = (
        "import sys; from giveway.cli import _main; _main(['sweep', 'latch.toml', '--check']); "
        "print([name for name in ('dask', 'distributed') if name in sys.modules])"
    )
    found = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert found.stdout.splitlines()[-1] == "[]"


class Nobody:
    """A client of a scheduler without workers."""

    status = "running"

    def nthreads(self) -> dict[str, int]:
        return {}


def test_no_worker_is_waited_for_and_then_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "WORKERS_WAIT_S", 0.3)
    monkeypatch.setattr(pool, "LOOK_EVERY_S", 0.1)
    alone = pool.Pool(Nobody(), "tcp://x:1", golden_works(), print)
    assert alone.wait(0.1) == []
    with pytest.raises(ClusterError, match=r"--dask tcp://x:1: has had no worker for 0\.3 s; what is stored is kept"):
        alone.wait(5.0)
    assert issubclass(ClusterError, GivewayError)
