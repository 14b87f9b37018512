"""What `giveway tune` says: tables and sentences."""

from __future__ import annotations

import math
from collections.abc import Sequence

from giveway.robot.variables import table
from giveway.tuning.peaks import CONFIDENCE, EXTRAPOLATION
from giveway.tuning.thresholds import MOTION, NAMES, REST
from giveway.tuning.tuned import Tuned

__all__ = ["Table", "remarks", "tables"]

Table = tuple[str, tuple[str, ...], Sequence[tuple[str, ...]]]


def tables(tuned: Tuned) -> list[Table]:
    """Title, heads and rows of each."""
    found = [_identified(tuned), _thresholds(tuned), _alarms(tuned)]
    if tuned.felt:
        found.append(_felt(tuned))
    if tuned.noticed:
        rows = [
            (one.log, f"{one.push.start_s:g} to {one.push.end_s:g}", _number(one.delay_s, 1e3, "not noticed"))
            for one in tuned.noticed
        ]
        found.append(("Marked pushes", ("log", "time, s", "noticed after, ms"), rows))
    return found


def _number(value: float | None, scale: float = 1.0, otherwise: str = "-") -> str:
    return otherwise if value is None or not math.isfinite(value) else f"{scale * value:.4g}"


def _identified(tuned: Tuned) -> Table:
    rows: list[tuple[str, ...]] = []
    found = tuned.identified
    if found.friction is not None:
        for symbol, one, unit in (
            ("roller friction B_r", found.friction.coulomb_torque_nm, "N m"),
            ("its slope alpha", found.friction.tanh_slope_s_rad, "s/rad"),
        ):
            rows.append((symbol, f"{one.value:.4g}", f"{one.low:.4g} to {one.high:.4g}", unit))
    rows.append(("noise of a torque sample", _number(found.noise_nm), "", "N m"))
    rows.append(("drift of a resting torque, with what stuck gears hold", _number(found.drift_nm_per_h), "", "N m/h"))
    for when in (REST, MOTION):
        error = tuned.errors[when]
        if error is not None:
            rows.append((f"estimated force {when}, rms; 99 %", f"{error.rms_n:.3g}; {error.outer_n:.3g}", "", "N"))
    return f"{tuned.robot}: from {tuned.hours:.3g} h without contact", ("", "value", "95 % interval", "unit"), rows


def _thresholds(tuned: Tuned) -> Table:
    variables = table("controller")
    rows = [
        (name, f"{tuned.before[name]:.4g}", f"{float(tuned.chosen.thresholds[name]):.4g}", variables[name].unit)
        for name in NAMES
    ]
    return "Thresholds", ("controller", "before", "now", "unit"), rows


def _alarms(tuned: Tuned) -> Table:
    middle, low, high = tuned.chosen.tail.rate(1.0)
    fewest, most = tuned.chosen.tail.counts(1.0, tuned.hours)
    rows = [
        ("wished, at most", f"{tuned.rate_per_hour:g}", ""),
        ("expected from the tail of the peaks", f"{middle:.3g}", f"{low:.3g} to {high:.3g}"),
        ("upper 95 % bound", f"{tuned.chosen.upper_per_hour:.3g}", ""),
        (f"alarms in these {tuned.hours:.3g} h, replayed", f"{tuned.chosen.alarms}", ""),
        (f"alarms in other {tuned.hours:.3g} h like these", "", f"{fewest} to {most}"),
    ]
    return "False alarms per hour", ("", "value", f"{100 * CONFIDENCE:.0f} % interval"), rows


def _felt(tuned: Tuned) -> Table:
    rows = []
    for one in tuned.felt:
        size = "alarmed by itself" if math.isnan(one.smallest) else _number(one.smallest, 1.0, "none")
        rows.append((f"{one.kind} {one.situation}", size, one.unit, _number(one.delay_s, 1e3)))
    return "Noticed from all sides, by the robot as its file says", ("", "smallest", "unit", "twice it after, ms"), rows


def remarks(tuned: Tuned) -> list[str]:
    """What holds, and what does not."""
    said = list(tuned.said)
    tail = tuned.chosen.tail
    if tuned.identified.touched:
        said.insert(
            0,
            f"TOUCHED? {tuned.identified.why}. If something did, the thresholds miss such contacts: name its times "
            "with --pushes, and tune again. If nothing did, the rollers have another friction than (27), and the "
            "thresholds allow for it.",
        )
    elif tuned.identified.friction is None:
        said.append(f"The rollers' friction stays as it was: {tuned.identified.why}")
    if tuned.identified.noise_nm is None:
        said.append("The noise stays as it was: the logs have too little rest, or rows that are not the controller's.")
    for (channel, when), factor in tuned.chosen.factors.items():
        if factor is None:
            said.append(f"The {channel} channel {when} has too few peaks of its own: it follows the others.")
    said.append(
        f"{len(tail.peaks.heights)} peaks of the statistic, {len(tail.excesses)} in the tail; as far as they come in "
        f"bunches they count less: as {len(tail.excesses) / tail.bunching:.3g}."
    )
    if tuned.extrapolated:
        said.append(
            f"{tuned.rate_per_hour:g}/h is EXTRAPOLATED by the tail of the peaks (at most {EXTRAPOLATION:g} times the "
            f"hours): {tuned.hours:.3g} h do not show it; {tuned.hours_needed:.3g} h without an alarm would."
        )
        higher = [name for name in NAMES if float(tuned.chosen.thresholds[name]) > tuned.before[name]]
        if higher:
            said.append(
                f"HIGHER than before: {', '.join(higher)}. Thresholds cover what short logs leave open of rare peaks: "
                "more hits are missed with these. Longer logs may lower them."
            )
    else:
        said.append(f"{tuned.hours:.3g} h are enough to show {tuned.rate_per_hour:g}/h by counting.")
    if not tuned.keeps:
        said.append("NOT KEPT: within the ranges of the controller no thresholds are this quiet on these logs.")
    said.append("It holds for motion like that of the logs: other floors, speeds or loads need logs of their own.")
    return said
