"""The zip file itself: its size, method, names, links, order, layout."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from pathlib import PurePosixPath

from giveway.fmu_tools.archive import ArchiveError, OverLimitError, is_link, shown, unsafe_place
from giveway.fmu_tools.check.common import DESCRIPTION, FAULT, NOTE, WARNING, Found, TestedFile

__all__ = ["layout", "limits", "links", "zip_method", "zip_names", "zip_order"]

_FOLDERS = {"binaries", "sources", "documentation", "resources", "extra", "terminalsAndIcons"}
_NOT_ON_WINDOWS = frozenset('<>:"|?*')
_DEVICES = {"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))}


def limits(file: TestedFile) -> Found:
    try:
        file.archive.check_unpacked_size()
    except OverLimitError as error:
        yield FAULT, f"{error.value}; {error.allowed}"


def zip_method(file: TestedFile) -> Found:
    """Importers unpack with small libraries that only know deflate. Everything is unpacked once here."""
    try:
        file.archive.check_unpacked_size()
    except OverLimitError:
        return  # already reported
    for info in file.archive.infos:
        try:
            for _ in file.archive.chunks(info):
                pass
        except ArchiveError as error:
            yield FAULT, str(error.value)
    placed = sorted((info.header_offset, info.compress_size, info.filename) for info in file.archive.infos)
    for (start, size, name), (after, _, other) in pairwise(placed):
        if start + size > after:
            yield FAULT, f"{shown(name)} and {shown(other)} overlap in the archive"


def zip_names(file: TestedFile) -> Found:
    """Paths that unpack outside the folder, or differently from machine to machine."""
    raw = [info.orig_filename for info in file.archive.infos]
    for name, times in Counter(raw).items():
        if times > 1:
            yield FAULT, f"{shown(name)} is there {times} times"
    for lower, times in Counter(name.lower() for name in set(raw)).items():
        if times > 1:
            yield FAULT, f"{shown(lower)} is there {times} times in different capitals; Windows and macOS keep one"
    folders = {str(folder) for name in raw for folder in PurePosixPath(name[:1000]).parents}
    for name in raw:
        unsafe = unsafe_place(name)
        if "\\" in name:
            yield FAULT, f"{shown(name)} has a backslash; the zip format has forward slashes"
        elif unsafe:
            yield FAULT, f"{shown(name) or 'an entry'} {unsafe}"
        elif name in folders:
            yield FAULT, f"{shown(name)} is a file and a folder"
        elif not name.isprintable():
            yield FAULT, f"{shown(name)} has control characters"
        elif any(
            _NOT_ON_WINDOWS & set(p) or p[-1:] in " ." or p.split(".")[0].lower() in _DEVICES for p in _parts(name)
        ):
            yield WARNING, f"{shown(name)} is a name that Windows does not take"
        elif not name.isascii():
            yield NOTE, f"{shown(name)} is not plain ASCII; some importers unpack it under another name"


def _parts(name: str) -> tuple[str, ...]:
    return PurePosixPath(name).parts


def links(file: TestedFile) -> Found:
    """If a link is unpacked as a link, the next entry is written to its target."""
    for info in file.archive.infos:
        if is_link(info):
            yield FAULT, f"{shown(info.filename)} is a symbolic link or a device, neither file nor folder"


def zip_order(file: TestedFile) -> Found:
    """An FMU whose entries are sorted and undated can be built again byte for byte."""
    infos = file.archive.infos
    names = [info.filename for info in infos]
    if names != sorted(names):
        first = shown(next(later for earlier, later in pairwise(names) if later < earlier))
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
        yield FAULT, f"{DESCRIPTION} is missing at the top" + (f" (there is {shown(deeper[0])})" if deeper else "")
        return
    if file.description is None:
        return
    version = file.description.version
    for top in sorted({name.split("/")[0] for name in file.names if "/" in name} - _FOLDERS):
        yield NOTE, f"the folder {shown(top)}/ means nothing in FMI {version}"
    if "documentation/index.html" not in file.names:
        yield NOTE, "there is no documentation/index.html"
    if file.description.attributes.get("license") and not any("documentation/licenses/" in n for n in file.names):
        yield NOTE, "a licence is named, but documentation/licenses/ is empty"
