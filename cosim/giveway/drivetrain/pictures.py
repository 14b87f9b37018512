"""One picture of a linear drivetrain: Bode diagrams, the servo loop with its margins, steps, and poles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.style import context
from matplotlib.ticker import MultipleLocator

from giveway.base.files import check_file, check_output, replace_file, replace_folder
from giveway.drivetrain.record import write_json
from giveway.report.style import STYLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.drivetrain.analysis import Analysis
    from giveway.drivetrain.frequency_response import Sweep

__all__ = ["check_results", "picture", "write_picture", "write_results"]

FILES = (".png", ".svg", ".json")

COLOURS = {"gear stuck": "#8a8f98", "unpowered": "#c8500a", "servo": "#0b64a8"}
INK = "#2b2f36"
FREQUENCY_HZ = (0.1, 1000.0)
# Where a phase may begin: a double differentiator at +180, a loop that has integrated twice at -180 degrees.
HIGHEST_DEG, HIGHEST_LOOP_DEG = 225.0, 100.0
LOWEST_DEG = -405.0
POLES_SHOWN = 4.0  # up to this many times the fastest pole of the plant: those of a delay lie far out
DECADES = 5  # of gain shown below the highest
COLUMN_IN, HEIGHT_IN = 4.3, 9.2
# At rest the sensor shows the torque of the environment with the opposite sign, so the sign is inverted in the plot.
SIGN = {"environment": -1.0, "motor": 1.0}
TITLES = {
    "environment": "Environment torque to sensed torque (sign reversed)",
    "motor": "Motor torque to sensed torque",
}


def write_results(out: Path, title: str, analysis: Analysis, sweeps: Sequence[Sweep] = ()) -> list[Path]:
    """Write FILE.png, FILE.svg or FILE.json, by the ending, or drivetrain.png and .json into a folder."""
    if out.suffix in FILES:
        with replace_file(out) as temporary:
            _write(temporary, title, analysis, sweeps)
        return [out]
    names = ("drivetrain.png", "drivetrain.json")
    with replace_folder(out) as folder:
        for name in names:
            _write(folder / name, title, analysis, sweeps)
    return [out / name for name in names]


def check_results(out: Path) -> None:
    """Refuse, before any work is done, what `write_results` could not write."""
    if out.suffix in FILES:
        check_file(out)
    else:
        check_output(out)


def _write(path: Path, title: str, analysis: Analysis, sweeps: Sequence[Sweep]) -> None:
    if path.suffix == ".json":
        write_json(path, title, analysis, sweeps)
    else:
        write_picture(path, title, analysis, sweeps)


def write_picture(path: Path, title: str, analysis: Analysis, sweeps: Sequence[Sweep] = ()) -> None:
    """Write ``path`` (.png or .svg): `picture`."""
    with context(STYLE):
        date = {"Date": None} if path.suffix == ".svg" else {"Software": None}
        picture(title, analysis, sweeps).savefig(path, dpi=120, metadata=date)


def picture(title: str, analysis: Analysis, sweeps: Sequence[Sweep] = ()) -> Figure:
    """One column per source of the sensed torque, one for the servo loop and the poles."""
    sources = [source for source in SIGN if any(source in case.channels for case in analysis.cases.values())]
    columns = len(sources) + 1
    with context(STYLE):
        figure = Figure(figsize=(COLUMN_IN * columns, HEIGHT_IN), layout="constrained")
        figure.suptitle(title, x=0.01, ha="left", fontsize=12, color=INK)
        grid = figure.subplots(3, columns, squeeze=False)
        for column, source in enumerate(sources):
            _bode(grid[0, column], grid[1, column], source, analysis, sweeps)
            _steps(grid[2, column], source, analysis)
        _loop(grid[0, -1], grid[1, -1], analysis)
        _poles(grid[2, -1], analysis)
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _bode(gain: Axes, phase: Axes, source: str, analysis: Analysis, sweeps: Sequence[Sweep]) -> None:
    for name, case in analysis.cases.items():
        # A name for the legend, also where this case has no curve.
        label = {"gear stuck": "gear stuck", "unpowered": "gear slides, unpowered", "servo": "gear slides, servo"}[name]
        gain.plot([], [], color=COLOURS[name], label=label)
        if source in case.channels:
            curve = SIGN[source] * case.channels[source].response
            _curves(gain, phase, analysis.frequency_hz, curve, COLOURS[name], HIGHEST_DEG)
    measured = [sweep for sweep in sweeps if sweep.source == source]
    if sweeps:
        gain.plot([], [], "o", markersize=4.5, color="none", markeredgecolor=INK, label="measured on the FMU")
    for sweep in measured:
        case_curve = SIGN[source] * analysis.cases[sweep.case].channels[source].response
        of_model = np.interp(
            sweep.frequency_hz, analysis.frequency_hz, _degrees(case_curve, analysis.frequency_hz, HIGHEST_DEG)
        )
        point_deg = np.degrees(np.angle(SIGN[source] * sweep.response))
        point_deg += 360.0 * np.round((of_model - point_deg) / 360.0)  # the turn of the curve next to it
        marks: dict[str, Any] = {
            "markersize": 4.5,
            "color": "none",
            "markeredgecolor": COLOURS[sweep.case],
            "zorder": 3,
        }
        gain.plot(sweep.frequency_hz, np.abs(sweep.response), "o", **marks)
        phase.plot(sweep.frequency_hz, point_deg, "o", **marks)
    _dress(gain, phase, TITLES[source], "gain (N m/N m)")


def _loop(gain: Axes, phase: Axes, analysis: Analysis) -> None:
    _curves(gain, phase, analysis.frequency_hz, analysis.loop, COLOURS["servo"], HIGHEST_LOOP_DEG)
    margins = analysis.margins
    gain.axhline(1.0, color=INK, linewidth=0.8)
    phase.axhline(-180.0, color=INK, linewidth=0.8)
    mark: dict[str, Any] = {"color": INK, "linewidth": 1.6}
    paper = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.0}
    words: dict[str, Any] = {"textcoords": "offset points", "fontsize": 9, "color": INK, "bbox": paper}
    if margins.gain is not None and margins.gain_hz is not None:
        gain.plot([margins.gain_hz] * 2, [1.0 / margins.gain, 1.0], **mark)
        text = f"{20.0 * math.log10(margins.gain):.1f} dB\nat {margins.gain_hz:.3g} Hz"
        gain.annotate(text, (margins.gain_hz, 1.0), xytext=(0, 4), ha="center", va="bottom", **words)
    if margins.phase_deg is not None and margins.phase_hz is not None:
        there = float(
            np.interp(
                margins.phase_hz,
                analysis.frequency_hz,
                _degrees(analysis.loop, analysis.frequency_hz, HIGHEST_LOOP_DEG),
            )
        )
        near = -180.0 + 360.0 * round((there + 180.0) / 360.0)
        phase.plot([margins.phase_hz] * 2, [near, there], **mark)
        text = f"{margins.phase_deg:.1f}° at {margins.phase_hz:.3g} Hz"
        phase.annotate(text, (margins.phase_hz, near), xytext=(-4, -4), ha="right", va="top", **words)
    foot = 1.0 if margins.gain is None else 0.5 / margins.gain
    _dress(gain, phase, "Servo loop, broken at the motor torque", "gain", foot)


def _curves(
    gain: Axes,
    phase: Axes,
    frequency_hz: NDArray[np.float64],
    curve: NDArray[np.complex128],
    colour: str,
    highest_deg: float,
) -> None:
    gain.loglog(frequency_hz, np.abs(curve), color=colour)
    phase.semilogx(frequency_hz, _degrees(curve, frequency_hz, highest_deg), color=colour)


def _degrees(
    curve: NDArray[np.complex128], frequency_hz: NDArray[np.float64], highest_deg: float
) -> NDArray[np.float64]:
    """The phase without jumps; where the shown range begins it is within one turn below ``highest_deg``."""
    phase: NDArray[np.float64] = np.degrees(np.unwrap(np.angle(curve)))
    start = float(np.interp(FREQUENCY_HZ[0], frequency_hz, phase))
    return phase - 360.0 * math.ceil((start - highest_deg) / 360.0)


def _dress(gain: Axes, phase: Axes, title: str, label: str, foot: float = math.inf) -> None:
    """Titles and limits; the gain is shown down to ``foot`` at the least."""
    heights = [np.asarray(line.get_ydata(), dtype=float) for line in gain.lines]
    across = [np.asarray(line.get_xdata(), dtype=float) for line in gain.lines]
    shown = np.concatenate([y[x >= FREQUENCY_HZ[0]] for x, y in zip(across, heights, strict=True) if len(x) > 2])
    top = 10.0 ** math.ceil(math.log10(float(shown.max())))
    lowest = min(max(float(shown.min()), top / 10.0**DECADES), foot)
    bottom = 10.0 ** math.floor(math.log10(lowest))
    gain.set(title=title, ylabel=label, xlim=FREQUENCY_HZ, ylim=(bottom, top))
    phase.set(xlabel="frequency (Hz)", ylabel="phase (deg)", xlim=FREQUENCY_HZ)
    low, high = phase.get_ylim()
    low = max(low, LOWEST_DEG)  # a delay turns the phase without end
    phase.set_ylim(low, high)
    phase.yaxis.set_major_locator(MultipleLocator(45.0 if high - low < 270.0 else 90.0))
    gain.tick_params(labelbottom=False)


def _steps(axes: Axes, source: str, analysis: Analysis) -> None:
    for name, case in analysis.cases.items():
        if source in case.channels:
            axes.plot(1e3 * analysis.time_s, SIGN[source] * case.channels[source].step, color=COLOURS[name])
        elif not case.stable:
            axes.text(0.5, 0.5, f"{name}: unstable", transform=axes.transAxes, ha="center", color=COLOURS[name])
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.set(
        title=f"Step of 1 N m by the {source}" + (" (sign reversed)" if SIGN[source] < 0.0 else ""),
        xlabel="time (ms)",
        ylabel="sensed torque (N m)",
        xlim=(0.0, 1e3 * float(analysis.time_s[-1])),
    )


def _poles(axes: Axes, analysis: Analysis) -> None:
    plant = [pole.frequency_hz for name, case in analysis.cases.items() if name != "servo" for pole in case.poles]
    reach_hz = POLES_SHOWN * max(plant)
    left_out = 0
    for name, case in analysis.cases.items():
        shown = [pole for pole in case.poles if pole.frequency_hz <= reach_hz]
        left_out += len(case.poles) - len(shown)
        real = np.array([pole.real for pole in shown]) / (2.0 * math.pi)
        imaginary = np.array([pole.imaginary for pole in shown]) / (2.0 * math.pi)
        both = np.concatenate((imaginary, -imaginary))
        axes.plot(np.concatenate((real, real)), both, "x", color=COLOURS[name], markersize=7, markeredgewidth=1.8)
    axes.axvline(0.0, color=INK, linewidth=0.8)
    axes.axhline(0.0, color=INK, linewidth=0.8)
    title = "Poles s/2π, with servo ln(z)/2πT" + (f"; {left_out} more outside" if left_out else "")
    axes.set(title=title, xlabel="real part (Hz)", ylabel="imaginary part (Hz)")
    axes.margins(0.12)
