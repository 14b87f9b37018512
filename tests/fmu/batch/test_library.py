"""The file giveway_batch.so: it exports its header's functions and nothing else, and needs only the C library."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[3]
BUILD = Path(os.environ.get("GIVEWAY_BUILD_DIR", ROOT / "build"))
LIBRARY = BUILD / "batch" / "giveway_batch.so"
ORDINARY = BUILD / "tests" / "libgiveway_plant_probe.so"  # linked without the library's options
C_LIBRARY = {"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2"}


def exported(library: Path) -> set[str]:
    command = ["nm", "--dynamic", "--defined-only", "--format=posix", library]
    listing = subprocess.run(command, check=True, capture_output=True, text=True)
    return {line.split()[0] for line in listing.stdout.splitlines()}


def needed(library: Path) -> set[str]:
    listing = subprocess.run(["objdump", "--private-headers", library], check=True, capture_output=True, text=True)
    return set(re.findall(r"NEEDED\s+(\S+)", listing.stdout))


def test_it_exports_the_functions_of_its_header_and_nothing_else() -> None:
    text = (ROOT / "fmu" / "batch" / "giveway_batch.h").read_text(encoding="utf-8")
    declared = set(re.findall(r"^GWB_API [\w *]*?(gwb_\w+)\(", text, re.MULTILINE))
    assert len(declared) == text.count("\nGWB_API ")
    assert exported(LIBRARY) == declared


def test_it_needs_only_the_c_library() -> None:
    assert "libc.so.6" in needed(LIBRARY)
    assert needed(LIBRARY) <= C_LIBRARY


def test_an_ordinary_library_would_be_noticed() -> None:
    """The planted fault for both checks."""
    assert any(not name.startswith("gwb_") for name in exported(ORDINARY))
    assert needed(ORDINARY) - C_LIBRARY
