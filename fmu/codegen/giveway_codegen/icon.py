"""The picture of an FMU, as SVG and as PNG, from one list of shapes."""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass

__all__ = ["PICTURES", "png", "svg"]

SIZE = 128  # pixels, and the unit of the shapes' coordinates; y downwards

Point = tuple[float, float]


@dataclass(frozen=True)
class Stroke:
    """A line with round ends through points, or the filled polygon they enclose with round corners."""

    points: tuple[Point, ...]
    width: float
    colour: str
    filled: bool = False


_BODY, _DARK, _WHEEL, _HIT, _SPRING = "#4b7bb0", "#22394f", "#2b2b2b", "#d1495b", "#e8a33d"


def _triangle(x: float, y: float, radius: float) -> tuple[Point, ...]:
    angles = (math.radians(degrees) for degrees in (0, 120, 240))
    return tuple((x + radius * math.cos(angle), y - radius * math.sin(angle)) for angle in angles)


def _robot(x: float, y: float, size: float) -> list[Stroke]:
    """A base with three omnidirectional wheels from above; the wheels lie across its radial directions."""
    shapes = [Stroke(_triangle(x, y, -size), 0.25 * size, _BODY, filled=True)]
    for cx, cy in _triangle(x, y, 0.72 * size):
        along = ((y - cy) / size, (cx - x) / size)
        ends = tuple((cx + sign * 0.33 * along[0] * size, cy + sign * 0.33 * along[1] * size) for sign in (-1, 1))
        shapes.append(Stroke(ends, 0.2 * size, _WHEEL))
    return shapes


def _arrow(x0: float, y0: float, x1: float, y1: float, colour: str) -> list[Stroke]:
    length = math.hypot(x1 - x0, y1 - y0)
    ux, uy = (x1 - x0) / length, (y1 - y0) / length
    head = ((x1, y1), (x1 - 13 * ux - 9 * uy, y1 - 13 * uy + 9 * ux), (x1 - 13 * ux + 9 * uy, y1 - 13 * uy - 9 * ux))
    return [Stroke(((x0, y0), (x1 - 10 * ux, y1 - 10 * uy)), 6, colour), Stroke(head, 2, colour, filled=True)]


def _zigzag(x0: float, x1: float, y: float, height: float, turns: int) -> Stroke:
    step = (x1 - x0) / (2 * turns)
    points = [(x0, y)]
    points += [(x0 + (i + 0.5) * step, y + (height if i % 2 else -height)) for i in range(2 * turns)]
    return Stroke((*points, (x1, y)), 4, _SPRING)


def _block(x0: float, y0: float, x1: float, y1: float, colour: str) -> Stroke:
    return Stroke(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), 6, colour, filled=True)


PICTURES: dict[str, list[Stroke]] = {
    # a push and the escape from it
    "controller": [*_robot(82, 64, 42), *_arrow(4, 64, 38, 64, _HIT), *_arrow(62, 64, 98, 64, "#ffffff")],
    # a robot on the floor and the slider that hits it
    "testbed": [
        Stroke(((6, 116), (122, 116)), 4, _DARK),
        *_robot(84, 62, 36),
        _block(8, 50, 26, 78, _DARK),
        _zigzag(28, 46, 64, 10, 2),
        Stroke(((50, 44), (50, 84)), 6, _HIT),
    ],
    # motor, sensor spring, wheel
    "drivetrain": [
        _block(12, 46, 42, 82, _BODY),
        Stroke(((8, 56), (8, 72)), 6, _DARK),
        _zigzag(46, 80, 64, 14, 3),
        Stroke(((98, 36), (98, 92)), 28, _WHEEL),
        Stroke(((80, 64), (98, 64)), 6, _SPRING),
    ],
    # carrier, spring and latch, plate
    "bumper": [
        _block(10, 26, 32, 102, _BODY),
        _zigzag(36, 88, 48, 12, 4),
        Stroke(((36, 82), (58, 82)), 8, _DARK),
        Stroke(((66, 82), (88, 82)), 8, _HIT),
        Stroke(((98, 24), (98, 104)), 12, _DARK),
    ],
}


def svg(shapes: list[Stroke]) -> str:
    """A square drawing with a transparent background."""
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {SIZE} {SIZE}" width="{SIZE}" height="{SIZE}">']
    for shape in shapes:
        points = " ".join(f"{x:.2f},{y:.2f}" for x, y in shape.points)
        tag, fill = ("polygon", shape.colour) if shape.filled else ("polyline", "none")
        lines.append(
            f'  <{tag} points="{points}" fill="{fill}" stroke="{shape.colour}" stroke-width="{shape.width:g}" '
            'stroke-linecap="round" stroke-linejoin="round"/>'
        )
    return "\n".join([*lines, "</svg>"]) + "\n"


def _distance(x: float, y: float, shape: Stroke) -> float:
    """Distance of a point from the shape's edge, negative inside."""
    points = shape.points
    edges = list(zip(points, (*points[1:], points[0]), strict=True))
    nearest = math.inf
    inside = False
    for (x0, y0), (x1, y1) in edges if shape.filled else edges[:-1]:
        dx, dy = x1 - x0, y1 - y0
        along = max(0.0, min(1.0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy)))
        nearest = min(nearest, math.hypot(x - x0 - along * dx, y - y0 - along * dy))
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) * dx / dy:
            inside = not inside
    return (-nearest if shape.filled and inside else nearest) - shape.width / 2


def png(shapes: list[Stroke]) -> bytes:
    """The same drawing in pixels; edges are smoothed over one pixel."""
    pixels = [[0.0, 0.0, 0.0, 0.0] for _ in range(SIZE * SIZE)]  # colour times opacity, opacity
    for shape in shapes:
        colour = [int(shape.colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        xs, ys = zip(*shape.points, strict=True)
        margin = shape.width / 2 + 1
        for row in range(max(0, int(min(ys) - margin)), min(SIZE, int(max(ys) + margin) + 1)):
            for column in range(max(0, int(min(xs) - margin)), min(SIZE, int(max(xs) + margin) + 1)):
                cover = max(0.0, min(1.0, 0.5 - _distance(column + 0.5, row + 0.5, shape)))
                if cover > 0:
                    pixel = pixels[row * SIZE + column]
                    for channel, value in enumerate((*colour, 1.0)):
                        pixel[channel] = cover * value + (1 - cover) * pixel[channel]
    lines = bytearray()
    for row in range(SIZE):
        lines.append(0)  # no filter
        for *colour, opacity in pixels[row * SIZE : (row + 1) * SIZE]:
            lines += bytes(round(255 * value / opacity) if opacity else 0 for value in colour)
            lines.append(round(255 * opacity))

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", SIZE, SIZE, 8, 6, 0, 0, 0)  # 8 bits each of red, green, blue and opacity
    packed = zlib.compress(bytes(lines), 9)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b"")
