"""robot_config.h and robot_config.c: every field of the C library's configuration, from the FMU's variable table."""

from __future__ import annotations

from dataclasses import dataclass

from giveway.firmware.c_text import comment, literal, quoted, real
from giveway.firmware.digest import firmware_digest
from giveway.firmware.settings import Setting, Settings
from giveway.robot.motor_current import CONSTANT, RATIO

__all__ = ["Scaling", "config_header", "config_source"]

CURRENT_RESOLUTION, CURRENT_RANGE = "motor.current_resolution", "motor.current_range"
TORQUE_RESOLUTION, TORQUE_LIMIT = "drivetrain.torque_sensor_resolution", "drivetrain.torque_sensor_limit"
CONVERTER_STEPS = 32767.0  # of a signed 16-bit converter, where the robot file states no resolution


@dataclass(frozen=True)
class Scaling:
    """What a count of the torque signal is.

    Attributes:
        per_count: N m at the wheel; with motor currents A.
        torque_per_ampere: N m at the wheel per A; None: the robot has torque sensors.
        assumed: the robot file states no resolution: range and 16 bits decide.
    """

    per_count: float
    torque_per_ampere: float | None
    assumed: bool

    @classmethod
    def of(cls, settings: Settings) -> Scaling:
        """That of the robot file."""
        robot = settings.robot
        current = robot.motor_current
        resolution = float(robot.value(CURRENT_RESOLUTION if current else TORQUE_RESOLUTION))
        assumed = resolution == 0.0
        if assumed:
            resolution = float(robot.value(CURRENT_RANGE if current else TORQUE_LIMIT)) / CONVERTER_STEPS
        ratio = float(robot.value(RATIO)) * float(robot.value(CONSTANT)) if current else None
        return cls(resolution, ratio, assumed)

    @property
    def torque_per_count(self) -> float:
        """N m at the wheel."""
        return self.per_count * (1.0 if self.torque_per_ampere is None else self.torque_per_ampere)

    def lines(self, settings: Settings) -> str:
        """The header's definitions."""
        rule = "assumed: 16 bits of the range, as the robot file states no resolution" if self.assumed else ""
        name = settings.robot.path.name
        if self.torque_per_ampere is None:
            text = f"Torque sensors: N m per count; {rule or f'{name}, {TORQUE_RESOLUTION}'}."
            return (
                comment(text)
                + "#define ROBOT_SENSES_CURRENT 0\n"
                + f"#define ROBOT_TORQUE_NM_PER_COUNT {real(self.per_count)}\n"
            )
        text = (
            f"The motors' currents stand for torque: A per count; {rule or f'{name}, {CURRENT_RESOLUTION}'}; and N m "
            f"at the wheel per A, {RATIO} times {CONSTANT}."
        )
        return (
            comment(text)
            + "#define ROBOT_SENSES_CURRENT 1\n"
            + f"#define ROBOT_AMPERE_PER_COUNT {real(self.per_count)}\n"
            + f"#define ROBOT_TORQUE_NM_PER_AMPERE {real(self.torque_per_ampere)}\n"
        )


def config_header(settings: Settings) -> str:
    """The text of robot_config.h."""
    parameters = settings.parameters()
    digest = firmware_digest(settings)
    period_us = round(1e6 * float(parameters["controller.period"]))
    return (
        comment(
            f"Of {settings.robot.path.name}, preset {settings.preset}. Written by `giveway firmware`, which can write "
            "it again; what is changed here is then lost."
        )
        + "#ifndef ROBOT_CONFIG_H\n#define ROBOT_CONFIG_H\n\n"
        + '#include "giveway/gw_controller.h"\n\n'
        + f"#define ROBOT_NAME {quoted(settings.robot.name or settings.robot.path.stem)}\n\n"
        + comment("The controller is stepped this often, microseconds.")
        + f"#define ROBOT_PERIOD_US {period_us}U\n\n"
        + comment("Counts of an encoder per turn of the wheel.")
        + f"#define ROBOT_ENCODER_COUNTS {parameters['estimator.encoder_counts']}U\n\n"
        + Scaling.of(settings).lines(settings)
        + "\n"
        + comment(
            "Of the C library's sources and every bit of the configuration: whoever asks can tell what runs here."
        )
        + f"#define ROBOT_DIGEST_LOW 0x{digest[8:]}U\n#define ROBOT_DIGEST_HIGH 0x{digest[:8]}U\n\n"
        + comment("Every field, for gw_controller_init.")
        + "extern const gw_controller_config_t robot_config;\n\n#endif\n"
    )


def config_source(settings: Settings) -> str:
    """The text of robot_config.c."""
    parts = ['#include "robot_config.h"\n\nconst gw_controller_config_t robot_config = {\n']
    group = ""
    for setting in sorted(settings.all(), key=_group):
        if _group(setting) != group:
            parts.append("\n" if group else "")
            group = _group(setting)
        parts.append(_field(setting))
    return "".join([*parts, "};\n"])


def _group(setting: Setting) -> str:
    return setting.variable.name.partition(".")[0]


def _field(setting: Setting) -> str:
    variable = setting.variable
    unit = f" [{variable.unit}]" if variable.unit not in ("", "1") else ""
    words = f"{variable.name}{unit}: {variable.description}. {setting.origin}"
    return comment(words, "    ") + f"    .{variable.c_core} = {literal(variable, setting.value)},\n"
