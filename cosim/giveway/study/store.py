"""The folder of a study: a manifest, and parts (Parquet) that are there as a whole or not at all.

    DIR/manifest.json                what was asked for, versions, hashes, seeds
    DIR/parts/HASH/designs.npz       values of all designs, deviations of all tolerance samples
    DIR/parts/HASH/part-A-B.parquet  the results of runs A to B - 1
    DIR/robot.toml, designs.csv, bumper.csv, catalogue-N-NAME.csv  copies of what the study file named

HASH stands for everything that decides the results; a study that was changed since has another one, and what is the
same in both is taken from the old parts. Studies whose folders lie side by side share their results in the same way.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from giveway.base import system
from giveway.base.errors import FileError, WriteError, system_words
from giveway.base.files import check_file, read_json, remove_folder, replace_file, write_text

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "CHOSEN",
    "EVIDENCE",
    "MANIFEST_FILE",
    "PARTS",
    "SCHEMA_VERSION",
    "KeyIndex",
    "Store",
    "catalogue_copy",
    "list_parts",
    "read_designs",
    "read_manifest",
]

SCHEMA_VERSION = 1
KIND = "giveway study"
MANIFEST_FILE, LOCK_FILE, PARTS, DESIGNS_FILE = "manifest.json", ".lock", "parts", "designs.npz"
CHOSEN, EVIDENCE = "chosen", "evidence"  # traces and evidence of designs, written by others
INPUT_FILES, CATALOGUE = ("robot.toml", "designs.csv", "bumper.csv"), "catalogue-"
HINT = "give a folder that `giveway sweep` wrote"
_PART = re.compile(r"part-(\d{9})-(\d{9})\.parquet")
MERGED_AT = 16


def catalogue_copy(number: int, path: str) -> str:
    """Name of the copy of the catalogue ``path``."""
    beginning = f"{CATALOGUE}{number}-"
    return beginning + Path(path).name.removeprefix(beginning)


def read_manifest(folder: Path, kind: str = KIND) -> dict[str, Any]:
    """The manifest of a study's folder."""
    manifest = read_json(folder / MANIFEST_FILE, SCHEMA_VERSION, HINT)
    if manifest.get("kind") != kind:
        raise FileError(folder / MANIFEST_FILE, f"is not that of a {kind.removeprefix('giveway ')}", HINT)
    return manifest


class Store:
    """The folder of one study, locked against other processes as long as it is open."""

    def __init__(self, folder: Path, fingerprint: str, kind: str = KIND) -> None:
        """Open ``folder``, made if it is not there; FileError if it holds something else or is in use.

        ``kind`` is what the manifest says that it holds.
        """
        self.folder, self._kind = folder, kind
        self.removed: list[Path] = []
        self.check(folder, kind)
        try:
            self.parts_folder = folder / PARTS / fingerprint[:16]
            self.parts_folder.mkdir(parents=True, exist_ok=True)
            self._lock = self._take_lock()
        except OSError as error:
            raise FileError(folder, f"cannot be written: {system_words(error)}") from None
        self._remove_leftovers()

    def _remove_leftovers(self) -> None:
        """What a process that was killed while it wrote has left."""
        for left in self.parts_folder.glob(".*"):
            shutil.rmtree(left, ignore_errors=True)
        for name in (MANIFEST_FILE + "-", *(name + "-" for name in INPUT_FILES), CATALOGUE):
            for left in self.folder.glob(f".{name}*"):
                left.unlink(missing_ok=True)

    @staticmethod
    def check(folder: Path, kind: str = KIND) -> None:
        """Refuse, before any work is done, a folder that is no place for a study, or for what else ``kind`` names."""
        if folder.exists() and not folder.is_dir():
            raise FileError(folder, "is a file", "give a folder to write to")
        if folder.is_dir() and any(path.name[0] != "." and path.name != PARTS for path in folder.iterdir()):
            if not (folder / MANIFEST_FILE).is_file():
                raise FileError(folder, "is not empty and holds no study", "give a new or an empty folder")
            read_manifest(folder, kind)
        check_file(folder / MANIFEST_FILE)

    def _take_lock(self) -> IO[str]:
        lock = (self.folder / LOCK_FILE).open("a+", encoding="utf-8")
        try:
            system.lock(lock.fileno())
        except OSError:
            lock.seek(0)
            owner = lock.read().strip() or "unknown"
            lock.close()
            hint = "wait for it, or give another folder"
            raise FileError(self.folder, f"is in use by another giveway process (pid {owner})", hint) from None
        lock.truncate(0)
        lock.write(f"{os.getpid()}\n")
        lock.flush()
        return lock

    def close(self) -> None:
        """Release the folder."""
        self._lock.close()

    def write_manifest(self, manifest: dict[str, Any]) -> None:
        """Write the manifest, atomically; what was made of a design of another study is removed first."""
        self._remove_former(manifest)
        text = json.dumps({"schema_version": SCHEMA_VERSION, "kind": self._kind, **manifest}, indent=2, allow_nan=False)
        write_text(self.folder / MANIFEST_FILE, text + "\n")

    def _remove_former(self, manifest: dict[str, Any]) -> None:
        """Traces and evidence of the study that was here before: its designs had the same numbers."""
        if not (self.folder / MANIFEST_FILE).is_file():
            return
        former = read_manifest(self.folder, self._kind)

        def changed(*keys: str) -> bool:
            return any(former.get(key) != manifest.get(key) for key in keys)

        found = [self.folder / CHOSEN] if changed("fingerprint") else []
        if changed("fingerprint", "study", "name"):
            found += sorted(self.folder.glob(f"{EVIDENCE}/*/evidence.*"))
        for path in found:
            if path.is_dir():
                remove_folder(path)
            elif path.is_file():
                path.unlink()
            else:
                continue
            self.removed.append(path.relative_to(self.folder))

    def write_designs(self, designs: NDArray[np.float64], deviations: NDArray[np.float64]) -> None:
        """Keep what was sampled: another version of the samplers may do it otherwise."""
        path = self.parts_folder / DESIGNS_FILE
        if not path.is_file():
            with replace_file(path) as temporary:
                np.savez(temporary, designs=designs, deviations=deviations)

    def write_generations(
        self, designs: NDArray[np.float64], deviations: NDArray[np.float64], generation: NDArray[np.int64]
    ) -> None:
        """Keep all designs of a search so far, with the generation of each."""
        with replace_file(self.parts_folder / DESIGNS_FILE) as temporary:
            np.savez(temporary, designs=designs, deviations=deviations, generation=generation)

    def read_generations(self, quantities: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Designs and generations that `write_generations` kept; none if there are none."""
        path = self.parts_folder / DESIGNS_FILE
        if not path.is_file():
            return np.empty((0, quantities)), np.empty(0, dtype=np.int64)
        designs, _ = read_designs(self.parts_folder)
        with np.load(path) as kept:
            return designs, kept["generation"]

    def parts(self) -> list[tuple[int, int, Path]]:
        """First run, last run + 1 and file of each part of this study, in order."""
        return list_parts(self.parts_folder)

    def missing(self, count: int) -> list[tuple[int, int]]:
        """Which of ``count`` runs are in no part, as ranges."""
        gaps, at = [], 0
        for first, end, _ in self.parts():
            if first > at:
                gaps.append((at, first))
            at = max(at, end)
        if at < count:
            gaps.append((at, count))
        return gaps

    def write_part(self, first: int, table: Any) -> Path:
        """Write the pyarrow ``table`` of the runs from ``first`` on; it is there as a whole or not at all."""
        import pyarrow.parquet

        path = self.parts_folder / f"part-{first:09d}-{first + table.num_rows:09d}.parquet"
        try:
            with replace_file(path) as temporary, temporary.open("wb") as file:
                pyarrow.parquet.write_table(table, file, compression="zstd")
        except WriteError as error:
            hint = "all parts before it are kept; the same command goes on"
            raise WriteError(path, error.cause, hint) from error
        system.write_through(self.parts_folder)
        return path

    def all_parts(self) -> Iterator[Path]:
        """Parts of this study, of what it was before it was changed, and of studies beside it."""
        folders = [
            self.folder,
            *sorted(path.parent for path in self.folder.absolute().parent.glob(f"*/{MANIFEST_FILE}")),
        ]
        seen = set()
        for folder in folders:
            if folder.resolve() in seen:
                continue
            seen.add(folder.resolve())
            for parts_folder in sorted((folder / PARTS).glob("*")):
                yield from (path for _, _, path in list_parts(parts_folder))


def read_designs(parts_folder: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Designs and deviations that `Store.write_designs` kept."""
    path = parts_folder / DESIGNS_FILE
    try:
        with np.load(path) as kept:
            return kept["designs"], kept["deviations"]
    except (OSError, ValueError, KeyError) as error:
        raise FileError(path, f"cannot be read: {error}", HINT) from None


def list_parts(parts_folder: Path) -> list[tuple[int, int, Path]]:
    """First run, last run + 1 and file of each part in a folder, in order."""
    found = []
    for path in parts_folder.glob("part-*.parquet"):
        match = _PART.fullmatch(path.name)
        if match:
            found.append((int(match[1]), int(match[2]), path))
    return sorted(found)


class KeyIndex:
    """Which stored run has which key: 16 bytes per run in memory."""

    def __init__(self) -> None:
        self.files: list[Path] = []
        self._merged = _empty()
        self._recent: list[NDArray[Any]] = []

    def add(self, path: Path, keys: Sequence[bytes]) -> None:
        """Add the runs of the part ``path``, keys in the order of its rows; b"" stays out."""
        halves = _halves(keys)
        entries = np.zeros(len(halves), dtype=_ENTRY)
        entries["half"], entries["file"], entries["row"] = halves, len(self.files), np.arange(len(halves))
        self.files.append(path)
        self._recent.append(np.sort(entries[halves != 0], order="half"))
        if len(self._recent) >= MERGED_AT:
            joined = np.concatenate([self._merged, *self._recent])
            self._merged = joined[np.argsort(joined["half"], kind="stable")]
            self._recent = []

    def discard(self, path: Path) -> None:
        """Forget the runs of the part ``path``."""
        number = self.files.index(path)
        self._merged = self._merged[self._merged["file"] != number]
        self._recent = [entries[entries["file"] != number] for entries in self._recent]

    def find(self, keys: Sequence[bytes]) -> NDArray[np.int64]:
        """File and row of each key, shape (n, 2); -1 where there is none. Only half of the key is compared."""
        wanted = _halves(keys)
        found = np.full((len(wanted), 2), -1, dtype=np.int64)
        for entries in (self._merged, *self._recent):
            if not len(entries):
                continue
            at = np.minimum(np.searchsorted(entries["half"], wanted), len(entries) - 1)
            hit = (entries["half"][at] == wanted) & (found[:, 0] < 0)
            found[hit, 0], found[hit, 1] = entries["file"][at[hit]], entries["row"][at[hit]]
        return found


_ENTRY = np.dtype([("half", "u8"), ("file", "u4"), ("row", "u4")])


def _halves(keys: Sequence[bytes]) -> NDArray[np.uint64]:
    """The first eight bytes of each key as a number; 0 for no key."""
    return np.frombuffer(b"".join(key[:8] or bytes(8) for key in keys), dtype=np.uint64)


def _empty() -> NDArray[Any]:
    return np.zeros(0, dtype=_ENTRY)
