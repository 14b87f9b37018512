"""Fetches VDMCheck2 and runs it: a formal model of FMI 2's rules for model descriptions."""

from __future__ import annotations

import hashlib
import subprocess
import tomllib
import urllib.request
import zipfile
from pathlib import Path

__all__ = ["check", "install"]

TIMEOUT_S = 300


def install(folder: Path) -> Path:
    """The jar to run, in ``folder``; what is fetched must have the hash that vdmcheck.toml states."""
    listed = tomllib.loads((Path(__file__).parent / "vdmcheck.toml").read_text(encoding="utf-8"))
    folder.mkdir(parents=True, exist_ok=True)
    for entry in listed["file"]:
        kept = folder / Path(entry["path"]).name
        if not kept.exists():
            with urllib.request.urlopen(f"{listed['base']}/{entry['path']}", timeout=60) as answer:
                content = answer.read()
            if hashlib.sha256(content).hexdigest() != entry["sha256"]:
                raise SystemExit(f"importers: {entry['path']} has another hash than vdmcheck.toml states")
            kept.write_bytes(content)
        if entry["jar"]:
            (folder / entry["jar"]).write_bytes(kept.read_bytes())
        with zipfile.ZipFile(kept) as archive:
            chosen = [name for name in archive.namelist() if name.startswith(tuple(entry["unpack"]))]
            archive.extractall(folder, chosen if entry["unpack"] else [])
    return folder / "vdmcheck2.jar"


def check(jar: Path, fmu: Path) -> str:
    """Its findings about ``fmu``; empty if there are none."""
    command = ["java", "-jar", str(jar), str(fmu)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=TIMEOUT_S)
    except FileNotFoundError:
        return "java is not installed"
    said = " ".join((done.stdout + done.stderr).split())
    return "" if done.returncode == 0 and said == "No errors found." else said[:300] or f"exit code {done.returncode}"
