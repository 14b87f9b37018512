"""`giveway calibrate`: from log files to a new robot file and a residual plot."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from giveway.base.errors import GivewayError
from giveway.base.files import check_file, replace_files
from giveway.identification.motion_log import pieces, read_log
from giveway.identification.roller_friction import Calibration, Estimate
from giveway.identification.roller_friction import calibrate as calibrate_rollers
from giveway.robot.changes import NewValue, changed_robot
from giveway.robot.robot_file import read_robot

__all__ = ["calibrate_robot", "friction_values", "table_rows"]

COULOMB, SLOPE = "roller.coulomb_torque", "roller.tanh_slope"
HASH_DIGITS = 12  # digits of sha256: enough to distinguish logs
DIGITS = 5  # more digits than any log can determine


def calibrate_robot(logs: Sequence[Path], robot: Path, out: Path) -> tuple[Calibration, tuple[Path, Path]]:
    """Fit the roller friction of ``robot`` to ``logs``; returns it and the two files that were written.

    Everything is read, checked and fitted before anything is written: ``out``, the robot file with B_r and alpha
    replaced and everything else as it was, and the residual plot under the same name with the ending .png.
    """
    if out.suffix != ".toml":
        raise GivewayError("--out", out, "a file that ends with .toml")
    if out.resolve() == robot.resolve():
        raise GivewayError("--out", out, "another file than --robot: the old values are worth keeping")
    picture = out.with_suffix(".png")
    for path in (out, picture):
        check_file(path)
    parameters = read_robot(robot)
    read = [read_log(path, parameters) for path in logs]
    calibration = calibrate_rollers([piece for log in read for piece in pieces(log)], parameters)
    names = ", ".join(f"{log.name} (sha256 {log.sha256[:HASH_DIGITS]})" for log in read)
    text = changed_robot(robot, friction_values(calibration, f"giveway calibrate: free motion in {names}"))
    from giveway.identification.figures import write_residuals

    with replace_files(picture, out) as (new_picture, new_robot):
        write_residuals(new_picture, calibration)
        new_robot.write_text(text, encoding="utf-8")
    return calibration, (out, picture)


def table_rows(calibration: Calibration) -> list[tuple[str, str, str, str]]:
    """The found numbers as text: name, value, interval, unit."""
    rows = [
        _row("B_r", calibration.coulomb_torque_nm, "N m"),
        _row("alpha", calibration.tanh_slope_s_rad, "s/rad"),
    ]
    for log in calibration.logs:
        offsets = " ".join(f"{offset:.3f}" for offset in log.offset_nm)
        rows.append((f"tare, {log.name}", offsets, "", "N m"))
    rows.append(("variance explained", f"{100.0 * calibration.explained:.2f}", "", "%"))
    return rows


def _row(name: str, estimate: Estimate, unit: str) -> tuple[str, str, str, str]:
    return name, f"{estimate.value:.4g}", f"{estimate.low:.4g} to {estimate.high:.4g}", unit


def friction_values(calibration: Calibration, source: str) -> dict[str, NewValue]:
    """What a robot file says of the rollers' friction, found as ``source`` says."""
    symbols = {
        COULOMB: ("B_r", calibration.coulomb_torque_nm, "N m"),
        SLOPE: ("alpha", calibration.tanh_slope_s_rad, "s/rad"),
    }
    return {
        key: NewValue(
            value=float(f"{estimate.value:.{DIGITS}g}"),
            source=source,
            confidence="high",
            provenance="fitted",
            note=f"{symbol} of (28); 95 % interval {estimate.low:.4g} to {estimate.high:.4g} {unit}",
        )
        for key, (symbol, estimate, unit) in symbols.items()
    }
