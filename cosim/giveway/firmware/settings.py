"""The controller's parameters of a firmware: every value, and where it comes from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from giveway.base.errors import one_line
from giveway.robot.presets import DEFAULT, check_preset, preset_values
from giveway.robot.robot_file import Robot, read_robot
from giveway.robot.variables import Value, Variable, table

__all__ = ["Setting", "Settings"]


@dataclass(frozen=True)
class Setting:
    """A parameter of the controller.

    Attributes:
        variable: its entry in the variable table.
        value: checked, in the table's unit.
        origin: where the value comes from, a sentence.
    """

    variable: Variable
    value: Value
    origin: str


@dataclass(frozen=True)
class Settings:
    """What a firmware is made of.

    Args:
        robot: the robot file, read.
        preset: the reflex.
        assignments: parameters of the controller that replace both.
    """

    robot: Robot
    preset: str
    assignments: Mapping[str, Value]

    @classmethod
    def of(cls, robot: Path, preset: str = DEFAULT, assignments: Mapping[str, Value] | None = None) -> Settings:
        """Read and check the robot file; every error names what is wrong."""
        check_preset(preset, "--preset")
        settings = cls(read_robot(robot), preset, dict(assignments or {}))
        settings.parameters()
        return settings

    def parameters(self) -> dict[str, Value]:
        """Every parameter of the controller by name, checked."""
        return {setting.variable.name: setting.value for setting in self.all()}

    def all(self) -> list[Setting]:
        """Every parameter of the controller, in the order of the table."""
        variables = table("controller")
        from_robot = variables.robot_values(self.robot)
        from_preset = preset_values(self.preset)
        assigned = variables.check_all(self.assignments)
        found = []
        for variable in variables.select("parameter"):
            name = variable.name
            if name in assigned:
                found.append(Setting(variable, assigned[name], "Set on the command line."))
            elif name in from_preset:
                found.append(Setting(variable, from_preset[name], f'Of the preset "{self.preset}".'))
            elif name in from_robot:
                found.append(Setting(variable, from_robot[name], self._origin(variable)))
            else:
                assert variable.start is not None
                found.append(Setting(variable, variable.start, "Start value of the controller."))
        return found

    def _origin(self, variable: Variable) -> str:
        """Name of the robot file's entry, what the file says of it."""
        name = table("controller").robot_name(variable, self.robot)
        if name not in self.robot:
            return f"From {self.robot.path.name}, the number of corners."
        entry = self.robot[name]
        confidence = f"{entry.confidence} confidence" if entry.confidence else ""
        remarks = ", ".join(filter(None, (entry.provenance, confidence, entry.source, entry.note)))
        return one_line(f"From {self.robot.path.name}, {name}" + (f": {remarks}." if remarks else "."))
