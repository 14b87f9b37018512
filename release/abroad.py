"""`python -m release.abroad`: the batch libraries in the wheels, called on their platforms: Linux here and under qemu,
Windows under wine. All print the same bits; macOS cannot run here."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import ziglang

from release.parts import ROOT
from release.platforms import PLATFORMS, Platform
from release.wheel import BUILD, file_name

WORK = BUILD / "release"
TARGETS = {
    "x86_64-linux": ("x86_64-linux-gnu.2.17", []),
    "aarch64-linux": ("aarch64-linux-gnu.2.17", ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"]),
    "x86_64-windows": ("x86_64-windows-gnu", ["/usr/lib/wine/wine64"]),
}


def answer(platform: Platform, folder: Path) -> str:
    """What the library of the wheel in ``folder`` prints on its platform."""
    target, launcher = TARGETS[platform.name]
    work = WORK / platform.name
    work.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(folder / file_name(platform)) as wheel:
        (work / platform.library).write_bytes(wheel.read(f"giveway/native/{platform.library}"))
    program = work / ("call_batch.exe" if platform.ending == ".dll" else "call_batch")
    cache = dict.fromkeys(("ZIG_GLOBAL_CACHE_DIR", "ZIG_LOCAL_CACHE_DIR"), str(BUILD / "platforms" / "zig-cache"))
    command: list[str | Path] = [Path(ziglang.__file__).with_name("zig"), "cc", f"--target={target}", "-O1", "-s"]
    command += [f"-I{ROOT / 'fmu' / 'batch'}", ROOT / "release" / "call_batch.c", "-o", program]
    command += [] if platform.ending == ".dll" else ["-ldl"]
    subprocess.run(command, check=True, env=os.environ | cache)
    environment = os.environ | {"WINEPREFIX": str(WORK / "wine"), "WINEDEBUG": "-all", "DISPLAY": ""}
    name = platform.library if platform.ending == ".dll" else f"./{platform.library}"
    said = subprocess.run(
        [*launcher, program, name], cwd=work, env=environment, capture_output=True, text=True, timeout=600, check=False
    )
    if said.returncode != 0:
        raise RuntimeError(f"{platform.name}: exit code {said.returncode}: {said.stderr.strip()}")
    return said.stdout


def main() -> int:
    folder = ROOT / "dist"
    found = {one.name: answer(one, folder) for one in PLATFORMS if one.name in TARGETS}
    expected = found["x86_64-linux"].splitlines()
    faults = 0
    for name, text in found.items():
        differ = sum(a != b for a, b in zip(text.splitlines(), expected, strict=True))
        print(f"{name}: {len(expected)} numbers, {differ} with other bits")
        faults += differ > 0
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
