"""`giveway tune`: from log files to thresholds, what they cost, and a new robot file."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.checks import finite
from giveway.base.errors import FileError, GivewayError
from giveway.base.files import check_file, replace_files
from giveway.identification.calibrated_robot import friction_values
from giveway.robot.changes import NewValue, changed_robot
from giveway.robot.robot_file import Robot, read_robot
from giveway.robot.variables import Value, table
from giveway.tuning.felt import Felt, felt
from giveway.tuning.identified import Identified, ModelError, identify, model_error
from giveway.tuning.logs import Log, Push, read_log, read_pushes
from giveway.tuning.peaks import EXTRAPOLATION, hours_to_count
from giveway.tuning.thresholds import MOTION, NAMES, REST, Chosen, choose, settings_of

if TYPE_CHECKING:
    from giveway.replay.mapping import Wishes

__all__ = ["Noticed", "Tuned", "check_hours", "check_rate", "noticed", "tune", "tune_robot"]

HASH_DIGITS = 12
CHANNELS_KIND = 2
NOISE, CURRENT_NOISE = "drivetrain.torque_noise", "motor.current_noise"
LEAST_RATE, MOST_RATE = 1e-4, 1000.0
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Noticed:
    """A marked push: ``delay_s`` after its start it is noticed; None: it is not."""

    log: str
    push: Push
    delay_s: float | None


@dataclass(frozen=True)
class Tuned:
    """What `tune` found.

    Attributes:
        robot: name in the robot file.
        rate_per_hour: the wished one.
        hours: of logs without pushes.
        logs: name and first digits of the hash.
        identified: friction, noise, drift.
        errors: of the model at rest and in motion.
        before: the thresholds that the robot had.
        chosen: the new ones.
        felt: what they notice; empty if that was not asked for.
        noticed: the marked pushes.
        said: what was assumed.
    """

    robot: str
    rate_per_hour: float
    hours: float
    logs: tuple[tuple[str, str], ...]
    identified: Identified
    errors: Mapping[str, ModelError | None]
    before: Mapping[str, float]
    chosen: Chosen
    felt: tuple[Felt, ...]
    noticed: tuple[Noticed, ...]
    said: tuple[str, ...]

    @property
    def hours_needed(self) -> float:
        """Without an alarm these show the wished rate without any assumption about the tail."""
        return hours_to_count(self.rate_per_hour)

    @property
    def extrapolated(self) -> bool:
        """The rate follows from the tail of the peaks: the hours alone do not show it."""
        return self.hours < self.hours_needed

    @property
    def keeps(self) -> bool:
        """The upper bound is not above the wished rate (but for the rounding of the thresholds)."""
        return self.chosen.upper_per_hour <= 1.05 * self.rate_per_hour


def tune(
    logs: Sequence[Path | str],
    robot: Path | str,
    false_alarms_per_hour: float,
    *,
    pushes: Path | str | None = None,
    smallest: bool = True,
    wishes: Wishes | None = None,
    threads: int = 1,
    progress: Progress = lambda what: None,
) -> Tuned:
    """Friction, noise and thresholds for ``false_alarms_per_hour``, from ``logs`` in which nothing else touched it.

    Args:
        logs: files as `giveway replay` reads them.
        robot: the robot file.
        pushes: a CSV file with the times in which something pushed the robot, s since the first row of the log.
        smallest: also what is noticed with the new thresholds, in some simulated pushes.

    Raises:
        GivewayError: the hours of the logs do not support this rate, or something is wrong in a file.
    """
    check_rate(false_alarms_per_hour)
    path = Path(robot)
    file = read_robot(path)
    parameters = table("controller").robot_values(file)
    kind = parameters.get("detector.kind", CHANNELS_KIND)
    if kind != CHANNELS_KIND:
        raise GivewayError("controller.detector.kind", kind, f"{CHANNELS_KIND}: thresholds are those of two channels")
    paths = [Path(log) for log in logs]
    if len({one.resolve() for one in paths}) < len(paths):
        raise GivewayError("logs", ", ".join(one.name for one in paths), "each log once: twice it would seem surer")
    read = []
    for one in paths:
        progress(f"reading {one.name}")
        read.append(read_log(one, file, parameters, wishes))
    _check_different(read)
    if pushes is not None:
        marked = read_pushes(Path(pushes), {log.name: log.duration_s for log in read})
        read = [dataclasses.replace(log, pushes=marked[log.name]) for log in read]
    hours = sum(float(np.count_nonzero(log.free())) * log.step_s for log in read) / 3600.0
    if hours == 0.0:
        why = "; ".join(["no free motion", *(said for log in read for said in log.said)])
        raise GivewayError("logs", why, "some minutes in which nothing pushes and the sensors are good")
    check_hours(hours, false_alarms_per_hour)
    progress("friction and noise")
    identified = identify(read, file)
    known = {**parameters, **_believed(identified)}
    progress("thresholds")
    chosen = choose(read, known, false_alarms_per_hour)
    everything = {**known, **chosen.thresholds}
    errors = {when: model_error(read, everything, when == MOTION) for when in (REST, MOTION)}
    found: tuple[Felt, ...] = ()
    if smallest:
        progress("pushes")
        found = felt(path, {**_believed(identified), **chosen.thresholds}, threads)
    return Tuned(
        file.name or path.stem,
        false_alarms_per_hour,
        hours,
        tuple((log.name, log.sha256[:HASH_DIGITS]) for log in read),
        identified,
        MappingProxyType(errors),
        MappingProxyType(settings_of(parameters)),
        chosen,
        found,
        tuple(noticed(log, push, everything) for log in read for push in log.pushes),
        tuple(said for log in read for said in log.said),
    )


def check_rate(rate_per_hour: float) -> None:
    """Refuse a rate that nobody can wish for."""
    finite("--false-alarms", rate_per_hour, LEAST_RATE, MOST_RATE, "1/h")


def check_hours(hours: float, rate_per_hour: float) -> None:
    """Refuse a rate that ``hours`` of logs do not support."""
    needed = 1.0 / (EXTRAPOLATION * rate_per_hour)
    if hours >= needed:
        return
    least = 1.0 / (EXTRAPOLATION * hours)
    allowed = (
        f"at least {least:.3g}/h with {hours:.3g} h of free motion; this rate takes {needed:.3g} h of logs, and "
        f"{hours_to_count(rate_per_hour):.3g} h to be shown without the tail of the peaks"
    )
    raise GivewayError("--false-alarms", f"{rate_per_hour:g}/h", allowed)


def _check_different(logs: Sequence[Log]) -> None:
    for index, log in enumerate(logs):
        for other in logs[:index]:
            if np.array_equal(log.torque_nm, other.torque_nm):
                raise GivewayError(log.name, f"the same content as {other.name}", "each log once")


def _believed(identified: Identified) -> dict[str, Value]:
    """What the controller is told of friction and noise."""
    found: dict[str, Value] = {}
    if identified.friction is not None:
        found["friction.coulomb_torque"] = identified.friction.coulomb_torque_nm.value
        found["friction.tanh_slope"] = identified.friction.tanh_slope_s_rad.value
    if identified.noise_nm is not None:
        found["estimator.torque_noise"] = identified.noise_nm
    return found


def noticed(log: Log, push: Push, parameters: Mapping[str, Value]) -> Noticed:
    """The first alarm in the time of ``push``, from a replay that ends with it."""
    found = log.replayed(parameters, ("detection.count",))["detection.count"]
    begin, end = (min(round(at / log.step_s), log.steps - 1) for at in (push.start_s, push.end_s))
    more = np.flatnonzero(found[begin : end + 1] > found[max(begin - 1, 0)])
    return Noticed(log.name, push, None if not len(more) else float(more[0]) * log.step_s)


def tune_robot(
    logs: Sequence[Path],
    robot: Path,
    false_alarms_per_hour: float,
    out: Path | None,
    report: Path | None = None,
    **others: object,
) -> tuple[Tuned, tuple[Path, ...]]:
    """`tune`, and the files that were asked for; nothing is written before everything is known."""
    if out is not None:
        if out.suffix != ".toml":
            raise GivewayError("--out", out, "a file that ends with .toml")
        if out.resolve() == robot.resolve():
            raise GivewayError("--out", out, "another file than --robot: the old values are worth keeping")
        check_file(out)
    if report is not None:
        if report.suffix != ".html":
            raise GivewayError("--report", report, "a file that ends with .html")
        check_file(report)
    tuned = tune(logs, robot, false_alarms_per_hour, **others)  # type: ignore[arg-type]
    texts: dict[Path, str] = {}
    if out is not None:
        texts[out] = robot_text(robot, read_robot(robot), tuned)
    if report is not None:
        from giveway.tuning.page import page_text

        texts[report] = page_text(tuned)
    if texts:
        with replace_files(*texts) as temporaries:
            for temporary, text in zip(temporaries, texts.values(), strict=True):
                temporary.write_text(text, encoding="utf-8")
    return tuned, tuple(texts)


def robot_text(path: Path, robot: Robot, tuned: Tuned) -> str:
    """The robot file with the new numbers; what it has not stated stands at its end."""
    names = ", ".join(f"{name} (sha256 {digits})" for name, digits in tuned.logs)
    source = f"giveway tune: {names}"
    changes: dict[str, NewValue] = {}
    if tuned.identified.friction is not None:
        changes |= friction_values(tuned.identified.friction, source)
    if tuned.identified.noise_nm is not None:
        name, value = _stated_noise(robot, tuned.identified.noise_nm)
        note = "standard deviation of a sample while the robot stands"
        changes[name] = NewValue(float(f"{value:.4g}"), source, "fitted", "high", note)
    note = (
        f"for {tuned.rate_per_hour:g} false alarms per hour; upper 95 % bound {tuned.chosen.upper_per_hour:.3g} "
        f"from {tuned.hours:.3g} h"
    )
    if tuned.extrapolated:
        note += f", by the tail of the peaks: counting would take {tuned.hours_needed:.3g} h"
    if tuned.identified.touched:
        note += f"; TOUCHED? {tuned.identified.why}"
    variables = table("controller")
    for threshold in NAMES:
        new = NewValue(float(tuned.chosen.thresholds[threshold]), source, "fitted", "medium", note)
        changes[f"controller.{threshold}"] = dataclasses.replace(new, unit=variables[threshold].unit)
    try:
        return changed_robot(path, changes)
    except GivewayError as error:
        raise FileError(path, str(error)) from None


def _stated_noise(robot: Robot, noise_nm: float) -> tuple[str, float]:
    """The entry of the robot file that says how noisy its torque is, and its value."""
    if robot.follows_from(NOISE) is None:
        return NOISE, noise_nm
    constant = float(robot.value("motor.torque_constant")) * float(robot.value("motor.gear_ratio"))
    return CURRENT_NOISE, noise_nm / constant
