"""Margins of loops whose crossings are many, the table in dB and ms, and the picture's curves and units."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable

import numpy as np
import pytest
from giveway.base.units import factor
from giveway.drivetrain import pictures
from giveway.drivetrain.analysis import Analysis, Margins, _margins, analyse, table_rows
from giveway.drivetrain.model import read
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import brentq

Loop = Callable[[NDArray[np.complex128]], NDArray[np.complex128]]
LOOPS: dict[str, Loop] = {
    # s^3 + K (s + 2)^2 = 0 is stable for K > 1 alone (Routh): K = 5 may fall to a fifth, and with a delay not grow.
    "must not fall": lambda s: 5.0 * (s + 2.0) ** 2 / s**3,
    "must neither fall nor grow": lambda s: 5.0 * (s + 2.0) ** 2 / s**3 * np.exp(-0.02 * s),
    # Through -180 degrees again and again, first with gains above 1, then below.
    "many crossings of the real axis": lambda s: (
        5e5 / (s * (s + 9.0)) * 400.0 / (s**2 + 2.0 * s + 400.0) * np.exp(-0.3 * s)
    ),
    # Through a gain of 1 slowly, and twice more beside a resonance.
    "many crossings of the gain": lambda s: 2.0 / s + 40.0 * s / (s**2 + s + 900.0),
}


def crossings(loop: Loop, function: Callable[[complex], float]) -> list[complex]:
    """The loop where ``function`` of it goes through 0; jumps of an angle do not count."""
    w = np.geomspace(0.01, 900.0, 20_001)
    found = []
    values = np.array([function(value) for value in loop(1j * w)])
    for row in np.flatnonzero(values[:-1] * values[1:] < 0.0):
        if abs(values[row] - values[row + 1]) < 1.0:
            at = brentq(lambda x: function(complex(loop(np.array([1j * x]))[0])), w[row], w[row + 1], xtol=1e-12)
            found.append((at, complex(loop(np.array([1j * at]))[0])))
    return found  # type: ignore[return-value]


@pytest.mark.parametrize("name", LOOPS)
def test_of_many_crossings_the_nearest_is_the_margin(name: str) -> None:
    loop = LOOPS[name]
    frequency_hz = np.geomspace(0.01, 900.0, 20_001) / (2.0 * math.pi)
    found = _margins(loop(2j * np.pi * frequency_hz), frequency_hz, stable=True)
    real_axis = crossings(
        loop, lambda value: math.remainder(math.atan2(value.imag, value.real) - math.pi, 2.0 * math.pi)
    )
    gains = [(1.0 / abs(value), at) for at, value in real_axis]  # type: ignore[misc]
    growing, falling = [one for one in gains if one[0] > 1.0], [one[0] for one in gains if one[0] < 1.0]
    # Between points 0.06 % apart the curve is taken as straight.
    near = {"rel": 1e-5}
    if growing:
        assert found.gain == pytest.approx(min(growing)[0], **near)
        assert found.gain_hz == pytest.approx(min(growing)[1] / (2.0 * math.pi), **near)
    else:
        assert found.gain is None
    assert found.gain_least == (pytest.approx(max(falling), **near) if falling else None)
    if name == "many crossings of the real axis":
        assert min(len(growing), len(falling)) > 2
    unit_gain = crossings(loop, lambda value: math.log(abs(value)))
    angles = [(math.degrees(math.atan2(value.imag, value.real)) + 180.0, at) for at, value in unit_gain]  # type: ignore[misc]
    if name == "many crossings of the gain":
        assert len(angles) == 3
    assert found.phase_deg == pytest.approx(min(min(a, 360.0 - a) for a, _ in angles), rel=1e-4)
    assert found.delay_s == pytest.approx(min(math.radians(a) / at for a, at in angles), rel=1e-4)
    assert found.crossover_hz == pytest.approx(sorted(at / (2.0 * math.pi) for _, at in angles), **near)


def test_the_conditionally_stable_loop_may_fall_to_a_fifth() -> None:
    frequency_hz = np.geomspace(0.01, 900.0, 20_001) / (2.0 * math.pi)
    found = _margins(LOOPS["must not fall"](2j * np.pi * frequency_hz), frequency_hz, stable=True)
    assert found.gain is None
    assert found.gain_least == pytest.approx(0.2, rel=1e-5)


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    return analyse(*read(load="wheel", delay=2))


def test_the_table_says_the_margins_in_its_units(analysis: Analysis) -> None:
    margins = Margins(
        gain=10.0, gain_hz=50.0, gain_least=None, phase_deg=33.0, phase_hz=7.0, crossover_hz=[3.0, 7.0],
        delay_s=0.0125, distance=0.5, distance_hz=11.0,
    )  # fmt: skip
    rows = {row[0].strip(): row[-1] for row in table_rows(dataclasses.replace(analysis, margins=margins))}
    assert rows["servo loop: gain margin, dB"] == "20.0 at 50.0 Hz"  # a factor of ten, upwards
    assert rows["phase margin, deg"] == "33.0 at 7.0 Hz"
    assert rows["crossover, Hz"] == "3.00, 7.00"
    assert rows["delay margin, ms"] == "12.50"
    assert rows["distance from -1"] == "0.500 at 11.0 Hz"


@pytest.fixture(scope="module")
def drawn(analysis: Analysis, tmp_path_factory: pytest.TempPathFactory) -> Figure:
    """The picture as it was saved."""
    figures: list[Figure] = []

    class Kept(Figure):
        def savefig(self, *arguments: object, **options: object) -> None:
            figures.append(self)
            super().savefig(*arguments, **options)  # type: ignore[arg-type]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pictures, "Figure", Kept)
        pictures.write_picture(tmp_path_factory.mktemp("picture") / "curves.svg", "title", analysis)
    (figure,) = figures
    return figure


def in_si(values: object, label: str, wanted: str) -> NDArray[np.float64]:
    """Of an axis with the label "name (unit)"; plain numbers where it has none."""
    found = re.search(r"\(([^()]+)\)", label)
    unit = found[1].replace(" ", ".") if found else "1"
    return np.asarray(values, dtype=float) * factor(label, unit, wanted)


def panel(figure: Figure, row: int, column: int) -> Axes:
    (axes,) = (
        one for one in figure.axes
        if (spec := one.get_subplotspec()) and (spec.rowspan.start, spec.colspan.start) == (row, column)
    )  # fmt: skip
    return axes


def has_curve(axes: Axes, x: NDArray[np.float64], y: NDArray[np.float64], units: tuple[str, str], x_label: str) -> bool:
    """A line of the panel, read in the units of its labels."""
    lines = [
        (in_si(line.get_xdata(), x_label, units[0]), in_si(line.get_ydata(), axes.get_ylabel(), units[1]))
        for line in axes.lines
        if len(np.asarray(line.get_xdata())) == len(x)
    ]
    return any(np.allclose(a, x, rtol=1e-12) and np.allclose(b, y, rtol=1e-9, atol=1e-12) for a, b in lines)


def test_the_curves_of_the_picture_are_in_the_units_of_its_labels(analysis: Analysis, drawn: Figure) -> None:
    frequency = analysis.frequency_hz
    for column, (source, sign) in enumerate((("environment", -1.0), ("motor", 1.0))):
        gain, phase, steps = (panel(drawn, row, column) for row in range(3))
        shared = phase.get_xlabel()
        for case in analysis.cases.values():
            if source not in case.channels:
                continue
            channel = case.channels[source]
            curve = sign * channel.response
            assert has_curve(gain, frequency, np.abs(curve), ("Hz", "1"), shared)
            assert has_curve(steps, analysis.time_s, sign * channel.step, ("s", "N.m"), steps.get_xlabel())
            angle = np.unwrap(np.angle(curve))
            turns = [2.0 * math.pi * turn for turn in range(-3, 4)]
            assert any(has_curve(phase, frequency, angle + turn, ("Hz", "rad"), shared) for turn in turns)
    gain, phase, poles = (panel(drawn, row, 2) for row in range(3))
    assert has_curve(gain, frequency, np.abs(analysis.loop), ("Hz", "1"), phase.get_xlabel())
    for case in analysis.cases.values():
        places = {(round(pole.real, 6), round(pole.imaginary, 6)) for pole in case.poles}
        shown = {
            (round(float(a), 6), round(float(b), 6))
            for line in poles.lines if line.get_marker() == "x"
            for a, b in zip(
                2.0 * math.pi * in_si(line.get_xdata(), poles.get_xlabel(), "Hz"),
                2.0 * math.pi * in_si(line.get_ydata(), poles.get_ylabel(), "Hz"), strict=True,
            )
        }  # fmt: skip
        assert places & shown  # those far out are left out


def test_the_picture_marks_the_margins(analysis: Analysis, drawn: Figure) -> None:
    margins = analysis.margins
    assert margins.gain is not None
    assert margins.phase_deg is not None
    words = [text.get_text() for axes in drawn.axes for text in axes.texts]
    assert any(text.startswith(f"{20.0 * math.log10(margins.gain):.1f} dB\n") for text in words)
    assert any(text.startswith(f"{margins.phase_deg:.1f}°") for text in words)
    bars = [line for line in panel(drawn, 0, 2).lines if len(np.asarray(line.get_xdata())) == 2]
    assert any(sorted(bar.get_ydata()) == pytest.approx([1.0 / margins.gain, 1.0]) for bar in bars)
