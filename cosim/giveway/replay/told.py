"""A replay in words: what was read, what was done to it, what looks wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING

from giveway.replay.inputs import value_of
from giveway.replay.sampling import RESAMPLING
from giveway.replay.story import MODES, STATUSES

if TYPE_CHECKING:
    from giveway.replay.play import Replay

__all__ = ["done_lines", "mode_lines", "wrong_lines"]

GAPS_TOLD = 5


def done_lines(replay: Replay, robot: str) -> list[tuple[str, str]]:
    """What was read and done: a heading and a sentence each."""
    did, source = replay.did, replay.source
    lines = [
        ("log", f"{source.path.name} ({source.kind}), {did.rows} rows, {did.duration_s:.6g} s"),
        ("controller", robot),
        ("columns", "; ".join(column.words for column in replay.chosen.columns)),
    ]
    lines += [("assumed", text) for text in (*source.said, *replay.chosen.said)]
    jitter = f"up to {1e3 * did.jitter_s:.3g} ms from that" if did.jitter_s > 1e-9 else "to the ns"
    lines.append(("rows", f"every {1e3 * did.usual_s:.6g} ms, {jitter}"))
    lines.append(("steps", f"{did.steps} of {1e3 * replay.choice.step_s:.6g} ms, {did.way}: {RESAMPLING[did.way]}"))
    if replay.chosen.angle != "encoder":
        counts = value_of(replay.parameters, "estimator.encoder_counts")
        stiff = replay.chosen.angle == "wheel_angle" and value_of(replay.parameters, "estimator.drivetrain_stiffness")
        behind = ", and the twist of the drivetrain added" if stiff else ""
        lines.append(("angles", f"rounded to encoder counts, {counts:g} per turn{behind}"))
    if replay.chosen.torque == "current":
        lines.append(("torques", f"currents times {replay.choice.torque_constant:g} N m/A"))
    if did.stamps_from_s != did.begin_s:
        lines.append(("times", f"begin at {did.begin_s:.9g} s, which MCAP cannot say: in replay.mcap at 0 s"))
    if did.wraps:
        lines.append(("wraps", f"{did.wraps} of the angles undone"))
    if replay.makes_plan:
        lines.append(("plan", "the log has none: taken to be the motion of its wheels, as by `giveway tune`"))
    if replay.observes:
        lines.append(("drives", "off: the controller estimates and detects, and never moves the robot"))
    else:
        lines.append(("drives", "on: after a hit the controller believes that the robot gives way as it commands"))
    if value_of(replay.choice.parameters, "motor.inertia") > 0.0:
        unknown = replay.observes or replay.makes_plan
        way = "counts as they are: no commands" if unknown else "between counts, if they follow the commands"
        lines.append(("motors", way))
    return lines


def wrong_lines(replay: Replay) -> list[str]:
    """What a user should look at."""
    did, found = replay.did, replay.findings
    lines = list(found.wrong)
    if did.repeated:
        lines.append(f"{did.repeated} rows have the time of the row before; they were left out")
    if did.gap_count:
        some = "; ".join(
            f"{1e3 * gap.length_s:.3g} ms at {gap.start_s:.6g} s ({gap.place})" for gap in did.gaps[:GAPS_TOLD]
        )
        more = f" and {did.gap_count - GAPS_TOLD} more" if did.gap_count > GAPS_TOLD else ""
        lines.append(f"rows are missing {did.gap_count} times: {some}{more}; there the controller gets no sample")
    for name, count in did.not_finite.items():
        what = "no sample there" if name in replay.inputs.angles else "the controller gets them as they are"
        lines.append(f"{name} has no finite number in {count} rows: {what}")
    for status, total_s in sorted(replay.story.statuses.total_s.items()):
        if status in STATUSES and status != 3:
            lines.append(f"the controller refuses the sensors for {total_s:.3g} s: {STATUSES[status]}")
    if did.duration_s <= 0.0:
        lines.append("the log is over before it began")
    return lines


def mode_lines(replay: Replay) -> list[tuple[str, str]]:
    """Time in each mode."""
    return [(MODES[mode], f"{total_s:.6g} s") for mode, total_s in sorted(replay.story.modes.total_s.items())]
