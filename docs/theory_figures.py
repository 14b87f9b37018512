"""The pictures of the pages on theory and detector, as SVG, with Trikey's numbers; `python -m docs` draws them.

They are 360 px wide, a phone's width, with letters of 14 px or more, and bring their own light ground for dark pages.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from giveway.robot.robot_file import Robot, read_robot

__all__ = ["FIGURES", "draw"]

Point = tuple[float, float]

WIDTH = 360
BODY, WHEEL, ROLL, PUSH, LINE = "#c9cfd6", "#3c4650", "#0b64a8", "#c22a1e", "#7a2ea0"
HEAD = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" \
font-family="sans-serif" font-size="15" role="img" aria-label="{title}">
<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">\
<path d="M0 0L8 4L0 8z" fill="context-stroke"/></marker></defs>
<rect width="100%" height="100%" rx="8" fill="#ffffff"/>
"""


def draw(root: Path, folder: Path) -> None:
    """Write every figure to ``folder``."""
    robot = read_robot(root / "robots" / "trikey.toml")
    for name, figure in FIGURES.items():
        (folder / name).write_text(figure(robot), encoding="utf-8")


def geometry(robot: Robot) -> str:
    """The robot from above: rolling directions, roller directions, a push and the line of zero moment."""
    scale, middle, height = 360.0, (140.0, 185.0), 390
    distance = robot.value("wheel.distance")

    def at(x: float, y: float) -> Point:
        return middle[0] + scale * x, middle[1] - scale * y

    corners = [at(robot.value("outline.x", i), robot.value("outline.y", i)) for i in range(robot.count("outline.x"))]
    drawn = [f'<polygon points="{_points(corners)}" fill="{BODY}" fill-opacity="0.45" stroke="{WHEEL}"/>']
    for wheel in range(3):
        phi = 2.0 * math.pi / 3.0 * wheel
        normal, along = (math.cos(phi), math.sin(phi)), (-math.sin(phi), math.cos(phi))
        x, y = distance * normal[0], distance * normal[1]
        ends = [at(x + side * 0.06 * along[0], y + side * 0.06 * along[1]) for side in (-1.0, 1.0)]
        drawn.append(_line(ends[0], ends[1], WHEEL, "stroke-width='12' stroke-linecap='butt'"))
        start = at(x, y)
        drawn.append(_arrow(start, at(x + 0.15 * along[0], y + 0.15 * along[1]), ROLL))
        drawn.append(_arrow(start, at(x + 0.10 * normal[0], y + 0.10 * normal[1]), LINE))
        drawn.append(_label(at(x + 0.185 * along[0], y + 0.185 * along[1]), f"t{wheel}", ROLL))
        drawn.append(_label(at(x + 0.135 * normal[0], y + 0.135 * normal[1]), f"n{wheel}", LINE))
    # A push on the side from corner 0 to corner 1, at a third of it, not straight into the side.
    (x0, y0), (x1, y1) = ((robot.value("outline.x", i), robot.value("outline.y", i)) for i in (0, 1))
    point = (x0 + 0.36 * (x1 - x0), y0 + 0.36 * (y1 - y0))
    angle = math.radians(-105.0)
    force = (math.cos(angle), math.sin(angle))
    moment = point[0] * force[1] - point[1] * force[0]  # (p - c) x F of a force of 1, the lever with its sign
    foot = (-moment * -force[1], -moment * force[0])  # where the line of zero moment comes nearest to the middle
    line = [at(point[0] + along * force[0], point[1] + along * force[1]) for along in (-0.24, 0.42)]
    drawn.append(_line(line[0], line[1], PUSH, "stroke-dasharray='5 4'"))
    tail = at(point[0] - 0.21 * force[0], point[1] - 0.21 * force[1])
    drawn.append(_arrow(tail, at(*point), PUSH, 3.5))
    drawn.append(_line(at(0.0, 0.0), at(*foot), WHEEL, "stroke-width='1.5'"))
    drawn += [_dot(at(0.0, 0.0), WHEEL), _dot(at(*point), PUSH)]
    drawn.append(_label((tail[0] + 34, tail[1] + 8), "F on it", PUSH))
    drawn.append(_label((at(*point)[0] + 14, at(*point)[1] - 6), "p", PUSH))
    drawn.append(_label((at(0.0, 0.0)[0] - 12, at(0.0, 0.0)[1] + 14), "c", WHEEL))
    drawn.append(_label(((at(0.0, 0.0)[0] + at(*foot)[0]) / 2, (at(0.0, 0.0)[1] + at(*foot)[1]) / 2 - 10), "d", WHEEL))
    drawn += _key(
        [(ROLL, "t: the wheel rolls"), (LINE, "n: its rollers roll"), (PUSH, "push; dashed: zero moment")], height - 66
    )
    return _svg("Wheels, rollers and a push from above", height, drawn)


def friction(robot: Robot) -> str:
    """What a roller resists with: of its speed (28), and of its deflection before it slides."""
    torque, slope = robot.value("roller.coulomb_torque"), robot.value("roller.tanh_slope")
    stiffness, radius = robot.value("roller.presliding_stiffness"), robot.value("roller.radius")
    most = torque / radius
    speeds = [0.25 * i for i in range(-48, 49)]
    sliding = [(speed, torque * math.tanh(slope * speed)) for speed in speeds]
    yields = 1000.0 * most / stiffness  # mm
    held = [(0.0, 0.0), (yields, most), (2.5 * yields, most)]
    drawn = _axes(
        (58.0, 30.0, 280.0, 130.0), (-12.0, 12.0), (-1.3 * torque, 1.3 * torque), "torque over speed, -12 to 12 rad/s"
    )
    drawn.append(_curve((58.0, 30.0, 280.0, 130.0), (-12.0, 12.0), (-1.3 * torque, 1.3 * torque), sliding, ROLL))
    drawn.append(_label((112.0, 48.0), f"up to {torque:g} N m", ROLL))
    below = (58.0, 220.0, 280.0, 120.0)
    drawn += _axes(below, (0.0, 2.5 * yields), (0.0, 1.3 * most), "force over deflection, mm")
    drawn.append(_curve(below, (0.0, 2.5 * yields), (0.0, 1.3 * most), held, PUSH))
    drawn.append(_label((210.0, 290.0), f"up to {most:.0f} N", PUSH))
    drawn.append(_label((below[0] + below[2] / 2.5, 356.0), f"{yields:.2f}", WHEEL))
    return _svg("Friction of a roller over its speed, and over its deflection at rest", 400, drawn)


def statistic(robot: Robot) -> str:
    """The detector's statistic in a hit of 0.5 m/s on the resting robot: computed, by the batch library."""
    import giveway
    from giveway import batch

    box, x, y = (40.0, 24.0, 300.0, 230.0), (-5.0, 16.0), (0.0, 3.0)
    drawn = _axes(box, x, y, "ms after the contact")
    threshold = box[1] + box[3] * (1.0 - 1.0 / y[1])
    drawn.append(_line((box[0], threshold), (box[0] + box[2], threshold), WHEEL, 'stroke-dasharray="5 4"'))
    drawn.append(_label((78.0, threshold - 14.0), "noticed", WHEEL))
    for bumper, colour in (("none", PUSH), ("spring", ROLL)):
        scenario = giveway.experiment("motionless").scenario(bumper, robot=robot.path)
        traces = batch.run(scenario).traces
        after = 1000.0 * (traces["time"].values - float(traces["testbed.truth.first_contact_time"].values[-1]))
        shown = (after >= x[0]) & (after <= x[1])
        values = traces["controller.detection.statistic"].values[shown].clip(*y)
        drawn.append(_curve(box, x, y, list(zip(after[shown].tolist(), values.tolist(), strict=True)), colour))
    drawn += [_label((box[0] + box[2] * (ms - x[0]) / (x[1] - x[0]), 268.0), str(ms), WHEEL) for ms in (0, 5, 10, 15)]
    drawn += _key([(PUSH, "no bumper"), (ROLL, "spring bumper")], 314)
    return _svg("The detector's statistic over time, with and without a bumper", 350, drawn)


FIGURES: dict[str, Callable[[Robot], str]] = {
    "theory_geometry.svg": geometry,
    "theory_friction.svg": friction,
    "detector_statistic.svg": statistic,
}


def _svg(title: str, height: int, drawn: Sequence[str]) -> str:
    return HEAD.format(width=WIDTH, height=height, title=title) + "\n".join(drawn) + "\n</svg>\n"


def _points(points: Sequence[Point]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _line(start: Point, end: Point, colour: str, more: str = "") -> str:
    return (
        f'<line x1="{start[0]:.1f}" y1="{start[1]:.1f}" x2="{end[0]:.1f}" y2="{end[1]:.1f}" stroke="{colour}" {more}/>'
    )


def _arrow(start: Point, end: Point, colour: str, width: float = 2.5) -> str:
    return _line(start, end, colour, f'stroke-width="{width}" marker-end="url(#tip)"')


def _dot(at: Point, colour: str) -> str:
    return f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="4" fill="{colour}"/>'


def _label(at: Point, text: str, colour: str) -> str:
    return (
        f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" fill="{colour}" text-anchor="middle" '
        f'dominant-baseline="middle">{text}</text>'
    )


def _key(entries: Sequence[tuple[str, str]], top: float) -> list[str]:
    rows = []
    for row, (colour, text) in enumerate(entries):
        y = top + 22.0 * row
        rows.append(_line((20.0, y), (46.0, y), colour, 'stroke-width="3"'))
        rows.append(f'<text x="56" y="{y:.0f}" fill="{WHEEL}" dominant-baseline="middle">{text}</text>')
    return rows


def _axes(box: tuple[float, float, float, float], x: Point, y: Point, title: str) -> list[str]:
    left, top, width, height = box
    zero = (left - width * x[0] / (x[1] - x[0]), top + height * y[1] / (y[1] - y[0]))
    return [
        _line((left, zero[1]), (left + width, zero[1]), WHEEL),
        _line((zero[0], top), (zero[0], top + height), WHEEL),
        _label((left + width / 2, top + height + 34.0), title, WHEEL),
    ]


def _curve(box: tuple[float, float, float, float], x: Point, y: Point, points: Sequence[Point], colour: str) -> str:
    left, top, width, height = box
    drawn = [
        (left + width * (px - x[0]) / (x[1] - x[0]), top + height * (y[1] - py) / (y[1] - y[0])) for px, py in points
    ]
    return f'<polyline points="{_points(drawn)}" fill="none" stroke="{colour}" stroke-width="3"/>'
