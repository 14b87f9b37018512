"""Live: CSV lines on standard input, detections on standard output as they happen."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import typer

from giveway.base.terminal import print_document, print_warnings, wants_json
from giveway.replay.csv_log import LineLog
from giveway.replay.play import Played, Replay
from giveway.replay.told import wrong_lines
from giveway.replay.wheel_plan import WheelPlan

if TYPE_CHECKING:
    from giveway.replay.mapping import Wishes
    from giveway.replay.play import Choice
    from giveway.replay.source import Source

__all__ = ["follow_lines"]


def follow_lines(wishes: Wishes, choice_of: Callable[[Source], tuple[Choice, str]]) -> None:
    """Play standard input until it ends or Ctrl-C; then a summary."""
    source = LineLog(iter(sys.stdin.readline, ""))
    choice, robot = choice_of(source)
    with Replay(source, wishes, choice) as replay:
        _say(f"Following standard input; controller: {robot}; drives {'off' if replay.observes else 'on'}")
        if replay.makes_plan:
            late = f"detections are told {WheelPlan.DELAY_S:g} s late"
            _say(f"The lines have no plan: it is taken to be the motion of the wheels, and {late} (--observe: at once)")
        ended = " (Ctrl-C)"
        try:
            for row, values in source.rows(replay.wanted):
                _tell(replay.feed(np.array([values]), row))
            ended = ""
        except KeyboardInterrupt:
            pass
        if replay.did.rows < 2:
            _say(f"Followed {replay.did.rows} rows{ended}; nothing was played")
            return
        _tell(replay.end())
        print_warnings(wrong_lines(replay))
        did, count = replay.did, replay.story.count
        _say(f"Followed {did.rows} rows, {did.steps * choice.step_s:.6g} s{ended}: {count} detections")


def _tell(played: Played | None) -> None:
    for detection in () if played is None else played.detections:
        if wants_json():
            print_document(vars(detection), indent=None)
        else:
            _say(detection.words)


def _say(text: str) -> None:
    typer.echo(text)
    sys.stdout.flush()
