"""Trikey without torque sensors: a robot file whose torque is that of the motors' current."""

from __future__ import annotations

from pathlib import Path

from giveway.base import native

MOTOR = {
    "gear_ratio": (50.0, "1"),
    "torque_constant": (0.0433, "N.m/A"),
    "current_noise": (0.02, "A"),
    "current_resolution": (0.005, "A"),
    "current_range": (12.0, "A"),
}
BEGIN, END = "[drivetrain.sensing]", "[drivetrain.encoder_counts]"


def trikey_by_current(folder: Path, *changes: tuple[str, str]) -> Path:
    """``changes``: what is replaced in the new file."""
    text = native.robot().read_text(encoding="utf-8")
    motor = "".join(f'[motor.{key}]\nvalue = {value}\nunit = "{unit}"\n\n' for key, (value, unit) in MOTOR.items())
    text = text[: text.index(BEGIN)] + f'{BEGIN}\nvalue = "motor current"\n\n{motor}' + text[text.index(END) :]
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "by_current.toml"
    path.write_text(text, encoding="utf-8")
    return path
