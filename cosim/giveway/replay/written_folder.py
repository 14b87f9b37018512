"""A replay into a folder: report.html, replay.parquet, replay.mcap, replay.json."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from giveway.base.files import check_output, replace_folder, write_text
from giveway.base.terminal import print_warnings, print_written
from giveway.base.version import VERSION
from giveway.library.replay import controller_outputs
from giveway.replay.play import OUTPUTS, Choice, Replay
from giveway.replay.source import file_hash
from giveway.replay.told import done_lines, mode_lines, wrong_lines
from giveway.replay.written import Curves, McapFile, ParquetFile, residual_torques

if TYPE_CHECKING:
    from giveway.replay.mapping import Wishes
    from giveway.replay.source import Source

__all__ = ["SCHEMA_VERSION", "play_into"]

SCHEMA_VERSION = 1
LISTED = 20


def play_into(folder: Path, source: Source, wishes: Wishes, choice: Choice, robot: str, every_output: bool) -> bool:
    """Play ``source`` and write all of it to ``folder``; True if Ctrl-C ended it, and what was played is kept."""
    from giveway.replay.page import write_page

    check_output(folder)
    outputs = tuple(controller_outputs()) if every_output else OUTPUTS
    started, ended = (time.perf_counter(), time.process_time()), False
    with Replay(source, wishes, choice, outputs) as replay, replace_folder(folder) as temporary:
        curves = Curves(choice.step_s)
        parquet = ParquetFile(temporary / "replay.parquet", replay, outputs)
        mcap = McapFile(temporary / "replay.mcap", replay)
        try:
            for played in replay.all():
                residual = residual_torques(played.outputs, replay.parameters)
                parquet.add(played, residual)
                mcap.add(played, residual)
                curves.add(played, residual)
        except KeyboardInterrupt:
            if not replay.did.steps:
                raise
            ended = True
            replay.story.end(replay.did.steps * choice.step_s)
        finally:
            parquet.close()
            mcap.close()
        write_page(temporary / "report.html", replay, curves, robot)
        write_text(temporary / "manifest.json", json.dumps(_manifest(replay, robot, ended), indent=2) + "\n")
        wall_s, cpu_s = time.perf_counter() - started[0], time.process_time() - started[1]
    _print(replay, robot)
    print_written(*(folder / name for name in ("report.html", "replay.parquet", "replay.mcap", "manifest.json")))
    played_s = replay.did.steps * choice.step_s
    speed = f"{played_s / wall_s:.0f} times real time ({cpu_s:.2f} s of processor time)"
    typer.echo(f"Played {played_s:.6g} s in {wall_s:.2f} s, report included: {speed}")
    if ended:
        typer.echo(f"Interrupted at t = {played_s:.3f} s; what was played is kept.", err=True)
    return ended


def _print(replay: Replay, robot: str) -> None:
    findings = replay.findings
    lines = [*done_lines(replay, robot), *(("in order", text) for text in findings.fine)]
    lines += [("not known", text) for text in findings.open]
    lines += [(f"mode {name}", text) for name, text in mode_lines(replay)]
    width = max(len(name) for name, _ in lines)
    for name, text in lines:
        typer.echo(f"{name:{width}}  {text}")
    print_warnings(wrong_lines(replay))
    for detection in replay.story.detections[:LISTED]:
        typer.echo(detection.words)
    count = replay.story.count
    rest = f", the first {LISTED} of them here" if count > LISTED else ""
    typer.echo(f"{count} detection{'' if count == 1 else 's'}{rest}")


def _manifest(replay: Replay, robot: str, ended: bool) -> dict[str, Any]:
    from giveway.base import native
    from giveway.library.batch_library import library

    did, findings = replay.did, replay.findings
    return {
        "schema_version": SCHEMA_VERSION,
        "giveway": VERSION,
        "interrupted": ended,
        "log": {"file": replay.source.path.name, "sha256": file_hash(replay.source.path)},
        "library_sha256": library().models[native.MODELS[0]].sha256,
        "step_s": replay.choice.step_s,
        "parameters_set": {"controller": replay.parameters},
        "done": done_lines(replay, robot),
        "warnings": wrong_lines(replay),
        "in_order": findings.fine,
        "not_known": findings.open,
        "gaps": [[gap.start_s, gap.length_s, gap.place] for gap in did.gaps],
        "modes_s": dict(mode_lines(replay)),
        "detections": [vars(one) for one in replay.story.detections],
        "detection_count": replay.story.count,
    }
