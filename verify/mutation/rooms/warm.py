"""A process that has imported the modules that every test needs, and forks for each run of tests.

It reads requests from standard input and answers on standard output, a line of JSON each. giveway itself is not
imported before the fork, since its code that runs on import must contain the mutant, too.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import resource
import signal
import sys
import time
from typing import Any

IMPORTED = (
    "_pytest.assertion.rewrite",
    "pytest",
    "numpy",
    "scipy.optimize",
    "scipy.signal",
    "xarray",
    "pyarrow.parquet",
)
IMPORTED_LATE = ("fmpy", "lxml.etree", "matplotlib.figure", "rich.table", "typer", "jinja2", "tomlkit")
MEMORY_GIB = 6
POLL_S = 0.02


def main() -> None:
    for name in (*IMPORTED, *IMPORTED_LATE):
        importlib.import_module(name)
    answers = os.fdopen(os.dup(1), "w")
    for line in sys.stdin:
        print(json.dumps(_run(json.loads(line))), file=answers, flush=True)


def _run(request: dict[str, Any]) -> dict[str, Any]:
    start = time.monotonic()
    pid = os.fork()
    if pid == 0:
        try:
            code = _tests(request)
        finally:
            os._exit(code if "code" in locals() else 3)
    status = 0
    ended = False
    while not ended and time.monotonic() - start < request["wall_s"]:
        time.sleep(POLL_S)
        done, status = os.waitpid(pid, os.WNOHANG)
        ended = done != 0
    with contextlib.suppress(ProcessLookupError):
        os.killpg(pid, signal.SIGKILL)  # any remaining processes, also when the tests have ended normally
    if not ended:
        os.waitpid(pid, 0)
        return {"code": "time"}
    return {"code": os.waitstatus_to_exitcode(status)}


def _tests(request: dict[str, Any]) -> int:
    os.setsid()
    output = os.open(request["output"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    null = os.open(os.devnull, os.O_RDONLY)
    for target, source in ((0, null), (1, output), (2, output)):
        os.dup2(source, target)
    resource.setrlimit(resource.RLIMIT_CPU, (request["cpu_s"], request["cpu_s"]))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_GIB * 2**30, MEMORY_GIB * 2**30))
    os.environ.update(request["environment"])
    import pytest

    return int(pytest.main(request["arguments"]))


if __name__ == "__main__":
    main()
