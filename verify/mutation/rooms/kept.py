"""What an earlier call found, kept in files below build/, so that a long trial that was interrupted goes on."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import threading
from pathlib import Path
from typing import Any

from verify.mutation.mutants import Key

__all__ = ["KeptFates", "digest", "files_below", "read_if_of", "write_of"]

NOT_SOURCES = ("__pycache__", "native")


def files_below(path: Path) -> list[Path]:
    """In order; the file itself if it is one."""
    if not path.is_dir():
        return [path]
    return [file for entry in sorted(path.iterdir()) if entry.name not in NOT_SOURCES for file in files_below(entry)]


def digest(*parts: str | Path) -> str:
    """Of words, and of the names and contents of files."""
    sum_ = hashlib.sha256()
    for part in parts:
        content = part.read_bytes() if isinstance(part, Path) else b""
        sum_.update(f"{part} {len(content)}\0".encode() + content)
    return sum_.hexdigest()


def write_of(path: Path, of: str, found: Any) -> None:
    path.write_text(json.dumps({"of": of, "found": found}), encoding="utf-8")


def read_if_of(path: Path, of: str) -> Any:
    """What was found out about the inputs with this digest; None if nothing was."""
    if not path.exists():
        return None
    document = json.loads(path.read_text(encoding="utf-8"))
    return document["found"] if document["of"] == of else None


class KeptFates:
    """A line for each mutant and stage of the trial, written at once. ``tests``: a digest of the tests they met.

    ``trust_killed``: who was killed by other tests counts as killed, too.
    """

    def __init__(self, path: Path, tests: str, *, trust_killed: bool) -> None:
        self.path = path
        self.tests = tests
        self.lock = threading.Lock()
        self.fates: dict[tuple[Key, str], str] = {}
        for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
            entry = json.loads(line)
            if entry["tests"] == tests or (trust_killed and entry["fate"] == "killed"):
                self.fates[Key(**entry["mutant"]), entry["stage"]] = entry["fate"]

    def get(self, mutant: Key, stage: str) -> str | None:
        return self.fates.get((mutant, stage))

    def add(self, mutant: Key, stage: str, fate: str) -> None:
        entry = {"mutant": dataclasses.asdict(mutant), "stage": stage, "fate": fate, "tests": self.tests}
        with self.lock, self.path.open("a", encoding="utf-8") as file:
            print(json.dumps(entry), file=file, flush=True)
