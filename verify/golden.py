"""The golden bits: a program that drives every module and prints a digest of each, and the table it has to match.

After a change that is meant to change bits: .venv/bin/python -m verify.golden
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from giveway.base.files import write_text

from verify.context import Context
from verify.rung import RungFailed
from verify.targets import HOST, Target, core_sources

__all__ = ["TABLE", "TYPES", "build", "compare", "digests", "read_table"]

TYPES = ("float", "double")
TABLE = "tests/c_core/golden/golden.txt"
SOURCES = "tests/c_core/golden"
EXAMPLE = "examples/firmware_mps2_an386"  # its recorded collision is replayed, and its digest function is used

HEADING = """\
# What every module of c_core puts out for a fixed sequence of inputs, as a digest of its bits: the same with every
# compiler and on every machine. Made by `python -m verify.golden`; a change of this table is a change of version.
"""


def build(context: Context, target: Target, core: Path, double: int, name: str, *flags: str) -> Path:
    """The golden program for one machine, real type and set of flags."""
    example = context.root / EXAMPLE
    return target.build(
        context,
        [
            *core_sources(core),
            *sorted((context.root / SOURCES).glob("*.c")),
            example / "digest.c",
            example / "recorded_collision.c",
        ],
        context.work / name,
        f"-DGW_REAL_DOUBLE={double}",
        f"-I{example}",
        *flags,
    )


def digests(context: Context, target: Target, program: Path) -> str:
    """The lines that the program prints."""
    answer = target.run(context, program, timeout_s=300.0)
    return "".join(f"{line.rstrip()}\n" for line in answer.stdout.splitlines())


def read_table(root: Path, double: int) -> str:
    """The lines of the committed table for one real type."""
    lines = (root / TABLE).read_text(encoding="utf-8").splitlines()
    return "".join(f"{line}\n" for line in lines if not line.startswith("#") and line.split()[1] == TYPES[double])


def compare(what: str, found: str, expected: str) -> None:
    """`RungFailed` that names the modules whose bits differ."""
    if found == expected:
        return
    wanted = expected.splitlines()
    wrong = [line for line in found.splitlines() if line not in wanted]
    raise RungFailed("\n".join([f"{what}: other bits than {TABLE}", *wrong]))


def _write(root: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        context = Context(root, Path(folder), os.environ["PATH"])
        tables = [
            digests(context, HOST, build(context, HOST, context.core, double, name, "-O2"))
            for double, name in enumerate(TYPES)
        ]
    write_text(root / TABLE, HEADING + "".join(tables))


if __name__ == "__main__":
    _write(Path(__file__).parents[1])
