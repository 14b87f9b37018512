"""A scenario: the complete input of one run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from giveway.base.checks import finite, whole
from giveway.base.errors import GivewayError, UnknownNameError
from giveway.robot.presets import DEFAULT, check_preset, preset_values
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import Choices, Value, table
from giveway.scenario.body_regions import BodyRegion, body_region, body_regions, check_contact_area
from giveway.scenario.plan import Plan, Push, Rest
from giveway.scenario.stated_contact import StatedContact

__all__ = ["BUMPERS", "FMI_VERSIONS", "ROBOT_BUMPERS", "Scenario"]

BUMPERS = Choices("testbed", "bumper.kind")
# Those with numbers in the robot file. Random hits are drawn from them: a further law leaves every draw as it was.
ROBOT_BUMPERS = ("none", "spring", "magnetic")
FMI_VERSIONS = (3, 2)
MAXIMUM_DURATION_S = 3600.0
MINIMUM_STEP_S, MAXIMUM_STEP_S = 1e-4, 0.1
MAXIMUM_STEPS = 4_000_000  # of the batch library
MAXIMUM_TRACE_VALUES = 100_000_000  # values in memory: 0.8 GB


@dataclass(frozen=True)
class Scenario:
    """One co-simulation of controller and testbed.

    Nothing collides with the robot unless ``testbed`` has ``"slider.present": True`` and the other parameters of the
    slider; `giveway.scenario.approach.meet` computes all of them for a hit at a given point and speed.

    Attributes:
        name: a short name, for manifests and figures.
        duration_s: simulated time in s, above 0 and at most 3600.
        step_s: communication step in s.
        bumper: "none", "spring", "magnetic", "foam", "gas", "damper", "series", "lever" or "table".
        testbed, controller: parameter overrides, names as in the variable tables, values in their units.
        plan: the planned motion (world frame).
        push: an external push on the robot over time, or None.
        seed: seed of the testbed's sensor noise, or None for the table's start value.
        fmi_version: 3 or 2.
        robot: a robot file that replaces the one the FMUs were built with, or None.
        body_region: the part that is hit, a name of `body_regions`, or None. The slider gets its effective mass, and
            ``contact.stiffness`` becomes that of the robot's cover (``contact.stiffness`` in the robot file) and the
            body in series; the contact force is judged by its limits.
        judge_as: the region whose limits judge the force, while mass and stiffness are those of ``testbed`` and robot
            file; None: that of ``body_region``, if any.
        contact_area_m2: area of the contact, m2, 1e-6 to 1, for the mean pressure; None: unknown.
        contact: the intended contact, or None; a different contact gives a warning.
        preset: the controller's reflex, "default" or "paper"; ``controller`` changes it further.
    """

    name: str
    duration_s: float
    step_s: float = 1e-3
    bumper: str = "magnetic"
    testbed: Mapping[str, Value] = field(default_factory=dict)
    controller: Mapping[str, Value] = field(default_factory=dict)
    plan: Plan = field(default_factory=Rest)
    push: Push | None = None
    seed: int | None = None
    fmi_version: int = 3
    robot: Path | None = None
    body_region: str | None = None
    judge_as: str | None = None
    contact_area_m2: float | None = None
    contact: StatedContact | None = None
    preset: str = DEFAULT

    def __post_init__(self) -> None:
        finite("duration_s", self.duration_s, 0.0, MAXIMUM_DURATION_S, "s")
        finite("step_s", self.step_s, MINIMUM_STEP_S, MAXIMUM_STEP_S, "s")
        if not 1 <= self.steps <= MAXIMUM_STEPS:
            allowed = f"1 to {MAXIMUM_STEPS} communication steps of step_s = {self.step_s:g} s"
            raise GivewayError("duration_s", self.duration_s, allowed)
        if self.bumper not in BUMPERS:
            raise UnknownNameError("bumper", self.bumper, BUMPERS)
        check_preset(self.preset)
        if self.fmi_version not in FMI_VERSIONS:
            raise GivewayError("fmi_version", self.fmi_version, "3 or 2")
        if self.seed is not None:
            whole("seed", self.seed, 0, 2**31 - 1)
        self._check_region()
        if "slider.present" not in self.testbed:
            for name, value in self.testbed.items():
                if name.startswith(("slider.", "rope.")):
                    allowed = "only what collides has it: set slider.present = True, too"
                    raise GivewayError(f"testbed.{name}", value, allowed)
        # Copies, so that a frozen scenario cannot change later.
        object.__setattr__(self, "testbed", MappingProxyType(dict(self.testbed)))
        object.__setattr__(self, "controller", MappingProxyType(dict(self.controller)))

    def _check_region(self) -> None:
        """Refuse an unknown region, a region without a collider, and contradictions."""
        if self.judge_as is not None:
            if self.body_region is not None:
                allowed = "nothing beside body_region, which is judged by its own limits"
                raise GivewayError("judge_as", self.judge_as, allowed)
            if self.judge_as not in body_regions():
                raise UnknownNameError("judge_as", self.judge_as, body_regions())
        if self.contact_area_m2 is not None:
            check_contact_area(self.contact_area_m2)
            if self.judged is None:
                raise GivewayError("contact_area_m2", self.contact_area_m2, "only beside body_region or judge_as")
        if self.judged is not None and not self.testbed.get("slider.present", False):
            field = "judge_as" if self.body_region is None else "body_region"
            raise GivewayError(field, self.judged.name, "only of what collides: slider.present = True in testbed")
        if self.body_region is None:
            return
        region = body_region(self.body_region)
        instead = f'write judge_as = "{region.name}" instead of body_region to judge what is stated by its limits'
        mass = self.testbed.get("slider.mass", region.mass_kg)
        if mass != region.mass_kg:
            allowed = f"{region.mass_kg:g} kg, what a {region.name} weighs: leave it out, or {instead}"
            raise GivewayError("testbed.slider.mass", mass, allowed)
        if "contact.stiffness" in self.testbed:
            allowed = (
                f"nothing: the robot file's cover and a {region.name} of {region.stiffness_npm:g} N/m in series decide "
                f"it; leave it out, or {instead}"
            )
            raise GivewayError("testbed.contact.stiffness", self.testbed["contact.stiffness"], allowed)

    @property
    def judged(self) -> BodyRegion | None:
        """The body region whose limits judge the contact force."""
        name = self.body_region or self.judge_as
        return None if name is None else body_region(name)

    @property
    def steps(self) -> int:
        """Number of communication steps."""
        return round(self.duration_s / self.step_s)

    def check_traces(self, columns: int, runs: int = 1) -> None:
        """Refuse a run, or ``runs`` of them at once, whose ``columns`` traces would not fit into memory."""
        rows = MAXIMUM_TRACE_VALUES // max(1, columns * runs)
        if self.steps >= rows:
            longest_s = (rows - 1) * self.step_s
            allowed = f"at most {longest_s:g} s, of which {columns * runs} traces of steps of {self.step_s:g} s fit"
            raise GivewayError("duration_s", self.duration_s, allowed)

    def parameters(self, model: str) -> dict[str, Value]:
        """The checked parameters to set on the FMU of ``model``: robot file, preset, scenario, overrides."""
        variables = table(model)
        values: dict[str, Value] = {}
        if self.robot is not None:
            values |= variables.robot_values(read_robot(Path(self.robot)))
        values |= preset_values(self.preset, model)
        overrides: Mapping[str, Value] = self.controller
        if model == "testbed":
            overrides = self.testbed
            values["bumper.kind"] = BUMPERS[self.bumper]
            values["slider.present"] = False
            if "bumper.kind" in overrides:
                allowed = "one place to choose the bumper: the scenario's bumper, on the command line --bumper"
                raise GivewayError("testbed.bumper.kind", overrides["bumper.kind"], allowed)
            if self.seed is not None:
                values["electronics.seed"] = self.seed
            if self.body_region is not None:
                region = body_region(self.body_region)
                cover = values.get("contact.stiffness", variables["contact.stiffness"].start)
                values["slider.mass"] = region.mass_kg
                values["contact.stiffness"] = region.stiffness_with(float(cover or 0.0))
        return variables.check_all(values | dict(overrides))
