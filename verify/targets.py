"""The machines that c_core is compiled for and run on: compiler, flags, and the emulator."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from verify.context import Context, Finished, Tool

__all__ = [
    "CLANG",
    "CORTEX_M",
    "CROSS",
    "GCC",
    "HOST",
    "HOST_CLANG",
    "PORTABLE",
    "TARGETS",
    "WARNINGS",
    "WIN64",
    "Target",
    "core_sources",
]

GCC = Tool("gcc", package="g++")
CLANG = Tool("clang-19")
ARM_GCC = Tool("arm-none-eabi-gcc", package="gcc-arm-none-eabi")
QEMU_ARM = Tool("qemu-system-arm")
MINGW = Tool("x86_64-w64-mingw32-gcc", package="gcc-mingw-w64-x86-64")
WINE = Tool("/usr/lib/wine/wine64", package="wine64")

QEMU_USER = {name: Tool(f"qemu-{name}", package="qemu-user") for name in ("i386", "aarch64", "riscv64", "arm", "s390x")}

STANDARD = ("-std=c99", "-ffp-contract=off")
# The software square root for any processor, not the single instruction of some.
PORTABLE = "-DGW_HARDWARE_SQRT=0"
WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wpedantic", "-Werror")


@dataclass(frozen=True)
class Target:
    """A machine. ``emulator``: the command that runs its programs; empty: they run directly on this machine."""

    name: str
    compiler: Tool
    flags: tuple[str, ...] = ()
    emulator: Tool | None = None
    emulator_arguments: tuple[str, ...] = ()
    suffix: str = ""  # suffix of a program's name
    support: tuple[str, ...] = ()  # sources and linker script that a program needs, relative to the repository's root
    # False: double is emulated in software there, and gcc 12 for Arm rounds some differences wrongly, such as 1 -
    # 0x1.2f84f34dfab73p-33; tests/c_core/test_golden_bits.py fails when this is fixed.
    double_rounds: bool = True

    @property
    def tools(self) -> tuple[Tool, ...]:
        return (self.compiler, *([self.emulator] if self.emulator else []))

    def build(self, context: Context, sources: Sequence[Path], program: Path, *extra: str) -> Path:
        """Compile and link ``sources`` with c_core's headers; ``extra``: optimisation and the like."""
        program = program.with_name(program.name + self.suffix)
        support = [context.root / name for name in self.support]
        script: list[str | Path] = [word for path in support if path.suffix == ".ld" for word in ("-T", path)]
        context.run(
            context.which(self.compiler),
            *STANDARD,
            *self.flags,
            *extra,
            f"-I{context.core / 'include'}",
            *script,
            *sources,
            *[path for path in support if path.suffix == ".c"],
            "-o",
            program,
            timeout_s=300.0,
        )
        return program

    def run(self, context: Context, program: Path, *, timeout_s: float = 120.0, expect: int | None = 0) -> Finished:
        if self.emulator is None:
            return context.run(program, timeout_s=timeout_s, expect=expect)
        return context.run(
            context.which(self.emulator),
            *self.emulator_arguments,
            program,
            timeout_s=timeout_s,
            memory_gib=None,  # wine and qemu reserve address space
            environment={"WINEPREFIX": str(_wine_home(context)), "WINEDEBUG": "-all"},
            expect=expect,
        )


def _wine_home(context: Context) -> Path:
    """Folder of wine's registry; made once, outside the user's home."""
    home = context.root / "build" / "verify" / "wine"
    os.makedirs(home, exist_ok=True)
    return home


def core_sources(core: Path) -> list[Path]:
    return sorted((core / "src").glob("*.c"))


def _cortex_m(name: str, board: str, *flags: str, double_rounds: bool = False) -> Target:
    return Target(
        name,
        ARM_GCC,
        ("-mthumb", *flags, "--specs=rdimon.specs"),
        QEMU_ARM,
        ("-M", board, "-nographic", "-semihosting-config", "enable=on,target=native", "-kernel"),
        support=("verify/target/startup.c", "verify/target/mps2.ld"),
        double_rounds=double_rounds,
    )


def _linux(name: str, triplet: str, emulator: str, *flags: str) -> Target:
    compiler = Tool(f"{triplet}-gcc", package=f"gcc-{triplet}")
    return Target(name, compiler, ("-static", *flags), QEMU_USER[emulator])


HOST = Target("x86-64", GCC)
HOST_CLANG = Target("x86-64 clang", CLANG)
WIN64 = Target("win64", MINGW, ("-static",), WINE, suffix=".exe")
CORTEX_M = (
    _cortex_m("cortex-m3", "mps2-an385", "-mcpu=cortex-m3", "-mfloat-abi=soft"),
    _cortex_m("cortex-m4", "mps2-an386", "-mcpu=cortex-m4", "-mfloat-abi=soft"),
    _cortex_m("cortex-m4f", "mps2-an386", "-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"),
    _cortex_m("cortex-m7", "mps2-an500", "-mcpu=cortex-m7", "-mfpu=fpv5-d16", "-mfloat-abi=hard", double_rounds=True),
)

TARGETS = {target.name: target for target in (HOST, WIN64, *CORTEX_M)}

# Machines on which only the bits are compared.
CROSS = (
    _linux("i686", "i686-linux-gnu", "i386", "-msse2", "-mfpmath=sse"),
    _linux("aarch64", "aarch64-linux-gnu", "aarch64"),
    _linux("riscv64", "riscv64-linux-gnu", "riscv64"),
    _linux("armhf", "arm-linux-gnueabihf", "arm"),
    # Big-endian. Here -std=c99 alone makes gcc compute float in double, which gw_types.h refuses.
    _linux("s390x", "s390x-linux-gnu", "s390x", "-fexcess-precision=fast"),
    _cortex_m("cortex-m55", "mps3-an547", "-mcpu=cortex-m55", "-mfloat-abi=hard", double_rounds=True),
)
