"""The workers of a Dask scheduler: who is accepted, who computes what, and what becomes of it if one dies.

Each task is bound to one worker that was accepted; the queue is kept here, so that nothing is lost with a scheduler.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import pickle
import signal
import socket
import sys
import time
import uuid
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import ClusterError, GivewayError
from giveway.base.extras import extra
from giveway.cluster import worker
from giveway.library.work import Done, Work, default_threads, result_columns, run_work

if TYPE_CHECKING:
    from giveway.library.work import CaseWork

__all__ = ["LOCAL", "Pool", "joined"]

LOCAL = "local"
EXTRA = "dask"
CONNECT_S = 30.0  # as long a scheduler may be away
REACHED_S = 5.0
WORKERS_WAIT_S = 60.0  # without any worker
GRACE_S = 5.0  # with refused ones only
LOOK_EVERY_S = 1.0
POLL_S = 0.02
FETCH_S = (1.0, 2.0, 4.0, 8.0, 16.0)  # tries to get a result whose worker may have died with it
CLOSE_S = 2.0
PART_S, PART_LEAST_S = 5.0, 2.0  # of work in a task
FIRST, MOST = 32, 32768  # runs in it
CHECKED_RUNS, CHECKED_SHARE = 4, 0.01  # of a part that are computed here, too; of the time of all parts
LOST_AT_MOST = 20  # workers, each with the same part


class _Call:
    """A function and its arguments: unpickling it on the worker calls the function.

    What travels through the scheduler is `pickle.loads` and bytes, so giveway need not be installed there.
    """

    def __init__(self, function: Callable[..., Any], *arguments: Any) -> None:
        self._told = function, arguments

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return self._told


@dataclass
class _Ticket:
    number: int
    work: Work
    lost: int = 0


@dataclass
class _Member:
    """A worker. ``asked``: what it will answer to the question what it is; None: it is accepted."""

    address: str
    threads: int
    asked: Any
    said: str = ""
    running: dict[Any, _Ticket] = field(default_factory=dict)
    rate: float = 0.0  # runs/s of a thread
    gave: list[int] = field(default_factory=list)


class Pool:
    """Give it work by number, and wait for what comes back."""

    def __init__(self, client: Any, address: str, golden: Sequence[Work], say: Callable[[str], None]) -> None:
        """``say`` is told, in words, which workers are refused and why."""
        self._client, self._address, self._golden, self._say = client, address, golden, say
        self._name = uuid.uuid4().hex
        self._facts = worker.facts(golden)
        self._members: dict[str, _Member] = {}
        self._futures: set[Any] = set()
        self._refused: dict[str, str] = {}
        self._waiting: deque[_Ticket] = deque()
        self._packed: tuple[tuple[CaseWork, ...], bytes] | None = None
        self._withdrawn: list[int] = []
        self._looked = -LOOK_EVERY_S
        self._idle_since: float | None = None
        self._computed_s = self._checked_s = 0.0

    @property
    def accepted(self) -> list[str]:
        """Addresses of the workers that compute."""
        return [member.address for member in self._accepted()]

    @property
    def refused(self) -> dict[str, str]:
        """Why which worker does not."""
        return dict(self._refused)

    def _accepted(self) -> list[_Member]:
        return [member for member in self._members.values() if member.asked is None]

    def wants(self, left: int) -> int:
        """How many runs a further part should have, if ``left`` are to be given out; 0: no part now."""
        members = self._accepted()
        threads = sum(member.threads for member in members)
        if not threads:
            return 0
        under_way = len(self._waiting) + sum(len(member.running) for member in members)
        rates = [member.rate for member in members if member.rate > 0.0]
        if not rates:
            return 0 if under_way else FIRST  # it shows how long they take
        rate = float(np.mean(rates))
        left_s = left / (rate * threads)
        ahead = len(members) if left_s > PART_S else 0  # one more for each, as long as there is plenty
        if under_way >= threads + ahead:
            return 0
        seconds = min(PART_S, max(PART_LEAST_S, 0.5 * left_s))
        return int(np.clip(seconds * rate, FIRST, MOST))

    def submit(self, number: int, work: Work) -> None:
        """Have ``work`` computed; `wait` gives it back by its ``number``."""
        self._waiting.append(_Ticket(number, work))
        self._give_out()

    def wait(self, timeout_s: float) -> list[tuple[int, Done | None]]:
        """What has come back, within ``timeout_s``; None: take back what came for this number before.

        Raises:
            ClusterError: no worker is left, or the scheduler is lost.
        """
        deadline = time.monotonic() + timeout_s
        while True:
            self._look()
            found: list[tuple[int, Done | None]] = []
            for member in list(self._members.values()):
                if member.asked is not None:
                    self._hear(member)
                for future in [one for one in member.running if one.status != "pending"]:
                    if future in member.running:  # else the member was refused meanwhile
                        found += self._take(member, future)
            found += [(number, None) for number in self._withdrawn]
            self._withdrawn = []
            self._give_out()
            if found or time.monotonic() >= deadline:
                return found
            time.sleep(POLL_S)

    def close(self) -> None:
        """Forget all that is under way."""
        with contextlib.suppress(Exception):  # a fetch that Ctrl-C broke off still looks for its future, once
            self._client.sync(asyncio.sleep, 0, callback_timeout=CLOSE_S)
        for future in list(self._futures):
            self._drop(future)
        self._members = {}

    def _task(self, address: str, *call: Any) -> Any:
        payload = pickle.dumps(_Call(*call), protocol=5)
        key = f"giveway-{uuid.uuid4().hex}"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that it is large
            future = self._client.submit(pickle.loads, payload, key=key, workers=[address], allow_other_workers=False)
        self._futures.add(future)
        return future

    def _drop(self, future: Any) -> None:
        """One that is left over complains when its client is gone, even if nobody but a traceback knows it."""
        self._futures.discard(future)
        with contextlib.suppress(Exception):  # on the way out, or when the other side is gone
            future.release()

    def _look(self) -> None:
        """Who is there?"""
        now = time.monotonic()
        if now - self._looked < LOOK_EVERY_S:
            return
        self._looked = now
        if self._client.status == "closed":
            raise self._gone("has lost its scheduler")
        there: dict[str, int] = {}
        if self._client.status == "running":
            with contextlib.suppress(OSError, TimeoutError):  # a scheduler that is dying
                there = self._client.nthreads()
        for address in [one for one in self._members if one not in there]:
            self._lose(address)
        for address in [one for one in self._refused if one not in there]:
            del self._refused[address]
        for address, threads in there.items():
            if address not in self._members and address not in self._refused:
                asked = self._task(address, worker.introduce, self._name, self._golden)
                self._members[address] = _Member(address, threads, asked)
        if self._members:
            self._idle_since = None
            return
        self._idle_since = now if self._idle_since is None else self._idle_since
        if now - self._idle_since > (GRACE_S if self._refused else WORKERS_WAIT_S):
            if self._refused:
                raise self._gone("has no worker that is accepted: " + "; ".join(self._refused.values()))
            raise self._gone(f"has had no worker for {WORKERS_WAIT_S:g} s")

    def _gone(self, words: str) -> ClusterError:
        return ClusterError(f"--dask {self._address}", words, "what is stored is kept; the same command goes on")

    def _hear(self, member: _Member) -> None:
        """What a worker says that it is."""
        if member.asked.status == "pending":
            return
        try:
            facts, member.said = _fetched(member.asked)
        except Exception as error:
            if member.asked.status == "error":  # the worker's, not that of the way there
                self._refuse(member, f"{type(error).__name__}: {error}")
            else:
                self._lose(member.address)
            return
        for name, ours in self._facts.items():
            if facts.get(name) != ours:
                self._refuse(member, f"{name}: {facts.get(name)}, here {ours}")
                return
        self._drop(member.asked)
        member.asked = None

    def _refuse(self, member: _Member, reason: str) -> None:
        words = f"worker {member.address}" + (f" ({member.said})" if member.said else "") + f" is refused: {reason}"
        self._refused[member.address] = words
        self._withdrawn += member.gave
        self._lose(member.address)
        self._say(words)

    def _lose(self, address: str) -> None:
        """A worker is away: what it had is for others."""
        member = self._members.pop(address)
        if member.asked is not None:
            self._drop(member.asked)
        for future, ticket in member.running.items():
            self._drop(future)
            self._again(ticket)

    def _again(self, ticket: _Ticket) -> None:
        ticket.lost += 1
        if ticket.lost > LOST_AT_MOST:
            raise self._gone(f"lost {ticket.lost} workers with the part that begins with run {ticket.number}")
        self._waiting.appendleft(ticket)

    def _give_out(self) -> None:
        while self._waiting:
            free = [member for member in self._accepted() if len(member.running) <= member.threads]
            if not free:
                return
            member = min(free, key=lambda one: len(one.running) / one.threads)
            if len(member.running) == member.threads and any(len(one.running) < one.threads for one in free):
                continue
            ticket = self._waiting.popleft()
            if self._packed is None or self._packed[0] is not ticket.work.cases:
                self._packed = ticket.work.cases, worker.packed(ticket.work.cases)
            parcel = worker.parcel_of(ticket.work, self._packed[1])
            member.running[self._task(member.address, worker.compute, self._name, parcel)] = ticket

    def _take(self, member: _Member, future: Any) -> list[tuple[int, Done | None]]:
        """What became of a task that has ended."""
        ticket = member.running.pop(future)
        try:
            answer = _fetched(future)
        except Exception as error:
            ended = future.status
            self._drop(future)
            self._again(ticket)
            if ended == "error" and type(error).__name__ != "KilledWorker":
                self._refuse(member, f"{type(error).__name__}: {error}")
            return []
        self._drop(future)
        if answer is None:  # another process has its address
            self._again(ticket)
            self._lose(member.address)
            return []
        done, seconds = answer
        member.rate = len(ticket.work) / max(seconds, 1e-6)
        self._computed_s += seconds
        if (reason := self._differs(member, ticket, done)) is not None:
            self._again(ticket)
            self._refuse(member, reason)
            return []
        member.gave.append(ticket.number)
        return [(ticket.number, done)]

    def _differs(self, member: _Member, ticket: _Ticket, done: Done) -> str | None:
        """Some runs are computed here once more: of each worker's first part, later as far as it costs nothing."""
        if member.gave and self._checked_s > CHECKED_SHARE * self._computed_s:
            return None
        started = time.perf_counter()
        count = len(ticket.work)
        where = np.unique(np.linspace(0, count - 1, min(CHECKED_RUNS, count)).astype(np.int64))
        ours, its = run_work(ticket.work.only(where)), done.only(where)
        self._checked_s += time.perf_counter() - started
        if ours.digest() == its.digest():
            return None
        if not np.array_equal(ours.status, its.status):
            return "a run of a part ended otherwise than here"
        row, column = np.argwhere((ours.numbers != its.numbers) & ~(np.isnan(ours.numbers) & np.isnan(its.numbers)))[0]
        name = result_columns()[column][0]
        return f"{name} of a run: {its.numbers[row, column]!r}, here {ours.numbers[row, column]!r}"


def _fetched(future: Any) -> Any:
    """The result of a task that has ended, or what it raised; TimeoutError: it is gone with its worker."""
    for timeout_s in FETCH_S:
        try:
            return future.result(timeout=timeout_s)
        except TimeoutError:
            if future.status != "finished":
                break
    raise TimeoutError


def _tell(words: str) -> None:
    print(f"giveway: {words}", file=sys.stderr, flush=True)


@contextmanager
def joined(
    address: str, processes: int | None, golden: Sequence[Work], say: Callable[[str], None] = _tell
) -> Iterator[Pool]:
    """The workers at ``address``, or so many ``processes`` of this machine (None: all processors) with `LOCAL`.

    Raises:
        MissingExtraError: Dask is not installed.
        GivewayError: there is no scheduler.
    """
    distributed = extra("distributed", EXTRA)
    if address != LOCAL:
        if processes is not None:
            raise GivewayError("threads", processes, "nothing beside an address: its workers have their own")
        _check_reached(address)
    with _silence():
        cluster = client = None
        try:
            if address == LOCAL:
                with _interrupts_held():
                    cluster = distributed.LocalCluster(
                        n_workers=default_threads() if processes is None else processes,
                        threads_per_worker=1,
                        processes=True,
                        host="127.0.0.1",
                        dashboard_address="127.0.0.1:0",  # nobody else's, and reached from here only
                        memory_limit=0,
                        silence_logs=logging.CRITICAL,
                    )
            try:
                client = distributed.Client(cluster or address, timeout=CONNECT_S, set_as_default=False)
            except (OSError, ValueError) as error:
                raise _unreachable(address, error) from None
            pool = Pool(client, address, golden, say)
            try:
                yield pool
            finally:
                pool.close()
        finally:
            for one in (client, cluster):
                if one is not None:
                    with contextlib.suppress(Exception):
                        one.close(timeout=CLOSE_S)


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Ctrl-C comes afterwards; never to threads that begin meanwhile, nor to the processes that these start."""
    resource_tracker.ensure_running()  # else the first process of a thread starts it, and unblocks Ctrl-C there
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def _check_reached(address: str) -> None:
    """Dask would try for long, and say little."""
    from distributed.comm.addressing import get_address_host_port

    try:
        with socket.create_connection(get_address_host_port(address), REACHED_S):
            pass
    except (OSError, ValueError) as error:
        raise _unreachable(address, error) from None


def _unreachable(address: str, error: Exception) -> GivewayError:
    allowed = f"{LOCAL}, or the address of a Dask scheduler that answers, such as tcp://10.0.0.1:8786 ({error})"
    return GivewayError("--dask", address, allowed)


@contextmanager
def _silence() -> Iterator[None]:
    """Dask logs every death of a worker; who wants to read that sets the level of "distributed" afterwards."""
    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] in ("distributed", "tornado")]
    before = {name: logging.getLogger(name).level for name in names}
    for name in names:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for name, level in before.items():
            logging.getLogger(name).setLevel(level)
