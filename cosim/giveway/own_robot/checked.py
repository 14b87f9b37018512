"""`giveway robot check`: what a robot file lacks, what is implausible in it, and what is assumed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.base import native
from giveway.base.errors import FileError, GivewayError
from giveway.base.toml_lines import line_of
from giveway.own_robot.plausible import Doubt, Numbers, doubts
from giveway.robot.robot_file import CONFIDENCE, PROVENANCE, Entry, Robot, read_robot
from giveway.robot.variables import table

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Checked", "check"]

UNSTATED = "not stated"
PROBE_S = 0.01


@dataclass(frozen=True)
class Checked:
    """What was found.

    Attributes:
        robot: the file.
        missing: entries that every robot file needs and this one lacks, with their units.
        refused: why the robot cannot be used though nothing is missing; "" if it can.
        doubts: what is implausible, each with the line of its first entry (1 if the file does not have it).
        numbers: None if it cannot be used.
    """

    robot: Robot
    missing: tuple[tuple[str, str], ...]
    refused: str
    doubts: tuple[tuple[int, Doubt], ...]
    numbers: Numbers | None

    @property
    def usable(self) -> bool:
        """Whether a simulation can run with it."""
        return not self.missing and not self.refused

    def origins(self) -> Iterator[tuple[str, list[tuple[str, Entry]]]]:
        """Entries by provenance, the least certain first."""
        for provenance in ("", *reversed(PROVENANCE)):
            found = [(name, entry) for name, entry in self.robot.entries() if entry.provenance == provenance]
            if found:
                yield provenance or UNSTATED, found

    def uncertain(self) -> list[tuple[str, Entry]]:
        """Entries that are assumed, or of which the file says neither provenance nor confidence, or a low one."""
        sure = CONFIDENCE[:2]
        return [
            (name, entry)
            for name, entry in self.robot.entries()
            if entry.provenance in ("", "assumed") or entry.confidence not in sure
        ]


def check(path: Path) -> Checked:
    """The robot file ``path``, looked through.

    Raises:
        FileError, InputFileError: it cannot be read, or something in it is unknown, of the wrong type or kind.
    """
    robot = read_robot(path)
    missing = tuple(_missing(robot))
    if missing:
        return Checked(robot, missing, "", (), None)
    try:
        numbers = Numbers(robot)
        _probe(path)
    except GivewayError as error:
        return Checked(robot, (), str(error), (), None)
    text = path.read_text(encoding="utf-8-sig")
    found = tuple((_line(robot, text, doubt), doubt) for doubt in doubts(numbers))
    return Checked(robot, (), "", found, numbers)


def _missing(robot: Robot) -> Iterator[tuple[str, str]]:
    """Needed entries that are not there, in the order of the tables."""
    seen: set[str] = set()
    for model in (*native.MODELS[::-1], *native.COMPONENTS):
        for variable in table(model).select("parameter"):
            name = variable.robot_path
            if name is None or name in seen or name in robot or robot.does_without(name):
                continue
            seen.add(name)
            yield name, variable.unit or "1"


def _probe(path: Path) -> None:
    """Refuse what the FMUs refuse together, such as a roller that is too large for its wheel: ten steps of a run."""
    from giveway import batch
    from giveway.scenario.scenario import Scenario

    for bumper in ("none", "magnetic"):
        scenario = Scenario("check", PROBE_S, bumper=bumper, robot=path)
        ran = batch.run_many([scenario], threads=1)
        if str(ran["status"].values[0]) != "ok":
            raise FileError(path, str(ran["message"].values[0]))


def _line(robot: Robot, text: str, doubt: Doubt) -> int:
    """Where the file states the first entry of ``doubt`` that it has."""
    stated = [entry for entry in doubt.entries if entry in robot]
    return line_of(text, f"{stated[0]}.value") if stated else 1
