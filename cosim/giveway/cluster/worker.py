"""What runs on a worker: it says what it is, and computes parts.

A worker shows what it is by running the golden works: two machines that get the same bits from them, with the same
version and the same variables, give the same bits for everything, whichever compiler, processor and lanes they have.
"""

from __future__ import annotations

import dataclasses
import functools
import pickle
import platform
import socket
import time
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

from giveway.base.version import VERSION
from giveway.library.batch_library import library, widest_lanes
from giveway.library.work import CaseWork, Done, Work, run_work

__all__ = ["Parcel", "compute", "facts", "introduce", "packed", "parcel_of"]

_known_as: set[str] = set()  # names under which this process was asked what it is


@dataclass(frozen=True)
class Parcel:
    """Work on its way: plans and pushes are long, hardly differ between parts, and are packed once."""

    cases: bytes
    work: Work


def parcel_of(work: Work, cases: bytes) -> Parcel:
    """``work``, whose cases are packed in ``cases`` already."""
    return Parcel(cases, dataclasses.replace(work, cases=()))


def packed(cases: tuple[CaseWork, ...]) -> bytes:
    """What several works share; a plan at rest is hardly more than its length."""
    return zlib.compress(pickle.dumps(cases), 1)


@functools.lru_cache(maxsize=16)
def _unpacked(cases: bytes) -> tuple[CaseWork, ...]:
    found = pickle.loads(zlib.decompress(cases))
    assert isinstance(found, tuple)
    return found


def facts(golden: Sequence[Work]) -> dict[str, str]:
    """What must be the same on all machines: version, variables, and what the golden works give."""
    tokens = {f"variables of the {name}": model.token for name, model in library().models.items()}
    digests = {f"golden runs, {work.method}": run_work(work).digest() for work in golden}
    return {"version of giveway": VERSION, **tokens, **digests}


def introduce(name: str, golden: Sequence[Work]) -> tuple[dict[str, str], str]:
    """The facts of this worker, and in words which machine it is; from now on it computes for ``name``."""
    found = facts(golden)
    _known_as.add(name)
    return found, f"{socket.gethostname()}, {platform.machine()}, {widest_lanes()} lanes"


def compute(name: str, parcel: Parcel) -> tuple[Done, float] | None:
    """Results and seconds; None: this process was never asked what it is, perhaps one that died was."""
    if name not in _known_as:
        return None
    started = time.perf_counter()
    done = run_work(dataclasses.replace(parcel.work, cases=_unpacked(parcel.cases)))
    return done, time.perf_counter() - started
