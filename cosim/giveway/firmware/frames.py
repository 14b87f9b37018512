"""Frames on a serial line, as the C header serial_frames.h defines them; c/serial_frames.c is the other end."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from enum import IntEnum
from typing import Protocol

__all__ = ["VERSION", "Frame", "Kind", "LineError", "SerialLine", "ask"]

VERSION = 1
BEGINNING = b"gw"
_HEAD = struct.Struct("<BBI")  # kind, number of words, counter
_WORD_BYTES = 4
_NOISE_BYTES = 4096  # before a frame: what a board says when it is switched on


class Kind(IntEnum):
    """Questions are capitals."""

    START = ord("S")
    TICK = ord("T")
    STARTED = ord("s")
    ANSWER = ord("t")
    REFUSED = ord("e")


REFUSED = {
    1: "the question arrived with a wrong checksum",
    2: "the question is of an unknown kind",
    3: "the question has another number of words: the firmware is of another version of giveway",
    4: "a tick came before a start that went well",
}


class LineError(Exception):
    """The line or the firmware at its end failed; the text says how."""


class SerialLine(Protocol):
    """Bytes there and back. Both raise LineError; `read` gives what is there within the time, at least one byte."""

    def write(self, data: bytes) -> None: ...
    def read(self, timeout_s: float) -> bytes: ...


@dataclass(frozen=True)
class Frame:
    """A frame; ``payload`` is its words, little-endian."""

    kind: int
    counter: int
    payload: bytes = b""

    def encoded(self) -> bytes:
        """The bytes on the line."""
        body = _HEAD.pack(self.kind, len(self.payload) // _WORD_BYTES, self.counter) + self.payload
        return BEGINNING + body + struct.pack("<I", zlib.crc32(body))


def ask(line: SerialLine, question: Frame, timeout_s: float) -> Frame:
    """Send ``question`` and wait for its answer; LineError if there is none, or none to rely on."""
    line.write(question.encoded())
    answer = _receive(line, timeout_s)
    if answer.kind == Kind.REFUSED:
        number = int.from_bytes(answer.payload[:_WORD_BYTES], "little")
        raise LineError(f"the firmware refused frame {question.counter}: {REFUSED.get(number, f'reason {number}')}")
    if answer.counter != question.counter:
        raise LineError(f"frame {question.counter} was answered by frame {answer.counter}: a frame was lost")
    return answer


def _receive(line: SerialLine, timeout_s: float) -> Frame:
    data = b""
    while True:
        start = data.find(BEGINNING)
        if start < 0 and len(data) > _NOISE_BYTES:
            raise LineError(f"{len(data)} bytes arrived without a frame: not this protocol, or another baud rate")
        if start >= 0:
            head = data[start + len(BEGINNING) :]
            if len(head) >= _HEAD.size:
                kind, count, counter = _HEAD.unpack_from(head)
                size = _HEAD.size + count * _WORD_BYTES
                if len(head) >= size + _WORD_BYTES:
                    return _checked(kind, counter, head[:size], head[size : size + _WORD_BYTES])
        try:
            data += line.read(timeout_s)
        except TimeoutError:
            part = f"; {len(data)} bytes of an answer arrived" if data else ""
            raise LineError(f"no answer within {timeout_s:g} s{part}") from None


def _checked(kind: int, counter: int, body: bytes, checksum: bytes) -> Frame:
    if zlib.crc32(body) != int.from_bytes(checksum, "little"):
        raise LineError("an answer arrived with a wrong checksum")
    return Frame(kind, counter, body[_HEAD.size :])
