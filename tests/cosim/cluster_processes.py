"""A scheduler and workers of Dask as processes of their own on the loopback, which tests may kill; and odd workers."""

from __future__ import annotations

import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import giveway

PACKAGE = Path(giveway.__file__).parent
HOST = "127.0.0.1"
START_S = 120.0
# A package that is installed in place is found before all paths, unless its finder is taken out.
START = """
import runpy, sys
package, module, *arguments = sys.argv[1:]
if package:
    sys.meta_path[:] = [one for one in sys.meta_path if "editable" not in type(one).__module__]
    sys.path.insert(0, package)
sys.argv = [module, *arguments]
runpy.run_module(module, run_name="__main__")
"""


def free_port() -> int:
    with socket.socket() as one:
        one.bind((HOST, 0))
        return int(one.getsockname()[1])


@contextmanager
def started(module: str, *arguments: str, package: Path | None = None) -> Iterator[subprocess.Popen[bytes]]:
    """A process of Dask; ``package`` is the folder of another giveway than ours."""
    command = [sys.executable, "-c", START, str(package or ""), f"distributed.cli.{module}", *arguments]
    with subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    ) as process:
        try:
            yield process
        finally:
            process.kill()


@contextmanager
def scheduler(port: int) -> Iterator[subprocess.Popen[bytes]]:
    """A scheduler that answers."""
    with started("dask_scheduler", "--host", HOST, "--port", str(port), "--no-dashboard", "--no-show") as process:
        end = time.monotonic() + START_S
        while True:
            try:
                with socket.create_connection((HOST, port), 1.0):
                    break
            except OSError:
                assert time.monotonic() < end, "the scheduler does not start"
                assert process.poll() is None, "the scheduler has ended"
                time.sleep(0.05)
        yield process


@contextmanager
def worker(address: str, package: Path | None = None) -> Iterator[subprocess.Popen[bytes]]:
    """A worker with one thread and without a nanny: a kill is its end."""
    options = ("--no-nanny", "--nthreads", "1", "--memory-limit", "0", "--host", HOST, "--no-dashboard")
    with started("dask_worker", address, *options, package=package) as process:
        yield process


def other_giveway(folder: Path, file: str, pattern: bytes, replacement: bytes) -> Path:
    """A copy of the package in ``folder``, with what ``pattern`` finds in one of its files replaced."""
    copy = folder / "giveway"
    ignored = shutil.ignore_patterns("__pycache__", "*.fmu")
    shutil.copytree(PACKAGE, copy, ignore=ignored)
    found, count = re.subn(pattern, lambda _: replacement, (copy / file).read_bytes(), flags=re.DOTALL)
    assert count > 0, f"nothing to replace in {file}"
    (copy / file).write_bytes(found)
    return folder
