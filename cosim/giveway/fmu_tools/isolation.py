"""Calls a function in a separate process, so that a library that crashes, hangs or fills memory does no damage."""

from __future__ import annotations

import os
import pickle
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

__all__ = ["IsolatedError", "isolated", "signal_name"]

A = TypeVar("A")
R = TypeVar("R")


class IsolatedError(Exception):
    """The process returned no result; the text tells how it ended, such as "ends with SIGSEGV"."""


def signal_name(number: int) -> str:
    """SIGSEGV for 11."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def isolated(function: Callable[[A], R], argument: A, seconds: int, memory_mb: int) -> R:
    """``function(argument)`` of a forked process; the result has to be plain data.

    ``memory_mb`` limits its memory in addition to that of this process. IsolatedError if it returns no result. Without
    fork (Windows) the function is called in this process.
    """
    if not hasattr(os, "fork"):
        return function(argument)
    receive, send = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(receive)
        _child(function, argument, send, seconds, memory_mb)
    os.close(send)
    try:
        with os.fdopen(receive, "rb") as stream:
            answer = stream.read()
    except BaseException:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        raise
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        how = os.WTERMSIG(status)
        raise IsolatedError(f"takes over {seconds} s" if how == signal.SIGALRM else f"ends with {signal_name(how)}")
    try:
        kind, value = pickle.loads(answer)
    except Exception:
        raise IsolatedError("ends without a word") from None
    if kind == "error":
        raise IsolatedError(f"fails ({value})")
    result: R = value
    return result


def _child(function: Callable[[Any], Any], argument: Any, send: int, seconds: int, memory_mb: int) -> None:
    """Never returns."""
    try:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(seconds)
        _limit_memory(memory_mb)
        try:
            answer = ("result", function(argument))
        except BaseException as error:
            answer = ("error", f"{type(error).__name__}: {error}"[:200])
        with os.fdopen(send, "wb") as stream:
            pickle.dump(answer, stream)
    finally:
        os._exit(0)


def _limit_memory(memory_mb: int) -> None:
    import resource

    pages = int(Path("/proc/self/statm").read_text().split()[0]) if Path("/proc/self/statm").exists() else 0
    if pages:
        most = pages * resource.getpagesize() + memory_mb * 1_000_000
        own = resource.getrlimit(resource.RLIMIT_AS)
        limits = [limit for limit in (most, *own) if limit != resource.RLIM_INFINITY]
        resource.setrlimit(resource.RLIMIT_AS, (min(limits), own[1]))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
