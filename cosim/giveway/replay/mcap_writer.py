"""Writes MCAP files (https://mcap.dev/spec) of many messages of one size at once, in memory of one chunk."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING

import numpy as np

from giveway.replay.cdr import Template

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["CHANNEL", "CHUNK", "HEADER", "MAGIC", "MESSAGE", "METADATA", "SCHEMA", "Channel", "McapWriter"]

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, METADATA, SUMMARY_OFFSET, DATA_END = 0x0B, 0x0C, 0x0E, 0x0F
_MESSAGE_HEAD = np.dtype(
    [("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"), ("publish", "<u8")]
)
_INDEX = np.dtype([("time", "<u8"), ("offset", "<u8")])


@dataclass
class Channel:
    """A topic of messages that are all made from one template."""

    topic: str
    template: Template
    number: int = 0
    messages: int = 0


def _text(text: str) -> bytes:
    data = text.encode()
    return struct.pack("<I", len(data)) + data


def _map(entries: Mapping[str, str]) -> bytes:
    data = b"".join(_text(key) + _text(value) for key, value in entries.items())
    return struct.pack("<I", len(data)) + data


def _record(opcode: int, content: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(content)) + content


class McapWriter:
    """``channels`` are fixed; `write` appends a chunk for one of them, `close` the summary."""

    def __init__(self, stream: IO[bytes], channels: list[Channel], metadata: Mapping[str, Mapping[str, str]]) -> None:
        self._stream, self._at = stream, 0
        self._index: list[bytes] = []
        self._start: int | None = None
        self._end = 0
        self._channels = channels
        types = {channel.template.type: channel.template for channel in channels}
        self._schemas = [
            _record(SCHEMA, struct.pack("<H", number) + _text(name) + _text("ros2msg") + _text(one.definition))
            for number, (name, one) in enumerate(types.items(), 1)
        ]
        numbers = {name: number for number, name in enumerate(types, 1)}
        self._heads = []
        for number, channel in enumerate(channels, 1):
            channel.number = number
            head = struct.pack("<HH", number, numbers[channel.template.type])
            self._heads.append(_record(CHANNEL, head + _text(channel.topic) + _text("cdr") + _map({})))
        self._metadata = len(metadata)
        self._put(MAGIC + _record(HEADER, _text("ros2") + _text("giveway")))
        self._put(b"".join(self._schemas + self._heads))
        for name, entries in metadata.items():
            self._put(_record(METADATA, _text(name) + _map(entries)))

    def _put(self, data: bytes) -> None:
        self._stream.write(data)
        self._at += len(data)

    def write(self, channel: Channel, time_ns: NDArray[np.int64], values: NDArray[np.float64]) -> None:
        """Messages of ``channel`` at ``time_ns`` (n,) with the numbers ``values`` (n, numbers of its template)."""
        import pyarrow

        count = len(time_ns)
        if not count:
            return
        payload = channel.template.fill(time_ns, values)
        size = _MESSAGE_HEAD.itemsize + payload.shape[1]
        heads = np.zeros(count, dtype=_MESSAGE_HEAD)
        heads["opcode"], heads["length"], heads["channel"] = MESSAGE, size - 9, channel.number
        heads["sequence"] = channel.messages + np.arange(count)
        heads["log"] = heads["publish"] = time_ns
        raw = np.concatenate([heads.view("u1").reshape(count, -1), payload], axis=1).tobytes()
        data = pyarrow.compress(raw, codec="zstd", asbytes=True)
        first, last = int(time_ns.min()), int(time_ns.max())
        times = struct.pack("<QQ", first, last)
        begin = self._at
        chunk = times + struct.pack("<QI", len(raw), zlib.crc32(raw)) + _text("zstd") + struct.pack("<Q", len(data))
        self._put(_record(CHUNK, chunk + data))
        length, place = self._at - begin, self._at
        entries = np.zeros(count, dtype=_INDEX)
        entries["time"], entries["offset"] = time_ns, np.arange(count) * size
        index = struct.pack("<HI", channel.number, entries.nbytes) + entries.tobytes()
        self._put(_record(MESSAGE_INDEX, index))
        offsets = struct.pack("<IHQ", 10, channel.number, place)
        sizes = struct.pack("<Q", self._at - place) + _text("zstd") + struct.pack("<QQ", len(data), len(raw))
        self._index.append(_record(CHUNK_INDEX, times + struct.pack("<QQ", begin, length) + offsets + sizes))
        channel.messages += count
        self._start = first if self._start is None else min(self._start, first)
        self._end = max(self._end, last)

    def close(self) -> None:
        """Summary and footer."""
        self._put(_record(DATA_END, struct.pack("<I", 0)))
        groups = [(SCHEMA, self._schemas), (CHANNEL, self._heads), (STATISTICS, [self._statistics()])]
        groups.append((CHUNK_INDEX, self._index))
        start, offsets = self._at, b""
        for opcode, records in groups:
            begin = self._at
            self._put(b"".join(records))
            if records:
                offsets += _record(SUMMARY_OFFSET, struct.pack("<BQQ", opcode, begin, self._at - begin))
        offset_start = self._at
        self._put(offsets)
        self._put(_record(FOOTER, struct.pack("<QQI", start, offset_start, 0)) + MAGIC)

    def _statistics(self) -> bytes:
        counts = b"".join(struct.pack("<HQ", channel.number, channel.messages) for channel in self._channels)
        messages = sum(channel.messages for channel in self._channels)
        content = struct.pack(
            "<QHIIIIQQ",
            messages,
            len(self._schemas),
            len(self._heads),
            0,
            self._metadata,
            len(self._index),
            self._start or 0,
            self._end,
        )
        return _record(STATISTICS, content + struct.pack("<I", len(counts)) + counts)
