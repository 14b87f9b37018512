"""Recorded messages of MCAP files and rosbag2 folders, many at once: `batches` of one topic each, in order."""

from __future__ import annotations

import contextlib
import re
import sqlite3
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING

import numpy as np

from giveway.base.errors import FileError
from giveway.replay.mcap_writer import CHANNEL, CHUNK, MAGIC, MESSAGE, METADATA, SCHEMA

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Batch", "Topic", "batches", "files_of"]

MESSAGE_INDEX, DATA_END, FOOTER = 7, 0x0F, 2
_MESSAGE_HEAD = 9 + 2 + 4 + 8 + 8
ROWS = 20_000  # of a database at once
RECORD_MAX = 1 << 31


@dataclass(frozen=True)
class Topic:
    """``type``: "sensor_msgs/msg/JointState"; ``encoding``: of its messages."""

    name: str
    type: str
    encoding: str


@dataclass(frozen=True)
class Batch:
    """Messages of a topic: message i is ``buffer[offsets[i]:offsets[i] + lengths[i]]``, logged at ``time_ns[i]``.

    ``metadata``: of the file so far, by name.
    """

    topic: Topic
    time_ns: NDArray[np.int64]
    buffer: NDArray[np.uint8]
    offsets: NDArray[np.int64]
    lengths: NDArray[np.int64]
    metadata: dict[str, dict[str, str]]

    def message(self, index: int) -> bytes:
        return self.buffer[self.offsets[index] : self.offsets[index] + self.lengths[index]].tobytes()


def files_of(path: Path) -> list[Path]:
    """The files of a log: itself, or those that metadata.yaml of a rosbag2 folder names."""
    if not path.is_dir():
        return [path]
    listing = path / "metadata.yaml"
    try:
        text = listing.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise FileError(path, "is a folder without metadata.yaml", "give a rosbag2 folder, or a file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(listing, f"cannot be read: {error}") from None
    block = re.search(r"^\s*relative_file_paths:\s*\n((?:\s*-\s*\S.*\n?)+)", text, re.MULTILINE)
    if block is None:
        raise FileError(listing, "names no files", "needed: relative_file_paths, as rosbag2 writes it")
    compressed = re.search(r"^\s*compression_mode:\s*[\"']?(FILE|MESSAGE)\b", text, re.MULTILINE | re.IGNORECASE)
    if compressed is not None:
        reason = f"compression_mode is {compressed[1]}"
        raise FileError(listing, reason, "allowed: none (`ros2 bag convert` writes such a bag)")
    names = [line.strip().removeprefix("-").strip().strip("\"'") for line in block[1].splitlines() if line.strip()]
    found = [path / name for name in names]
    for one in found:
        if not one.is_file():
            raise FileError(listing, f"names {one.name}, which is not there", "the folder of a whole bag")
    return found


def batches(path: Path) -> Iterator[Batch]:
    """Of one file, MCAP or SQLite."""
    try:
        with path.open("rb") as stream:
            begin = stream.read(16)
            if begin[: len(MAGIC)] == MAGIC:
                stream.seek(len(MAGIC))
                yield from _Mcap(path, stream).batches()
                return
    except (struct.error, ValueError, IndexError, OverflowError) as error:
        raise FileError(path, f"is no MCAP file as its records say: {error}", "a complete MCAP file") from None
    except FileNotFoundError:
        raise FileError(path, "no such file", "give the path of a log") from None
    except OSError as error:
        raise FileError(path, f"cannot be read: {error}") from None
    if not begin.startswith(b"SQLite format 3"):
        raise FileError(path, "is neither MCAP nor SQLite", "allowed: CSV, Parquet, MCAP, rosbag2 (.mcap, .db3)")
    yield from _database(path)


class _Mcap:
    """Reads record after record; of the summary nothing is needed."""

    def __init__(self, path: Path, stream: IO[bytes]) -> None:
        self._path, self._stream = path, stream
        self._schemas: dict[int, str] = {}
        self._channels: dict[int, Topic] = {}
        self._metadata: dict[str, dict[str, str]] = {}

    def batches(self) -> Iterator[Batch]:
        chunk: bytes | None = None
        indexes: dict[int, NDArray[np.int64]] = {}
        loose: list[bytes] = []
        for opcode, content in self._records():
            if opcode == MESSAGE_INDEX and chunk is not None:
                (channel,) = struct.unpack_from("<H", content)
                indexes[channel] = np.frombuffer(content, dtype="<u8", offset=6).reshape(-1, 2).astype(np.int64)
                continue
            if chunk is not None:
                yield from self._of_chunk(chunk, indexes)
                chunk, indexes = None, {}
            if opcode == CHUNK:
                chunk = self._decompressed(content)
            elif opcode == MESSAGE:
                loose.append(struct.pack("<BQ", opcode, len(content)) + content)
                if len(loose) >= ROWS:
                    yield from self._walked(b"".join(loose))
                    loose = []
            else:
                self._note(opcode, content)
        if chunk is not None:
            yield from self._of_chunk(chunk, indexes)
        if loose:
            yield from self._walked(b"".join(loose))

    def _records(self) -> Iterator[tuple[int, bytes]]:
        while head := self._stream.read(9):
            if head == MAGIC or len(head) < 9:
                raise self._broken("ends within a record")
            opcode, length = struct.unpack("<BQ", head)
            if opcode in (DATA_END, FOOTER):
                return
            if length > RECORD_MAX:
                raise self._broken(f"has a record of {length} bytes")
            content = self._stream.read(length)
            if len(content) < length:
                raise self._broken("ends within a record")
            yield opcode, content

    def _broken(self, reason: str) -> FileError:
        return FileError(self._path, f"{reason} at byte {self._stream.tell()}", "a complete MCAP file: `mcap recover`")

    def _note(self, opcode: int, content: bytes) -> None:
        if opcode == SCHEMA:
            (number,) = struct.unpack_from("<H", content)
            self._schemas[number] = _text(content, 2)[0]
        elif opcode == CHANNEL:
            number, schema = struct.unpack_from("<HH", content)
            name, at = _text(content, 4)
            encoding, _ = _text(content, at)
            self._channels[number] = Topic(name, self._schemas.get(schema, ""), encoding)
        elif opcode == METADATA:
            name, at = _text(content, 0)
            entries, end = {}, at + 4 + int(struct.unpack_from("<I", content, at)[0])
            at += 4
            while at < end:
                key, at = _text(content, at)
                entries[key], at = _text(content, at)
            self._metadata[name] = entries

    def _decompressed(self, content: bytes) -> bytes:
        import pyarrow

        size, checksum = struct.unpack_from("<QI", content, 16)
        kind, at = _text(content, 28)
        data = content[at + 8 :]
        if size > RECORD_MAX:
            raise self._broken(f"has a chunk of {size} bytes")
        if kind not in ("", "lz4", "zstd"):
            raise FileError(self._path, f"has a chunk of compression {kind}", "allowed: none, lz4, zstd")
        try:
            whole = pyarrow.Codec(kind).decompress(data, decompressed_size=size, asbytes=True) if kind else data
        except (pyarrow.ArrowException, OSError) as error:
            raise self._broken(f"has a chunk that cannot be decompressed ({error})") from None
        if checksum and zlib.crc32(whole) != checksum:  # 0: its writer made none
            raise self._broken("has a chunk whose checksum is wrong")
        return bytes(whole)

    def _of_chunk(self, chunk: bytes, indexes: dict[int, NDArray[np.int64]]) -> Iterator[Batch]:
        if not indexes or any(number not in self._channels for number in indexes):
            yield from self._walked(chunk)
            return
        buffer = np.frombuffer(chunk, dtype=np.uint8)
        for number, index in indexes.items():
            places = index[:, 1]
            if len(places) and (places.max() + _MESSAGE_HEAD > len(buffer) or (buffer[places] != MESSAGE).any()):
                raise self._broken("has an index that does not fit its chunk")
            lengths = _gather(buffer, places + 1).astype(np.int64)
            yield self._batch(number, index[:, 0], buffer, places, lengths)

    def _walked(self, data: bytes) -> Iterator[Batch]:
        """The same without an index."""
        found: dict[int, list[tuple[int, int, int]]] = {}
        at = 0
        while at + 9 <= len(data):
            opcode, length = struct.unpack_from("<BQ", data, at)
            if at + 9 + length > len(data):
                raise self._broken("has a record that is cut off")
            if opcode == MESSAGE:
                channel, _, log = struct.unpack_from("<HIQ", data, at + 9)
                found.setdefault(channel, []).append((log, at, length))
            else:
                self._note(opcode, data[at + 9 : at + 9 + length])
            at += 9 + length
        buffer = np.frombuffer(data, dtype=np.uint8)
        for number, messages in found.items():
            times, places, lengths = np.array(messages, dtype=np.int64).T
            yield self._batch(number, times, buffer, places, lengths)

    def _batch(
        self,
        number: int,
        time_ns: NDArray[np.int64],
        buffer: NDArray[np.uint8],
        places: NDArray[np.int64],
        lengths: NDArray[np.int64],
    ) -> Batch:
        if number not in self._channels:
            raise self._broken(f"has messages of channel {number}, which it does not describe,")
        order = np.argsort(time_ns, kind="stable")
        head = _MESSAGE_HEAD
        return Batch(
            self._channels[number],
            time_ns[order],
            buffer,
            places[order] + head,
            lengths[order] - (head - 9),
            self._metadata,
        )


def _gather(buffer: NDArray[np.uint8], places: NDArray[np.int64]) -> NDArray[np.uint64]:
    """The u64 at each place."""
    return np.ascontiguousarray(buffer[places[:, None] + np.arange(8)]).view("<u8")[:, 0]


def _text(data: bytes, at: int) -> tuple[str, int]:
    (length,) = struct.unpack_from("<I", data, at)
    end = at + 4 + length
    return data[at + 4 : end].decode("utf-8", "replace"), end


def _database(path: Path) -> Iterator[Batch]:
    """Of a rosbag2 database."""
    try:
        with contextlib.closing(sqlite3.connect(f"file:{path.absolute()}?mode=ro", uri=True)) as database:
            topics = {
                number: Topic(name, kind, encoding)
                for number, name, kind, encoding in database.execute(
                    "SELECT id, name, type, serialization_format FROM topics"
                )
            }
            rows = database.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp, id")
            while some := rows.fetchmany(ROWS):
                for number in dict.fromkeys(row[0] for row in some):
                    mine = [row for row in some if row[0] == number]
                    lengths = np.array([len(row[2]) for row in mine], dtype=np.int64)
                    offsets = np.concatenate(([0], np.cumsum(lengths)[:-1])).astype(np.int64)
                    buffer = np.frombuffer(b"".join(row[2] for row in mine), dtype=np.uint8)
                    times = np.array([row[1] for row in mine], dtype=np.int64)
                    yield Batch(topics[number], times, buffer, offsets, lengths, {})
    except sqlite3.Error as error:
        raise FileError(path, f"cannot be read: {error}", "a database of rosbag2") from None
