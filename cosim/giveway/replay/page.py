"""The page of a replay: curves as envelopes, the places of the hits, what was done to the log."""

from __future__ import annotations

import datetime
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.stretches import stretches
from giveway.base.version import VERSION
from giveway.replay.inputs import value_of
from giveway.replay.story import MODES
from giveway.replay.told import done_lines, mode_lines, wrong_lines
from giveway.replay.written import CURVES, Curves
from giveway.report.page import page
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.replay.play import Replay

__all__ = ["write_page"]

COLOURS = ("#0b64a8", "#c8500a", "#0a8a63")
MODE_COLOURS = ("#b9bec6", "#dfe8f1", "#c8500a", "#e8b04a", "#0a8a63", "#7a2ea0", "#20242b")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 1000, 190, 64, 12, 10, 34
HITS_DRAWN, HITS_LISTED = 400, 500
STRIP = 14
_TORQUES = tuple(f"wheel {wheel}" for wheel in range(WHEELS))
PANELS: Sequence[tuple[str, str, Sequence[str], Sequence[str]]] = (
    ("Force of the estimate", "N", ("force",), ("",)),
    ("Torque of the estimate about the centre", "N m", ("torque_z",), ("",)),
    ("What the detector compares with its threshold", "", ("statistic",), ("",)),
    ("Torque that the model does not explain", "N m", [f"residual[{i}]" for i in range(WHEELS)], _TORQUES),
    ("Sensed torque", "N m", [f"torque[{i}]" for i in range(WHEELS)], _TORQUES),
)


def write_page(path: Path, replay: Replay, curves: Curves, robot: str) -> None:
    """Write the page to ``path``."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("giveway.report", "templates"), autoescape=True, undefined=jinja2.StrictUndefined
    )
    story = replay.story
    findings = replay.findings
    title = f"Replay of {replay.source.path.name}"
    body = environment.get_template("replay.html.j2").render(
        title=title,
        version=VERSION,
        created=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        count=story.count,
        duration=f"{replay.did.duration_s:.6g}",
        wrong=wrong_lines(replay),
        fine=findings.fine,
        open=findings.open,
        done=done_lines(replay, robot),
        modes=mode_lines(replay),
        mode_keys=[(name, MODE_COLOURS[at]) for at, name in enumerate(MODES) if at in story.modes.total_s],
        strip=_strip(replay),
        panels=[
            (title, unit, _panel(replay, curves, title, names), _keys(labels)) for title, unit, names, labels in PANELS
        ],
        top=_top(replay),
        hits=story.detections[:HITS_LISTED],
        more=story.count - min(len(story.detections), HITS_LISTED),
    )
    path.write_text(page("report", f"giveway: {title}", {"figures": []}, body=body), encoding="utf-8")


def _keys(labels: Sequence[str]) -> list[tuple[str, str]]:
    return [(label, COLOURS[at]) for at, label in enumerate(labels) if label]


def _ticks(low: float, high: float, wanted: int) -> list[float]:
    """Round numbers in [low, high]."""
    raw = (high - low) / wanted
    size = 10.0 ** math.floor(math.log10(raw))
    step = next(size * factor for factor in (1.0, 2.0, 2.5, 5.0, 10.0) if size * factor >= raw)
    return [step * number for number in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _time_axis(end_s: float, bottom: float) -> list[str]:
    parts = []
    for tick in _ticks(0.0, end_s, 8):
        x = LEFT + (WIDTH - LEFT - RIGHT) * tick / end_s
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{bottom}" class="grid"/>')
        parts.append(f'<text x="{x:.1f}" y="{bottom + 15}" text-anchor="middle">{tick:g}</text>')
    parts.append(f'<text x="{WIDTH - RIGHT}" y="{bottom + 29}" text-anchor="end">time, s</text>')
    return parts


def _panel(replay: Replay, curves: Curves, title: str, names: Sequence[str]) -> str:
    """Least and largest value of each curve over time as a band; dashed lines are hits."""
    time_s = curves.envelope.time_s
    bands = [curves.envelope.curve(CURVES.index(name)) for name in names]
    known = [values[np.isfinite(values)] for band in bands for values in band]
    low = min((float(values.min()) for values in known if values.size), default=0.0)
    high = max((float(values.max()) for values in known if values.size), default=1.0)
    low, high = min(low, 0.0), max(high, 0.0)
    high = high if high > low else low + 1.0
    end_s, bottom = _end(replay), HEIGHT - BOTTOM

    def x_of(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return LEFT + (WIDTH - LEFT - RIGHT) * values / end_s

    def y_of(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return bottom - (bottom - TOP) * (values - low) / (high - low)

    parts = _time_axis(end_s, bottom)
    for tick in _ticks(low, high, 4):
        y = float(y_of(np.array(tick)))
        parts.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}" class="grid"/>')
        parts.append(f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{tick:g}</text>')
    for detection in replay.story.detections[:HITS_DRAWN]:
        x = float(x_of(np.array(detection.time_s)))
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{bottom}" class="hit"/>')
    for (least, largest), colour in zip(bands, COLOURS, strict=False):
        for begin, end in stretches(np.isfinite(least)):
            part = slice(begin, end)
            across = x_of(time_s[part])
            there = zip(across, y_of(largest[part]), strict=True)
            back = zip(across[::-1], y_of(least[part])[::-1], strict=True)
            points = " ".join(f"{a:.1f},{b:.1f}" for a, b in (*there, *back))
            parts.append(f'<polygon points="{points}" fill="{colour}" stroke="{colour}" class="band"/>')
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{title}">{"".join(parts)}</svg>'


def _end(replay: Replay) -> float:
    return replay.choice.step_s * max(int(replay.did.steps), 1)


def _strip(replay: Replay) -> str:
    """Modes over time."""
    end_s, parts = _end(replay), []
    for span in replay.story.modes.kept:
        x = LEFT + (WIDTH - LEFT - RIGHT) * span.start_s / end_s
        width = max(0.5, (WIDTH - LEFT - RIGHT) * (span.end_s - span.start_s) / end_s)
        title = f"<title>{MODES[span.value]}, {span.start_s:.3f} to {span.end_s:.3f} s</title>"
        fill = MODE_COLOURS[span.value]
        parts.append(f'<rect x="{x:.2f}" y="{TOP}" width="{width:.2f}" height="{STRIP}" fill="{fill}">{title}</rect>')
    parts += _time_axis(end_s, TOP + STRIP)
    return f'<svg viewBox="0 0 {WIDTH} {TOP + STRIP + BOTTOM}" role="img" aria-label="Modes">{"".join(parts)}</svg>'


def _top(replay: Replay) -> str:
    """The robot from above, x to the right: places and forces of the hits."""
    count = int(value_of(replay.parameters, "outline.count"))
    outline = [
        (value_of(replay.parameters, f"outline.x[{i}]"), value_of(replay.parameters, f"outline.y[{i}]"))
        for i in range(count)
    ]
    reach = 1.6 * max((math.hypot(x, y) for x, y in outline), default=1.0)
    largest = max((one.force_n for one in replay.story.detections), default=1.0) or 1.0
    scale = 200.0 / reach

    def at(x: float, y: float) -> str:
        return f"{220 + scale * x:.1f},{220 - scale * y:.1f}"

    parts = [f'<polygon points="{" ".join(at(x, y) for x, y in outline)}" class="outline"/>']
    parts.append(f'<text x="{220 + scale * 0.3 * reach:.0f}" y="214">x, forward</text>')
    for one in replay.story.detections[:HITS_DRAWN]:
        x, y = 1e-3 * one.point_x_mm, 1e-3 * one.point_y_mm
        length = 0.45 * reach / largest
        begin = at(x - length * one.force_x_n, y - length * one.force_y_n)
        title = f"<title>{one.words}</title>"
        parts.append(f'<polyline points="{begin} {at(x, y)}" class="push">{title}</polyline>')
        cx, cy = at(x, y).split(",")
        parts.append(f'<circle cx="{cx}" cy="{cy}" r="4" class="place">{title}</circle>')
    return f'<svg viewBox="0 0 440 440" role="img" aria-label="Places of the hits">{"".join(parts)}</svg>'
