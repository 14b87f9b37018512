"""The zip file of an FMU: its directory, and its files unpacked no further than the directory states.

Python's zipfile reads the directory. The files are unpacked here, because zipfile stops silently at the size that the
directory states, which hides that another tool would unpack more, or other content.
"""

from __future__ import annotations

import re
import stat
import struct
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from giveway.base.errors import FileError
from giveway.fmu_tools.limits import MOST_LEVELS, Limits

__all__ = ["Archive", "ArchiveError", "OverLimitError", "is_link", "leads_outside", "shown", "unsafe_place"]

CHUNK = 1 << 18
LONGEST_NAME = 1000
_DIRECTORY_BYTES_PER_ENTRY = 1024  # on average; an entry has 46 bytes and its name
_LOCAL_HEADER = struct.Struct("<4s5H3L2H")
_UTF8_NAME = 0x800


class ArchiveError(FileError):
    """The archive, or one file in it, cannot be unpacked."""


class OverLimitError(ArchiveError):
    """Its content exceeds the limits."""

    def __init__(self, path: Path, found: str, option: str) -> None:
        super().__init__(path, found, f"{option} allows more")


def shown(text: str, longest: int = 120) -> str:
    """A name from the file for a terminal: control characters escaped, and shortened."""
    if len(text) <= longest and text.isprintable():
        return text
    plain = "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text[: longest + 1])
    return plain if len(text) <= longest else f"{plain[:longest]}..."


def leads_outside(name: str) -> bool:
    """Whether an entry of that name would be written outside the folder that the archive is unpacked to."""
    return name.startswith(("/", "\\")) or ".." in re.split(r"[/\\]", name) or bool(re.match(r"[A-Za-z]:", name))


def is_link(info: zipfile.ZipInfo) -> bool:
    """Whether it is a symbolic link, device or pipe: neither file nor folder."""
    kind = stat.S_IFMT(info.external_attr >> 16)
    return kind not in (0, stat.S_IFREG, stat.S_IFDIR)


class Archive:
    """An FMU that is open for reading; a context manager.

    Attributes:
        infos: its entries as in the directory, including folders.
        files: entry by name, folders left out; of entries with the same name the last one.
    """

    def __init__(self, path: Path, limits: Limits | None = None) -> None:
        """Read the directory: FileError if ``path`` is not a zip file, OverLimitError if it has too many entries."""
        self.path = path
        self.limits = limits or Limits()
        self._file = _opened(path)
        try:
            self._check_directory_size()
            with zipfile.ZipFile(self._file) as directory:
                self.infos = directory.infolist()
        except (OSError, zipfile.BadZipFile, NotImplementedError, ValueError, struct.error) as error:
            self._file.close()
            raise FileError(path, f"is not a zip file that can be read: {error}", "give an .fmu file") from None
        except FileError:
            self._file.close()
            raise
        self.files = {info.filename: info for info in self.infos if not info.filename.endswith("/")}

    def __enter__(self) -> Archive:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def close(self) -> None:
        self._file.close()

    @property
    def unpacked_bytes(self) -> int:
        """The size stated in the directory; reading never goes beyond it."""
        return sum(info.file_size for info in self.infos)

    def check_unpacked_size(self) -> None:
        """OverLimitError if the files together are larger than the limits allow."""
        if self.unpacked_bytes > self.limits.unpacked_mb * 1e6:
            raise OverLimitError(
                self.path,
                f"unpacks to {self.unpacked_bytes / 1e6:,.0f} MB, more than {self.limits.unpacked_mb:,g} MB",
                "--max-unpacked",
            )

    def chunks(self, info: zipfile.ZipInfo) -> Iterator[bytes]:
        """The content of one file; ArchiveError if it differs from the directory's statement."""
        name = shown(info.filename)
        if info.flag_bits & 1:
            raise ArchiveError(self.path, f"{name} is encrypted")
        if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            method = info.compress_type
            raise ArchiveError(self.path, f"{name} is compressed by method {method}, not stored (0) or deflated (8)")
        checksum = size = 0
        for piece in self._inflated(info) if info.compress_type == zipfile.ZIP_DEFLATED else self._packed(info):
            size += len(piece)
            if size > info.file_size:
                raise ArchiveError(self.path, f"{name} is larger than the {info.file_size} bytes that are stated")
            checksum = zlib.crc32(piece, checksum)
            yield piece
        if size < info.file_size:
            raise ArchiveError(self.path, f"{name} has {size} bytes, not the {info.file_size} that are stated")
        if checksum != info.CRC:
            raise ArchiveError(self.path, f"{name} is damaged: its checksum differs")

    def read(self, name: str) -> bytes:
        """The whole content of one file: for files that are known to be small, or needed in memory."""
        return b"".join(self.chunks(self.files[name]))

    def extract(self, folder: Path) -> None:
        """Unpack everything into the empty ``folder``; ArchiveError for anything that is unsafe to unpack."""
        self.check_unpacked_size()
        for info in self.infos:
            if leads_outside(info.filename) or leads_outside(info.orig_filename) or is_link(info):
                raise ArchiveError(self.path, f"{shown(info.orig_filename)} is not unpacked: it leads elsewhere")
            target = folder / info.filename
            try:
                if info.filename.endswith("/"):
                    target.mkdir(parents=True, exist_ok=True)
                    continue
                target.parent.mkdir(parents=True, exist_ok=True)
                with target.open("xb") as stream:  # never overwrites an existing file
                    for piece in self.chunks(info):
                        stream.write(piece)
            except (OSError, ValueError) as error:
                reason = getattr(error, "strerror", None) or error
                raise ArchiveError(self.path, f"{shown(info.filename)} cannot be unpacked: {reason}") from None

    def _check_directory_size(self) -> None:
        """Checked before zipfile makes an object of each entry."""
        start, size = _directory_place(self._file)
        too_many = OverLimitError(self.path, f"has more than {self.limits.entries:,} entries", "--max-entries")
        if size > self.limits.entries * _DIRECTORY_BYTES_PER_ENTRY + LONGEST_NAME:
            raise too_many
        self._file.seek(start)
        # A name may contain these four bytes, too: then this counts one too many.
        if self._file.read(size).count(b"PK\x01\x02") > self.limits.entries:
            raise too_many

    def _packed(self, info: zipfile.ZipInfo) -> Iterator[bytes]:
        """The bytes in the archive, as they are."""
        name = shown(info.filename)
        try:
            self._file.seek(info.header_offset)
            header = self._file.read(_LOCAL_HEADER.size)
            if len(header) < _LOCAL_HEADER.size or header[:4] != b"PK\x03\x04":
                raise ArchiveError(self.path, f"{name} is not where the directory says")
            *_, name_bytes, extra_bytes = _LOCAL_HEADER.unpack(header)
            encoding = "utf-8" if info.flag_bits & _UTF8_NAME else "cp437"
            if self._file.read(name_bytes) != info.orig_filename.encode(encoding, "replace"):
                raise ArchiveError(self.path, f"{name} has another name beside its content")
            self._file.seek(extra_bytes, 1)
            left = info.compress_size
            while left > 0:
                piece = self._file.read(min(CHUNK, left))
                if not piece:
                    raise ArchiveError(self.path, f"{name} is cut short")
                left -= len(piece)
                yield piece
        except (OSError, ValueError, OverflowError) as error:
            raise ArchiveError(self.path, f"{name} cannot be read: {error}") from None

    def _inflated(self, info: zipfile.ZipInfo) -> Iterator[bytes]:
        name = shown(info.filename)
        inflate = zlib.decompressobj(-15)
        try:
            for piece in self._packed(info):
                rest = piece
                while rest and not inflate.eof:
                    yield inflate.decompress(rest, CHUNK)
                    rest = inflate.unconsumed_tail
                if inflate.unused_data:
                    raise ArchiveError(self.path, f"{name} goes on after its end")
            while not inflate.eof:
                last = inflate.decompress(b"", CHUNK)
                if not last:
                    raise ArchiveError(self.path, f"{name} is cut short")
                yield last
        except zlib.error as error:
            raise ArchiveError(self.path, f"{name} cannot be unpacked: {error}") from None


def unsafe_place(name: str) -> str:
    """Why a file cannot be unpacked safely under this name; empty if it can."""
    if not name:
        return "has no name"
    if leads_outside(name):
        return "leads outside the folder that it is unpacked to"
    if "\0" in name:
        return "has a zero byte"
    if len(name.encode("utf-8", "replace")) > LONGEST_NAME:
        return f"is longer than {LONGEST_NAME} bytes"
    if len(PurePosixPath(name).parts) > MOST_LEVELS:
        return f"is more than {MOST_LEVELS} folders deep"
    return ""


def _opened(path: Path) -> BinaryIO:
    try:
        if path.exists() and not path.is_file():  # a pipe would wait for ever
            raise FileError(path, "is not a file", "give an .fmu file")
        return path.open("rb")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise FileError(path, f"is not a zip file that can be read: {reason}", "give an .fmu file") from None


def _directory_place(file: BinaryIO) -> tuple[int, int]:
    """Where the zip directory starts and its size in bytes, as zipfile finds it; BadZipFile if there is none."""
    length = file.seek(0, 2)
    tail_start = max(0, length - 65557)
    file.seek(tail_start)
    tail = file.read()
    plain = len(tail) - 22  # an archive without a comment
    at = plain if tail[plain : plain + 4] == b"PK\x05\x06" and tail[-2:] == b"\0\0" else tail.rfind(b"PK\x05\x06")
    if plain < 0 or at < 0 or at + 22 > len(tail):
        raise zipfile.BadZipFile("File is not a zip file")
    (size,) = struct.unpack_from("<L", tail, at + 12)
    end = tail_start + at
    if at >= 76 and tail[at - 20 : at - 16] == b"PK\x06\x07" and tail[at - 76 : at - 72] == b"PK\x06\x06":
        (size,) = struct.unpack_from("<Q", tail, at - 76 + 40)
        end -= 76
    return max(0, end - size), min(size, end)
