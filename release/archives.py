"""Zip and tar files whose bytes follow from their contents alone: sorted, one time, one mode, one compression."""

from __future__ import annotations

import gzip
import io
import os
import tarfile
import time
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path

__all__ = ["put", "write_tar", "write_zip"]

EARLIEST = 315532800  # 1980-01-01, the earliest time that a zip file can hold


def _time() -> int:
    """Of every file: SOURCE_DATE_EPOCH, if that is set."""
    return max(int(os.environ.get("SOURCE_DATE_EPOCH", EARLIEST)), EARLIEST)


def put(path: Path, data: bytes) -> None:
    """Write ``path`` whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f"{path.name}.partial")
    partial.write_bytes(data)
    partial.replace(path)


def write_zip(path: Path, contents: Mapping[str, bytes], last: Iterable[str] = ()) -> None:
    """``contents``: name -> bytes; the names of ``last`` come at the end, in their order."""
    late = list(last)
    when = time.gmtime(_time())[:6]
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name in [*sorted(contents.keys() - set(late)), *late]:
            entry = zipfile.ZipInfo(name, when)
            entry.create_system = 3  # Unix, on any build system
            entry.external_attr = 0o100644 << 16
            # What is compressed already (FMUs) is compressed once more all the same: the gain is small, but not zero.
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, contents[name], compresslevel=9)
    put(path, buffer.getvalue())


def write_tar(path: Path, contents: Mapping[str, bytes], executable: Iterable[str] = ()) -> None:
    """A .tar.gz of ``contents``; ``executable``: names that have the mode 755."""
    programs = set(executable)
    buffer = io.BytesIO()
    with (
        gzip.GzipFile(filename="", mode="wb", compresslevel=9, fileobj=buffer, mtime=0) as packed,
        tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive,
    ):
        for name in sorted(contents):
            entry = tarfile.TarInfo(name)
            entry.size, entry.mtime = len(contents[name]), _time()
            entry.mode = 0o755 if name in programs else 0o644
            archive.addfile(entry, io.BytesIO(contents[name]))
    put(path, buffer.getvalue())
