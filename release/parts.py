"""Third-party work inside the wheels and FMUs: name, version, licence, origin. THIRD_PARTY.md says the same in words.

Versions and checksums are those of the lock files that the build fetches from.
"""

from __future__ import annotations

import base64
import importlib.util
import json
import re
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from release.platforms import PLATFORMS

__all__ = ["PARTS", "ROOT", "Origin", "Part", "parts_of", "sundials_folder"]

ROOT = Path(__file__).resolve().parents[1]
MODELS = ("controller", "testbed", "drivetrain", "bumper")


@dataclass(frozen=True)
class Origin:
    """What the build fetches: package URL, version, and the checksums of the lock file, of which one fits."""

    url: str
    version: str
    algorithm: str
    checksums: tuple[str, ...]


def _cargo(name: str) -> Origin:
    lock = tomllib.loads((ROOT / "cmake" / "sundials" / "Cargo.lock").read_text(encoding="utf-8"))
    (found,) = (one for one in lock["package"] if one["name"] == name)
    return Origin(f"pkg:cargo/{name}@{found['version']}", found["version"], "SHA256", (found["checksum"],))


def _npm(name: str) -> Origin:
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text(encoding="utf-8"))
    found = lock["packages"][f"node_modules/{name}"]
    algorithm, _, digest = found["integrity"].partition("-")
    checksum = base64.b64decode(digest).hex()
    return Origin(f"pkg:npm/{name}@{found['version']}", found["version"], algorithm.upper(), (checksum,))


def _pip(name: str) -> Origin:
    """Which of its files pip takes depends on the machine that builds."""
    lock = (ROOT / "cmake" / "requirements.lock").read_text(encoding="utf-8")
    found = re.search(rf"^{name}==(\S+)((?: \\\n\s+--hash=sha256:\w+)+)", lock, re.MULTILINE)
    assert found is not None, f"cmake/requirements.lock has no {name}"
    checksums = tuple(re.findall(r"sha256:(\w+)", found[2]))
    return Origin(f"pkg:pypi/{name}@{found[1]}", found[1], "SHA256", checksums)


def _zig(name: str) -> Path:
    """A file of the installed zig."""
    found = importlib.util.find_spec("ziglang")
    assert found is not None
    assert found.origin is not None
    return Path(found.origin).parent / name


def sundials_folder() -> Path:
    """Where the build found the SUNDIALS sources."""
    cache = (ROOT / "build" / "CMakeCache.txt").read_text(encoding="utf-8")
    folder = re.search(r"^GIVEWAY_SUNDIALS_VENDOR:PATH=(.*)$", cache, re.MULTILINE)
    assert folder is not None
    (path,) = Path(folder[1]).glob("sundials-sys-*/vendor")
    return path


def _sundials_licence() -> str:
    return (sundials_folder() / "LICENSE").read_text(encoding="utf-8")


def _first_comment() -> str:
    """uPlot's licence stands at the head of every bundle."""
    page = (ROOT / "build" / "web" / "pages" / "page_report.js").read_text(encoding="utf-8")
    return page[page.index("/*!") + 3 : page.index("*/")].strip() + "\n"


@dataclass(frozen=True)
class Part:
    """One piece of third-party work.

    Attributes:
        name: as in THIRD_PARTY.md.
        licence: SPDX expression.
        origin: reads where it comes from.
        text: reads its licence text.
        version: its own; "": that of the origin.
        libraries: ends of the names of the platforms whose libraries hold it; "wasm": the WebAssembly; "pages".
        models: of the FMUs that hold it; the batch library holds what any holds.
    """

    name: str
    licence: str
    origin: Callable[[], Origin]
    text: Callable[[], str]
    version: str = ""
    libraries: tuple[str, ...] = ("linux", "windows", "darwin", "wasm")
    models: tuple[str, ...] = MODELS

    @property
    def file(self) -> str:
        """Of its licence text."""
        return f"{re.sub(r'[^a-z0-9]+', '-', self.name.lower()).strip('-')}.txt"


def _text_of(name: str) -> Callable[[], str]:
    return lambda: _zig(name).read_text(encoding="utf-8", errors="replace")


PARTS = (
    Part(
        *("SUNDIALS", "BSD-3-Clause", lambda: _cargo("sundials-sys"), _sundials_licence, "7.1.1"),
        models=("testbed", "drivetrain", "bumper"),
    ),
    Part("zig", "MIT", lambda: _pip("ziglang"), _text_of("LICENSE")),
    Part(
        *("libc++", "Apache-2.0 WITH LLVM-exception", lambda: _pip("ziglang"), _text_of("lib/libcxx/LICENSE.TXT")),
    ),
    Part(
        *("MinGW-w64", "LicenseRef-MinGW-w64", lambda: _pip("ziglang"), _text_of("lib/libc/mingw/COPYING")),
        libraries=("windows",),
    ),
    Part(
        *("musl", "MIT", lambda: _pip("ziglang"), _text_of("lib/libc/musl/COPYRIGHT")),
        libraries=("windows", "wasm"),
    ),
    Part(
        *("wasi-libc", "MIT", lambda: _pip("ziglang"), _text_of("lib/libc/wasi/LICENSE-MIT")),
        libraries=("wasm",),
    ),
    Part("uPlot", "MIT", lambda: _npm("uplot"), _first_comment, libraries=("pages",), models=()),
)


def parts_of(platforms: tuple[str, ...], model: str | None = None) -> list[Part]:
    """What libraries of these platforms (or "wasm", "pages") hold; ``model``: of one FMU alone."""
    assert all(name in ("wasm", "pages", *(one.name for one in PLATFORMS)) for name in platforms)
    ends = {name.rpartition("-")[2] for name in platforms}
    return [part for part in PARTS if ends & set(part.libraries) and (model is None or model in part.models)]
