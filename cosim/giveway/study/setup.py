"""What a study is, checked: made from the document of a study file or by `giveway.Study`."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from giveway.base.units import WrittenUnit
from giveway.study.designs import DesignPlan
from giveway.study.distributions import Tolerance, Varied
from giveway.study.metrics import Metric
from giveway.study.search_plan import SearchPlan
from giveway.study.sure_plan import SurePlan

if TYPE_CHECKING:
    from giveway.robot.population import Quantity as RobotQuantity
    from giveway.scenario.scenario import Scenario

__all__ = ["Case", "Constraint", "DrivetrainPlan", "Goal", "Hit", "Setup"]


@dataclass(frozen=True)
class Hit:
    """Where, when and how fast the slider comes, as its table of the study file says.

    Attributes:
        speed_mps: along the rail at the contact.
        time_s: when; None with the rope.
        edge, offset_m: side of the outline and distance from its middle; or
        point_m: on the outline, base frame.
        direction_deg: of travel, world frame; None: straight into the side.
    """

    speed_mps: float
    time_s: float | None
    edge: int | None
    offset_m: float
    point_m: tuple[float, float] | None
    direction_deg: float | None


@dataclass(frozen=True)
class Case:
    """One of the collisions that every design goes through.

    Attributes:
        name: for tables.
        scenario: with the scenario's own values.
        hit: None: nothing comes, only the scenario's pushes.
        document: its scenario as a scenario file has it.
    """

    name: str
    scenario: Scenario
    hit: Hit | None
    document: dict[str, Any]


@dataclass(frozen=True)
class Goal:
    """A metric over the runs of a design: what is compared between designs.

    Attributes:
        metric: of each run.
        sense: 1: less is better; -1: more is better.
        collisions: "worst" or "mean" over the collisions.
        tolerances: "worst", "mean" or "nominal" over the tolerance samples.
        weight: in the ranking.
    """

    metric: Metric
    sense: int
    collisions: str = "worst"
    tolerances: str = "worst"
    weight: float = 1.0


@dataclass(frozen=True)
class Constraint:
    """A goal with a limit: ``minimum`` and ``maximum`` in the metric's unit; ``written`` is the user's."""

    goal: Goal
    minimum: float
    maximum: float
    written: WrittenUnit | None = None

    @property
    def unit(self) -> WrittenUnit:
        """The unit in which its metric is shown."""
        return self.written or WrittenUnit(self.goal.metric.unit)


@dataclass(frozen=True)
class DrivetrainPlan:
    """The table ``[drivetrain]``.

    Attributes:
        load: what the wheels of the linear drivetrain drive: "base" in straight motion, or a lifted "wheel".
        servo_delay: ticks of 0.5 ms from reading the encoder to the torque; the runs have none.
        stated: the table is there, so that all metrics are shown.
    """

    load: str = "base"
    servo_delay: int = 0
    stated: bool = False


@dataclass(frozen=True)
class Setup:
    """A study, ready to run.

    Attributes:
        name: of the study.
        document: what it was made from: the tables of the study file.
        folder: where its relative paths start.
        method, plant_step_s: one of `giveway.batch.METHODS`, and the step of the plant; None: as each run needs.
        seed: of the samplers.
        cases: collisions.
        varied: quantities that differ between designs.
        plan: which designs.
        tolerances, tolerance_kind, tolerance_count: and how they are sampled.
        noise_seeds: every tolerance sample has sensor noise of its own.
        crowd: in which every tolerance sample has a robot of its own, as drawn by `robot.population`; none: the file's.
        sure: how sure the recommendation is made.
        objectives, constraints: what is asked for.
        shown: further metrics of the table.
        chosen: how many of the best designs are simulated once more, with traces.
        part_runs: runs per file; 0: chosen from how many there are.
        search: how the best designs are searched, if they are.
        drivetrain, derived: of the linear drivetrain, and which metrics of it are needed.
        text, path: of the study file, for messages; None: from Python.
    """

    name: str
    document: dict[str, Any]
    folder: Path
    method: str
    plant_step_s: float | None
    seed: int
    cases: tuple[Case, ...]
    varied: tuple[Varied, ...]
    plan: DesignPlan
    tolerances: tuple[Tolerance, ...]
    tolerance_kind: str
    tolerance_count: int
    noise_seeds: bool
    objectives: tuple[Goal, ...]
    constraints: tuple[Constraint, ...]
    shown: tuple[Goal, ...]
    chosen: int
    part_runs: int
    search: SearchPlan
    crowd: tuple[RobotQuantity, ...] = ()
    sure: SurePlan = field(default_factory=SurePlan)
    drivetrain: DrivetrainPlan = DrivetrainPlan()
    derived: tuple[str, ...] = ()
    text: str | None = field(default=None, repr=False)
    path: Path | None = None
