"""An FMU frees all its memory."""

from __future__ import annotations

import ctypes

from fmu_driver import Fmu

INSTANCES = 200


class Mallinfo2(ctypes.Structure):
    """glibc's: bytes in use are ``uordblks`` of the heap and ``hblkhd`` of blocks by themselves."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in (
            "arena",
            "ordblks",
            "smblks",
            "hblks",
            "hblkhd",
            "usmblks",
            "fsmblks",
            "uordblks",
            "fordblks",
            "keep",
        )
    ]


def bytes_in_use() -> int:
    mallinfo = ctypes.CDLL(None).mallinfo2
    mallinfo.restype = Mallinfo2
    info = mallinfo()
    return int(info.uordblks + info.hblkhd)


def test_a_freed_instance_leaves_nothing_behind(lag: Fmu) -> None:
    def make_and_free(count: int) -> None:
        for _ in range(count):
            assert lag.instantiate()
            lag.free()

    make_and_free(10)  # allocations that are made once and kept
    before = bytes_in_use()
    make_and_free(INSTANCES)
    # An instance takes some thousand bytes; Python itself keeps far less than 100 bytes per call.
    assert bytes_in_use() - before < 100 * INSTANCES
