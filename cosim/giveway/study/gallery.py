"""The example studies and their pictures on the page of studies; each comes with its finding in one sentence."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.style import context

from giveway.base.files import replace_file
from giveway.report.style import STYLE
from giveway.study.answers import Answers, load
from giveway.study.engine import Report, sweep
from giveway.study.results_table import read_runs
from giveway.study.study_file import read

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]

__all__ = ["LatchClaim", "SensorTrade", "draw_all", "latch_claim", "sensor_trade"]

COLOURS = ("#7a2ea0", "#0b64a8", "#0a8a63", "#c8500a", "#8a6d00")
RAISED = 1.02  # times the plain spring's peak: less is within what plate and cover do at any latch force
SHOWN_TO = 1.4  # times the bound


@dataclass(frozen=True)
class LatchClaim:
    """What the latch does, over plates, springs and latch forces, shape (plates, springs, latches).

    Attributes:
        plate_kg, spring_npm, latch_n: the levels.
        bound_n: v sqrt(k_b m) of each spring: the peak of a massless spring on the slider alone.
        peak: peak force over that of the same bumper without latch; stated magnet, weakest, strongest (last axis).
        lead_ms: how much earlier than that bumper the collision is noticed; likewise.
    """

    plate_kg: Numbers
    spring_npm: Numbers
    latch_n: Numbers
    bound_n: Numbers
    peak: Numbers
    lead_ms: Numbers

    def allowed(self, worst: bool) -> Numbers:
        """The latch force up to which the peak is not raised, over the bound, shape (plates, springs).

        ``worst``: with the strongest magnet of the tolerance, too.
        """
        ratio = self.peak.max(axis=-1) if worst else self.peak[..., 0]
        found = np.empty(ratio.shape[:2])
        for index in np.ndindex(found.shape):
            row = ratio[index]
            above = int((row > RAISED).argmax()) if (row > RAISED).any() else len(row) - 1
            below = above - 1
            share = (RAISED - row[below]) / (row[above] - row[below]) if row[above] > RAISED else 1.0
            force = self.latch_n[below] + share * (self.latch_n[above] - self.latch_n[below])
            found[index] = force / self.bound_n[index[1]]
        return found

    def lead_at(self, allowed: Numbers) -> Numbers:
        """The lead in ms at ``allowed`` (plates, springs) of the bound, with the stated magnet."""
        found = np.empty(allowed.shape)
        for plate, spring in np.ndindex(allowed.shape):
            force = allowed[plate, spring] * self.bound_n[spring]
            found[plate, spring] = np.interp(force, self.latch_n, self.lead_ms[plate, spring, :, 0])
        return found

    def sentence(self) -> str:
        """The finding."""
        stated, worst = self.allowed(False), self.allowed(True)
        light, heavy = stated[0], stated[-1]
        lead = self.lead_at(stated)
        soft, stiff = self.spring_npm[0], self.spring_npm[-1]
        return (
            f"On a plate of {self.plate_kg[0]:g} kg a latch leaves the peak force as it is up to "
            f"{light.min():.2f} to {light.max():.2f} of v sqrt(k m), on {self.plate_kg[-1]:g} kg up to "
            f"{heavy.min():.2f} to {heavy.max():.2f}; a magnet that may be 30 % stronger takes that to "
            f"{worst[0].min():.2f} to {worst[0].max():.2f} and {worst[-1].min():.2f} to {worst[-1].max():.2f}. "
            f"At that limit the collision is noticed {_span(lead[:, -1])} ms earlier with the spring of "
            f"{1e-3 * stiff:g} N/mm, {_span(lead[:, 0])} ms with that of {1e-3 * soft:g} N/mm: a latch pays with stiff "
            "springs."
        )


def _span(values: Numbers) -> str:
    """ "6 to 9", or "6" if both are that."""
    low, high = f"{values.min():z.0f}", f"{values.max():z.0f}"
    return low if low == high else f"{low} to {high}"


def latch_claim(answers: Answers) -> LatchClaim:
    """What the study `examples/studies/magnetic_latch.toml` says about the paper's claim."""
    plate, spring, latch = (np.array(one.levels) for one in answers.setup.varied)
    shape = (len(plate), len(spring), len(latch), answers.runs.samples)
    runs = read_runs(answers.folder, ["peak force of the run", "detection time"])
    peak, detection = (runs[name].reshape(shape) for name in ("peak force of the run", "detection time"))
    hit = answers.setup.cases[0].hit
    mass = float(answers.setup.cases[0].scenario.parameters("testbed")["slider.mass"])
    assert hit is not None
    return LatchClaim(
        plate_kg=plate,
        spring_npm=spring,
        latch_n=latch,
        bound_n=hit.speed_mps * np.sqrt(spring * mass),
        peak=peak / peak[:, :, :1, :1],
        lead_ms=detection[:, :, :1, :1] - detection,
    )


def latch_figure(claim: LatchClaim) -> Figure:
    """Peak force and lead over the latch force, for each plate."""
    figure = Figure(figsize=(10.5, 6.0), layout="constrained")
    grid = figure.subplots(2, len(claim.plate_kg), sharex=True, sharey="row")
    for column, plate in enumerate(claim.plate_kg):
        upper, lower = grid[:, column]
        for row, (spring, colour) in enumerate(zip(claim.spring_npm, COLOURS, strict=False)):
            share = claim.latch_n / claim.bound_n[row]
            for axes, values in ((upper, claim.peak[column, row]), (lower, claim.lead_ms[column, row])):
                axes.fill_between(share, values.min(axis=1), values.max(axis=1), color=colour, alpha=0.12, lw=0)
                axes.plot(share, values[:, 0], color=colour, label=f"{1e-3 * spring:g} N/mm")
        upper.set_title(f"plate of {plate:g} kg")
        lower.set_xlabel("latch force over v $\\sqrt{k_b m}$")
        for axes in (upper, lower):
            axes.axvline(1.0, color="#2b2f36", lw=0.9, ls="--")
            axes.set_xlim(0.0, SHOWN_TO)
        upper.set_ylim(0.8, 2.2)
        lower.set_ylim(-10.0, 60.0)
    grid[0, 0].set_ylabel("peak force over that of the plain spring")
    grid[1, 0].set_ylabel("noticed earlier than with it (ms)")
    grid[0, 0].legend(title="spring rate; band: magnet +-30 %", loc="upper left")
    return figure


@dataclass(frozen=True)
class SensorTrade:
    """Sensor stiffness against gear friction: means over collisions and noise, shape (stiffnesses, frictions).

    Attributes:
        stiffness, friction: the levels, N m/rad and N m.
        detection_ms, error, peak_n: detection time, error of the estimated force over the true one, peak force.
        place_mm: error of the estimated contact point.
    """

    stiffness: Numbers
    friction: Numbers
    detection_ms: Numbers
    error: Numbers
    place_mm: Numbers
    peak_n: Numbers

    def sentence(self) -> str:
        """The finding."""
        usual = len(self.friction) - 2  # the robot's own friction
        time, peak = self.detection_ms[:, usual], self.peak_n[:, usual]
        stiff = self.detection_ms[-1]
        return (
            f"A sensor of {self.stiffness[-1]:g} instead of {self.stiffness[0]:g} N m/rad notices the collision after "
            f"{time[-1]:.0f} instead of {time[0]:.0f} ms (gear friction {self.friction[usual]:g} N m) at a peak force "
            f"{100.0 * (peak[-1] / peak[0] - 1.0):.0f} % higher; friction before a stiff sensor helps, since a stuck "
            f"motor holds against the wheel: {stiff[0]:.0f} ms and {100.0 * self.error[-1, 0]:.0f} % of force error "
            f"without it, {stiff[-1]:.0f} ms and {100.0 * self.error[-1, -1]:.0f} % with {self.friction[-1]:g} N m."
        )


def sensor_trade(answers: Answers) -> SensorTrade:
    """What the study `examples/studies/sensor_stiffness.toml` says."""
    stiffness, friction = (np.array(one.levels) for one in answers.setup.varied)
    shape = (len(stiffness), len(friction), answers.runs.samples, len(answers.setup.cases))
    force, detection, place, peak = "force at detection", "detection time", "location error", "peak force of the run"
    found = read_runs(answers.folder, [detection, force, f"{force} (true)", place, peak])
    runs = {name: values.reshape(shape) for name, values in found.items()}
    error = np.abs(runs[force] - runs[f"{force} (true)"]) / runs[f"{force} (true)"]
    means = [values.mean(axis=(2, 3)) for values in (runs[detection], error, runs[place], runs[peak])]
    return SensorTrade(stiffness, friction, *means)


def sensor_figure(trade: SensorTrade, usual: float) -> Figure:
    """All of it over the stiffness; ``usual``: the robot's own, N m/rad."""
    figure = Figure(figsize=(10.5, 6.0), layout="constrained")
    grid = figure.subplots(2, 2, sharex=True).ravel()
    panels = (
        ("detection time (ms)", trade.detection_ms),
        ("force error at detection (% of true)", 100.0 * trade.error),
        ("peak contact force (N)", trade.peak_n),
        ("error of the contact point (mm)", trade.place_mm),
    )
    for axes, (label, values) in zip(grid, panels, strict=True):
        for j, (friction, colour) in enumerate(zip(trade.friction, COLOURS, strict=False)):
            axes.plot(trade.stiffness, values[:, j], "o-", ms=3, color=colour, label=f"{friction:g} N m")
        axes.set_xscale("log")
        axes.axvline(usual, color="#2b2f36", lw=0.9, ls="--")
        axes.set_title(label)
    for axes in (grid[0], grid[1], grid[3]):
        axes.set_ylim(0.0)
    for axes in grid[2:]:
        axes.set_xlabel("stiffness of the torque sensor (N m/rad)")
    grid[0].legend(title="gear friction")
    return figure


def draw_all(
    examples: Path, studies: Path, out: Path, showing: Callable[[str], AbstractContextManager[Report]]
) -> Iterator[tuple[Path, str]]:
    """Run the example studies (again, if they are not stored in ``studies``) and draw their pictures into ``out``.

    Yields each picture with its finding, which the picture carries as its description, too.
    """
    for name, draw in (("magnetic_latch", _draw_latch), ("sensor_stiffness", _draw_sensor)):
        setup = read(examples / f"{name}.toml")
        with showing(setup.name) as progress:
            outcome = sweep(setup, studies / name, progress=progress)
        if outcome.interrupted:
            raise KeyboardInterrupt
        with context(STYLE):
            figure, sentence = draw(load(studies / name))
            path = out / f"study_{name}.png"
            with replace_file(path) as temporary:
                # The picture contains its numbers, so that an outdated copy can be recognised.
                figure.savefig(temporary, dpi=130, metadata={"Software": None, "Description": sentence})
        yield path, sentence


def _draw_latch(answers: Answers) -> tuple[Figure, str]:
    claim = latch_claim(answers)
    return latch_figure(claim), claim.sentence()


def _draw_sensor(answers: Answers) -> tuple[Figure, str]:
    trade = sensor_trade(answers)
    usual = answers.runs.columns.start[answers.runs.columns.index["testbed.drivetrain.stiffness"]]
    return sensor_figure(trade, float(usual)), trade.sentence()
