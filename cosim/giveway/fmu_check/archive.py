"""The zip file itself: method, names, order, layout."""

from __future__ import annotations

import re
import zipfile
from collections import Counter
from itertools import pairwise
from pathlib import PurePosixPath

from giveway.fmu_check.common import DESCRIPTION, FAULT, NOTE, UNREADABLE, Found, TestedFile

__all__ = ["layout", "zip_method", "zip_names", "zip_order"]


_FOLDERS = {"binaries", "sources", "documentation", "resources", "extra", "terminalsAndIcons"}


def zip_method(file: TestedFile) -> Found:
    """Importers unpack with small libraries that know deflate and nothing else."""
    for info in file.archive.infolist():
        if info.flag_bits & 1:
            yield FAULT, f"{info.filename} is encrypted"
        elif info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            yield (
                FAULT,
                f"{info.filename} is compressed by method {info.compress_type}, not stored (0) or deflated (8)",
            )
    try:
        damaged = file.archive.testzip()
    except UNREADABLE as error:
        yield FAULT, f"cannot be unpacked: {error}"
    else:
        if damaged is not None:
            yield FAULT, f"{damaged} is damaged: its checksum differs"


def zip_names(file: TestedFile) -> Found:
    """Paths that unpack outside the folder, or differently from machine to machine."""
    raw = [info.orig_filename for info in file.archive.infolist()]
    for name, times in Counter(raw).items():
        if times > 1:
            yield FAULT, f"{name} is there {times} times"
    for lower, times in Counter(name.lower() for name in set(raw)).items():
        if times > 1:
            yield FAULT, f"{lower} is there {times} times in different capitals; Windows and macOS keep one"
    for name in raw:
        if "\\" in name:
            yield FAULT, f"{name} has a backslash; the zip format has forward slashes"
        elif name.startswith("/") or ".." in PurePosixPath(name).parts or re.match(r"[A-Za-z]:", name):
            yield FAULT, f"{name} leads outside the folder that it is unpacked to"
        elif not name.isascii():
            yield NOTE, f"{name} is not plain ASCII; some importers unpack it under another name"


def zip_order(file: TestedFile) -> Found:
    """An FMU whose entries are sorted and undated can be built again byte for byte."""
    infos = file.archive.infolist()
    names = [info.filename for info in infos]
    if names != sorted(names):
        first = next(later for earlier, later in pairwise(names) if later < earlier)
        yield (
            NOTE,
            f"entries are not in the order of their names ({first} comes too late): another build may give other bytes",
        )
    dated = sum(info.date_time != (1980, 1, 1, 0, 0, 0) for info in infos)
    if dated:
        yield NOTE, f"{dated} entries carry a time stamp: another build gives other bytes"


def layout(file: TestedFile) -> Found:
    if DESCRIPTION not in file.names:
        deeper = [name for name in file.names if name.endswith("/" + DESCRIPTION)]
        yield FAULT, f"{DESCRIPTION} is missing at the top" + (f" (there is {deeper[0]})" if deeper else "")
        return
    if file.description is None:
        return
    version = file.description.version
    for top in sorted({name.split("/")[0] for name in file.names if "/" in name} - _FOLDERS):
        yield NOTE, f"the folder {top}/ means nothing in FMI {version}"
    if "documentation/index.html" not in file.names:
        yield NOTE, "there is no documentation/index.html"
    if file.description.attributes.get("license") and not any("documentation/licenses/" in n for n in file.names):
        yield NOTE, "a licence is named, but documentation/licenses/ is empty"
