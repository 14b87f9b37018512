"""`python -m verify.fmu_files --count N`: try that many files; the last line is JSON. `--help` says more."""

from __future__ import annotations

import argparse
import json
import os
import resource
import select
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

from verify.fmu_files.faults import FAULTS
from verify.fmu_files.make import MAKERS, Base, bases
from verify.fmu_files.trial import LONGEST_S, MOST_MB, Folders, Trial, try_seed

BATCH = 100  # files per process, so that memory that a file leaves behind does not accumulate
SILENCE_S = 12.0 * LONGEST_S  # wall time; after that the process hangs where the alarm clock cannot interrupt it
MEMORY_BYTES = 4_000_000_000  # address space: stops a runaway process
MOST_SHOWN = 20


def main() -> int:
    parser = argparse.ArgumentParser(prog="verify.fmu_files", description="Fuzz giveway's FMU commands.")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--count", type=int, default=300, help="how many seeds")
    parser.add_argument("--kind", choices=list(MAKERS), default="", help="only files of this kind")
    parser.add_argument("--fault", choices=list(FAULTS), help="plant this fault, and stop when it is seen")
    arguments = parser.parse_args()
    healthy = _load()
    if arguments.fault:
        FAULTS[arguments.fault].plant()
        arguments.kind = FAULTS[arguments.fault].kind
    seeds = range(arguments.first, arguments.first + arguments.count)
    kinds: Counter[str] = Counter()
    codes: Counter[str] = Counter()
    bad: list[str] = []
    slowest = largest = 0.0
    folder = Path(tempfile.mkdtemp(prefix="giveway-fuzz-")).resolve()
    try:
        for trial in _trials(seeds, healthy, folder, arguments.kind):
            kinds[trial.kind] += 1
            codes.update(f"{command} {code}" for command, code in trial.codes.items())
            slowest, largest = max(slowest, trial.seconds), max(largest, trial.memory_mb)
            for words in trial.bad:
                bad.append(f"seed {trial.seed} ({trial.kind}): {words}")
                print(f"bad: {bad[-1]}", flush=True)
            if len(bad) >= (1 if arguments.fault else MOST_SHOWN):
                break
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    children_mb = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0
    found = {
        "files": sum(kinds.values()),
        "kinds": dict(sorted(kinds.items())),
        "codes": dict(sorted(codes.items())),
        "bad": len(bad),
        "slowest_s": round(slowest, 2),
        "largest_mb": round(max(largest, children_mb)),
    }
    print(json.dumps(found))
    return 1 if bad or children_mb > MOST_MB else 0


def _load() -> list[Base]:
    """Everything that the commands import, once, and the healthy files."""
    import fmpy.model_description  # noqa: F401
    import giveway.fmu_tools.check
    import giveway.fmu_tools.command
    import giveway.fmu_tools.info
    import giveway.fmu_tools.page
    import giveway.fmu_tools.run  # noqa: F401
    import lief  # noqa: F401
    import lxml.etree  # noqa: F401
    from giveway.base import native

    return bases([native.fmu("bumper", version).read_bytes() for version in (2, 3)])


def _trials(seeds: range, healthy: list[Base], folder: Path, kind: str) -> Iterator[Trial]:
    """Runs each batch in a separate process; a file that kills or hangs it counts as bad, and the next process
    continues."""
    at = seeds.start
    while at < seeds.stop:
        batch = range(at, min(at + BATCH, seeds.stop))
        for line in _batch(batch, healthy, Folders(folder / "cage", folder / "outside"), kind):
            trial = Trial(at, "?", bad=[line]) if isinstance(line, str) else Trial(**line)
            at = trial.seed + 1
            yield trial
            if not trial.codes:
                break


def _batch(seeds: range, healthy: list[Base], folders: Folders, kind: str) -> Iterator[dict[str, Any] | str]:
    """Yields the trials as they finish; if the process ends too early, also how it ended."""
    receive, send = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(receive)
        _work(seeds, healthy, folders, kind, send)
    os.close(send)
    left = len(seeds)
    try:
        with os.fdopen(receive, "rb", buffering=0) as stream:
            text = b""
            end = time.monotonic() + SILENCE_S
            while left and time.monotonic() < end:
                if not select.select([stream], [], [], 1.0)[0]:
                    continue
                piece = stream.read(1 << 16)
                if not piece:
                    break
                *lines, text = (text + piece).split(b"\n")
                for line in lines:
                    left -= 1
                    end = time.monotonic() + SILENCE_S
                    yield json.loads(line)
    finally:
        os.kill(child, signal.SIGKILL if left else 0)
        _, status = os.waitpid(child, 0)
    if left:
        how = os.waitstatus_to_exitcode(status)
        name = signal.Signals(-how).name if how < 0 else f"exit code {how}"
        yield f"its process ended with {name}" if name != "SIGKILL" else f"no answer for {SILENCE_S:g} s"


def _work(seeds: range, healthy: list[Base], folders: Folders, kind: str, send: int) -> None:
    """In the child: never returns."""
    try:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        folders.make()
        os.chdir(folders.cage)
        with os.fdopen(send, "w") as stream:
            for seed in seeds:
                print(json.dumps(asdict(try_seed(seed, healthy, folders, kind))), file=stream, flush=True)
    except BaseException:
        traceback.print_exc()
        os._exit(9)
    os._exit(0)


if __name__ == "__main__":
    sys.exit(main())
