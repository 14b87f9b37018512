"""The examples that start workers: over SSH, and as jobs of SLURM; a study runs on both."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import pytest
from cluster_processes import HOST, free_port
from giveway.study.engine import sweep
from study_helpers import small_study, stored_runs

pytest.importorskip("distributed")

EXAMPLES = Path(__file__).parents[2] / "examples" / "cluster"
START_S = 120.0
# SLURM is not here: these take its commands' place, and run the job script in the background.
SBATCH = """\
#!/bin/sh
for script; do :; done
cp "$script" "$0.job.$$"
setsid sh "$0.job.$$" > "$0.log" 2>&1 &
echo "Submitted batch job $!"
"""
SCANCEL = """\
#!/bin/sh
for job; do kill -- "-$job"; done
"""


@contextmanager
def example(name: str, *arguments: str, environment: Mapping[str, str]) -> Iterator[str]:
    """The address that a running example says."""
    with subprocess.Popen(
        [sys.executable, str(EXAMPLES / name), *arguments],
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        watch = threading.Timer(START_S, process.kill)
        watch.start()
        try:
            assert process.stdout is not None
            said = process.stdout.readline()
            assert "--dask tcp://" in said, said
            yield said.rpartition(" ")[2].strip()
        finally:
            watch.cancel()
            process.send_signal(signal.SIGINT)
            process.wait(timeout=START_S)


def check_study(address: str, folder: Path) -> None:
    outcome = sweep(small_study().setup(), folder / "b" / "there", dask=address)
    assert outcome.stored == outcome.ran == 4
    sweep(small_study().setup(), folder / "a" / "here", threads=1)
    names = ("status", "peak force of the run")
    here, there = (stored_runs(folder / name) for name in ("a/here", "b/there"))
    for name in names:
        assert here[name].tolist() == there[name].tolist()


@pytest.mark.deep
def test_workers_are_slurm_jobs(tmp_path: Path) -> None:
    pytest.importorskip("dask_jobqueue")
    for name, text in (("sbatch", SBATCH), ("scancel", SCANCEL)):
        (tmp_path / name).write_text(text, encoding="utf-8")
        (tmp_path / name).chmod(0o755)
    path = {"PATH": f"{tmp_path}:{os.environ['PATH']}"}
    with example("slurm_workers.py", "--port", str(free_port()), "--interface", "lo", environment=path) as address:
        check_study(address, tmp_path)


def test_a_slurm_job_asks_for_what_was_asked() -> None:
    pytest.importorskip("dask_jobqueue")
    asked = ["--cores", "16", "--memory", "8GB", "--walltime", "04:00:00", "--queue", "compute", "--account", "me"]
    command = [sys.executable, str(EXAMPLES / "slurm_workers.py"), "--show", "--port", "0", "--interface", "lo", *asked]
    script = subprocess.run([*command, "--python", "/x/python"], capture_output=True, text=True, check=True).stdout
    for line in ("-p compute", "-A me", "-n 1", "--cpus-per-task=16", "--mem=8G", "-t 04:00:00"):
        assert f"#SBATCH {line}\n" in script
    worker = next(line for line in script.splitlines() if "dask_worker" in line)
    assert worker.startswith("/x/python -m distributed.cli.dask_worker tcp://127.0.0.1:")
    assert "--nthreads 16 " in worker
    assert "--lifetime 14280s --lifetime-stagger 60s" in worker


@contextmanager
def ssh_server(folder: Path) -> Iterator[None]:
    """A real SSH server on the loopback; ``folder`` becomes the home folder of who may log in."""
    asyncssh = pytest.importorskip("asyncssh")
    port, loop, started = free_port(), asyncio.new_event_loop(), threading.Event()
    keys = {name: asyncssh.generate_private_key("ssh-ed25519") for name in ("host", "user")}
    ssh = folder / ".ssh"
    ssh.mkdir()
    (ssh / "known_hosts").write_text(f"[{HOST}]:{port} {keys['host'].export_public_key().decode()}", encoding="utf-8")
    keys["user"].write_private_key(ssh / "key")
    (ssh / "key").chmod(0o600)
    keys["user"].write_public_key(ssh / "authorized")
    (ssh / "config").write_text(f"Host {HOST}\n  Port {port}\n  IdentityFile {ssh}/key\n", encoding="utf-8")

    async def run(process: asyncssh.SSHServerProcess) -> None:
        child = await asyncio.create_subprocess_shell(
            process.command, stdin=-1, stdout=-1, stderr=-1, start_new_session=True
        )
        try:
            await process.redirect(child.stdin, child.stdout, child.stderr)
            status = await child.wait()
            await process.stdout.drain()  # a command may end before its output is read
            await process.stderr.drain()
            process.exit(status)
        finally:
            if child.returncode is None:
                os.killpg(child.pid, signal.SIGKILL)

    async def serve() -> None:
        await asyncssh.create_server(
            asyncssh.SSHServer,
            HOST,
            port,
            server_host_keys=[keys["host"]],
            authorized_client_keys=str(ssh / "authorized"),
            process_factory=run,
            encoding=None,
        )
        started.set()

    loop.create_task(serve())
    thread = threading.Thread(target=loop.run_forever, daemon=True)
    thread.start()
    assert started.wait(10.0)
    try:
        yield
    finally:
        loop.call_soon_threadsafe(loop.stop)
        thread.join()


@pytest.mark.deep
def test_workers_are_started_over_ssh(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    with (
        ssh_server(home),
        example(
            "ssh_workers.py", HOST, HOST, "--threads", "1", "--port", str(free_port()), environment={"HOME": str(home)}
        ) as address,
    ):
        check_study(address, tmp_path)
