"""What c_core costs on a microcontroller: flash, RAM, stack, instructions; and the tables of it in texts.

`.venv/bin/python -m verify.footprint` prints them.
"""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from verify.context import Context, Tool
from verify.golden import EXAMPLE
from verify.rung import RungFailed
from verify.targets import TARGETS, Target, core_sources

__all__ = [
    "MACHINES",
    "OBJDUMP",
    "SIZE",
    "TARGET",
    "Footprint",
    "check",
    "check_parts",
    "check_table",
    "measure",
    "measure_parts",
    "measure_steps",
    "recorded",
    "table",
    "worst_stack",
]

SIZE = Tool("arm-none-eabi-size", package="binutils-arm-none-eabi")
OBJDUMP = Tool("arm-none-eabi-objdump", package="binutils-arm-none-eabi")
MACHINES = tuple(TARGETS[name] for name in ("cortex-m3", "cortex-m4f", "cortex-m7"))
ENTRIES = ("gw_controller_init", "gw_controller_step", "gw_servo_init", "gw_servo_step")
SOURCES = "tests/c_core/footprint"
# Usual firmware flags: one section per function, so that the linker drops functions that are not called.
FLAGS = ("-O2", "-ffunction-sections", "-fdata-sections")
# What the paper's preset needs.
BARE = ("-DGW_WITH_CHANNELS=0", "-DGW_WITH_ESCAPE=0")


@dataclass(frozen=True)
class Footprint:
    """Bytes and instructions; steps are the longest over the recorded collision and the longest found by search.

    ``all_``: with channels, IMU and escape, all of it in use; the others: without them, as `BARE` builds it.
    """

    flash: int
    controller_ram: int  # without the window of the filter
    window_ram: int
    servo_ram: int
    stack: int
    step_recorded: int
    step_searched: int
    step_bristles: int
    servo_step: int
    all_flash: int
    all_ram: int
    all_stack: int
    all_step: int


# For Cortex-M4F.
TARGET = Footprint(
    flash=24576,
    controller_ram=1536,
    window_ram=12288,
    servo_ram=1536,
    stack=512,
    step_recorded=3000,
    step_searched=3000,
    step_bristles=4000,
    servo_step=300,
    all_flash=32768,
    all_ram=2048,
    all_stack=640,
    all_step=4500,
)
ROWS = {
    "flash": "Flash, bytes: init and step of controller and servo",
    "controller_ram": "RAM of the controller, bytes, without the window",
    "window_ram": "RAM of the filter window, bytes",
    "servo_ram": "RAM of a servo, bytes",
    "stack": "Worst stack, bytes",
    "step_recorded": "Longest step over a recorded collision, instructions",
    "step_searched": "Longest step found by search, instructions",
    "step_bristles": "The same with bristles for the rollers' friction",
    "servo_step": "Longest servo step, instructions",
    "all_flash": "Everything (channels, IMU, escape): flash, bytes",
    "all_ram": "Everything: RAM of the controller, bytes, without the window",
    "all_stack": "Everything: worst stack, bytes",
    "all_step": "Everything on: longest step found by search, instructions",
}


# What a program may call, with its PART of parts.c, None: linked.c; and what it is built without.
PARTS: Mapping[str, tuple[int | None, tuple[str, ...]]] = {
    "controller and servo, with everything": (None, ()),
    "controller and servo": (None, BARE),
    "the same, and the names of the configuration's fields": (1, BARE),
    "estimator with its tare, detector and admittance": (2, BARE),
    "estimator with its tare and detector": (4, BARE),
    "servo": (3, BARE),
}
SMALL = ("-Os", *FLAGS[1:])
# What is left out of everything, each without what stands above it, too: LEFT_OUT of measure.c.
STEPS = {
    "bristles for the rollers' friction": 1,
    "and the IMU": 2,
    "and motors observed between counts": 3,
}
TABLE_FILE, PARTS_FILE = "c_core/README.md", "docs/site/reference/c_cost.md"


def measure(context: Context, target: Target) -> Footprint:
    """Everything, at -O2 in float."""
    linked = _link(context, target)
    everything = _link(context, target, without=())
    return Footprint(
        flash=_flash(context, linked),
        stack=_stack(context, linked),
        **_run(context, target, *BARE),
        all_flash=_flash(context, everything),
        all_stack=_stack(context, everything),
        **_run(context, target),
    )


def measure_parts(context: Context, target: Target) -> dict[str, tuple[int, int]]:
    """Flash at -O2 and at -Os of programs that call these."""
    return {
        name: (
            _flash(context, _link(context, target, part, FLAGS, without)),
            _flash(context, _link(context, target, part, SMALL, without)),
        )
        for name, (part, without) in PARTS.items()
    }


def measure_steps(context: Context, target: Target) -> dict[str, int]:
    """Instructions of the longest step found by search, with less and less in use."""
    return {name: _run(context, target, f"-DLEFT_OUT={level}")["all_step"] for name, level in STEPS.items()}


def steps_table(steps: dict[str, int]) -> str:
    """The table of `PARTS_FILE`."""
    lines = ["| Longest step on Cortex-M4F, everything on but | instructions |", "|---|---:|"]
    lines += [f"| {name} | {instructions:,} |" for name, instructions in steps.items()]
    return "".join(f"{line}\n" for line in lines)


def parts_table(parts: dict[str, tuple[int, int]]) -> str:
    """The table of `PARTS_FILE`."""
    lines = ["| Flash on Cortex-M4F, bytes: a program that calls | -O2 | -Os |", "|---|---:|---:|"]
    lines += [f"| {name} | {fast:,} | {small:,} |" for name, (fast, small) in parts.items()]
    return "".join(f"{line}\n" for line in lines)


def recorded(
    measured: dict[str, Footprint], parts: dict[str, tuple[int, int]], steps: dict[str, int]
) -> dict[str, int]:
    """All of it as VERIFIED.json has it."""
    values = {f"{name} {field}": value for name, cost in measured.items() for field, value in asdict(cost).items()}
    for name, (fast, small) in parts.items():
        values |= {f"{name}, -O2": fast, f"{name}, -Os": small}
    return values | {f"everything on but {name}": step for name, step in steps.items()}


def check(root: Path, values: Mapping[str, int]) -> None:
    """`RungFailed` unless the texts show what was `recorded`."""
    check_table(
        root, {one.name: Footprint(**{field: values[f"{one.name} {field}"] for field in ROWS}) for one in MACHINES}
    )
    parts = {name: (values[f"{name}, -O2"], values[f"{name}, -Os"]) for name in PARTS}
    check_parts(root, parts, {name: values[f"everything on but {name}"] for name in STEPS})


def check_parts(root: Path, parts: dict[str, tuple[int, int]], steps: dict[str, int]) -> None:
    """`RungFailed` unless `PARTS_FILE` shows these tables."""
    text = (root / PARTS_FILE).read_text(encoding="utf-8")
    missing = [shown for shown in (parts_table(parts), steps_table(steps)) if shown not in text]
    if missing:
        raise RungFailed("\n".join([f"{PARTS_FILE} does not show what was measured:", *missing]))


def _link(
    context: Context,
    target: Target,
    part: int | None = None,
    flags: tuple[str, ...] = FLAGS,
    without: tuple[str, ...] = BARE,
) -> Path:
    """A program that contains only c_core and calls to it; gcc's .su files are next to it."""
    bare = replace(target, flags=tuple(flag for flag in target.flags if "specs" not in flag), support=())
    source = context.root / SOURCES / ("linked.c" if part is None else "parts.c")
    link = ("-nostartfiles", "-Wl,--gc-sections,-e,firmware", "-fstack-usage", f"-DPART={part or 0}")
    program = context.work / f"{target.name}{flags[0]}_{part or 0}{'' if without else '_all'}.elf"
    return bare.build(context, [*core_sources(context.core), source], program, *flags, *without, *link)


def _flash(context: Context, linked: Path) -> int:
    """Code and constants, and the initial values of data."""
    answer = context.run(context.which(SIZE), linked)
    text, data, *_ = answer.stdout.splitlines()[1].split()
    return int(text) + int(data)


def _run(context: Context, target: Target, *flags: str) -> dict[str, int]:
    assert target.emulator is not None
    counting = replace(target, emulator_arguments=("-icount", "shift=0", *target.emulator_arguments))
    golden = context.root / "tests/c_core/golden"
    example = context.root / EXAMPLE
    sources = [
        *core_sources(context.core),
        context.root / SOURCES / "measure.c",
        golden / "script.c",
        golden / "generator.c",
        example / "recorded_collision.c",
    ]
    includes = (f"-I{golden}", f"-I{example}")
    program = context.work / f"{target.name}_measure{len(flags)}"
    program = counting.build(context, sources, program, *FLAGS, *flags, *includes)
    answer = counting.run(context, program, timeout_s=600.0)
    return {name: int(value) for name, value in (line.split() for line in answer.stdout.splitlines())}


CALL = re.compile(r"\b(?:bl|b|b\.w|b\.n|bl\.w|beq\.w|bne\.w|blx)\s+[0-9a-f]+ <([^+>]+)>")
HEAD = re.compile(r"^[0-9a-f]+ <([^>]+)>:$")
REGISTERS = re.compile(r"\b(push|stmdb\s+sp!,|vpush)\s*\{([^}]*)\}")
LOWER = re.compile(r"\bsub(?:w|\.w)?\s+sp,\s*(?:sp,\s*)?#(\d+)|\[sp, #-(\d+)\]!")


def _stack(context: Context, linked: Path) -> int:
    usage: dict[str, int] = {}
    for file in linked.parent.glob(f"{linked.name}-*.su"):
        for line in file.read_text().splitlines():
            place, size, kind = line.split("\t")
            if kind != "static":
                raise RungFailed(f"the stack of {place} is {kind}")
            usage[place.rsplit(":", 1)[1]] = int(size)
    listing = context.run(context.which(OBJDUMP), "-d", "--no-show-raw-insn", linked).stdout
    return max(worst_stack(listing, usage, entry) for entry in ENTRIES)


def worst_stack(listing: str, usage: dict[str, int], entry: str) -> int:
    """Bytes of the deepest chain of calls from ``entry``; `RungFailed` on recursion and on calls through pointers.

    ``usage``: the compiler's figures for its functions; those of library functions are read from their instructions.
    """
    frames: dict[str, int] = {}
    calls: dict[str, set[str]] = {}
    name = ""
    for line in listing.splitlines():
        if head := HEAD.match(line):
            name = head[1]
            frames[name] = usage.get(name, 0)
            calls[name] = set()
            continue
        if not name:
            continue
        if call := CALL.search(line):
            calls[name].add(call[1])
        elif re.search(r"\bblx?\s+(r\d|ip)", line):
            raise RungFailed(f"{name} calls through a pointer: {line.strip()}")
        if name not in usage:
            frames[name] += _pushed(line)
    return _deepest(entry, frames, calls, ())


def _pushed(line: str) -> int:
    total = 0
    if match := REGISTERS.search(line):
        width = 8 if match[1] == "vpush" and "d" in match[2] else 4
        for part in match[2].split(","):
            first, _, last = part.strip().partition("-")
            count = int(last[1:]) - int(first[1:]) + 1 if last else 1
            total += width * count
    if match := LOWER.search(line):
        total += int(match[1] or match[2])
    return total


def _deepest(name: str, frames: dict[str, int], calls: dict[str, set[str]], path: Sequence[str]) -> int:
    if name in path:
        raise RungFailed(f"recursion: {' -> '.join([*path, name])}")
    below = [_deepest(callee, frames, calls, (*path, name)) for callee in sorted(calls[name]) if callee != name]
    return frames[name] + max(below, default=0)


def table(measured: dict[str, Footprint]) -> str:
    """The table of `TABLE_FILE`."""
    names = [name.replace("cortex-m", "Cortex-M").replace("4f", "4F") for name in measured]
    lines = [f"| | {' | '.join(names)} | target, M4F |", f"|---|{'---:|' * (len(names) + 1)}"]
    for field, text in ROWS.items():
        values = [f"{getattr(footprint, field):,}" for footprint in measured.values()]
        lines.append(f"| {text} | {' | '.join(values)} | {getattr(TARGET, field):,} |")
    return "".join(f"{line}\n" for line in lines)


def check_table(root: Path, measured: dict[str, Footprint]) -> None:
    """`RungFailed` unless `TABLE_FILE` shows the numbers measured for these machines."""
    readme = (root / TABLE_FILE).read_text(encoding="utf-8")
    shown = [_cells(line) for line in readme.splitlines() if line.startswith("| ")]
    (heading, *rows) = [_cells(line) for line in table(measured).splitlines() if not line.startswith("|---")]
    columns = next((cells for cells in shown if cells[-1:] == heading[-1:]), None)
    if columns is None:
        raise RungFailed(f"{TABLE_FILE} has no table of the footprint")
    wrong = []
    for row in rows:
        line = next((cells for cells in shown if cells[0] == row[0]), None)
        for name, value in zip(heading[1:], row[1:], strict=True):
            found = line[columns.index(name)] if line else "nothing"
            if found != value:
                wrong.append(f"{row[0]}, {name}: measured {value}, {TABLE_FILE} says {found}")
    if wrong:
        raise RungFailed("\n".join([*wrong, "python -m verify.footprint prints the tables anew"]))


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def _print() -> None:
    root = Path(__file__).parents[1]
    with tempfile.TemporaryDirectory() as folder:
        context = Context(root, Path(folder), os.environ["PATH"])
        print(table({target.name: measure(context, target) for target in MACHINES}))
        print(parts_table(measure_parts(context, TARGETS["cortex-m4f"])))
        print(steps_table(measure_steps(context, TARGETS["cortex-m4f"])), end="")


if __name__ == "__main__":
    _print()
