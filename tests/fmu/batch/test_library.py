"""The file giveway_batch.so: it exports its header's functions and nothing else, and needs only the C library."""

from __future__ import annotations

import ctypes
import os
import re
import subprocess
from pathlib import Path

from giveway.base.gravity import GRAVITY_MPS2

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


def shared_with_other_files(lanes: int) -> set[str]:
    """Functions in the object file of the lanes that the linker might also use for other files."""
    (found,) = BUILD.glob(f"fmu/batch/CMakeFiles/giveway_batch.dir/lanes_{lanes}.cpp.o")
    listing = subprocess.run(["nm", "--demangle", found], check=True, capture_output=True, text=True)
    symbols = [line.split(maxsplit=2) for line in listing.stdout.splitlines() if not line.startswith(" ")]
    weak = {name for _, kind, name in symbols if kind in "WV"}
    own = re.compile(rf"\b(Lanes|LanePlantOf|Strided|lane_noise_of)<{lanes}>")
    return {name for name in weak if own.search(name) is None}


def test_code_for_wide_registers_stays_with_the_lanes() -> None:
    """Otherwise the linker might use an inline function compiled for AVX for all files, which fails on other
    processors."""
    assert shared_with_other_files(4) == set()
    assert shared_with_other_files(8) == set()


def test_no_product_and_sum_are_rounded_as_one() -> None:
    """With fused operations a design would have other bits than without them."""
    listing = subprocess.run(["objdump", "--disassemble", LIBRARY], check=True, capture_output=True, text=True).stdout
    assert "vmulpd" in listing  # it has been disassembled, lanes and all
    assert re.search(r"\bvfn?m(add|sub)", listing) is None


def test_python_has_the_plants_gravity() -> None:
    library = ctypes.CDLL(str(LIBRARY))
    library.gwb_gravity.restype = ctypes.c_double
    assert library.gwb_gravity() == GRAVITY_MPS2
