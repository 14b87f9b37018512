"""What a study says of the drivetrain besides what its runs measure: margins, bandwidth, inertia, smallest push.

They follow from the parameters of each run, so tolerances count, by the linear drivetrain (`giveway.drivetrain.many`:
the gear slides, the load is the base in straight motion or a lifted wheel) and by closed forms:

    reflected inertia  M + 1.5 (I_w + I_m)/r_w^2 + 1.5 I_r/r_r^2         in straight motion, motors included
    impact force       max(latch, sqrt(F_0^2 + k v^2 m m_s/(m + m_s)))   m: the former, m_s: slider

The impact force is that of two masses and a spring k without loss, hit in line with the middle of the base: the contact
without a bumper, contact and spring in series with one, whose preload is F_0; v is the speed at which they meet. Runs
stay below, since torque sensors give way, unless a bumper reaches its stop or a rope goes on pulling: neither is in it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import GivewayError
from giveway.base.shapes import Choice, Table, Whole
from giveway.base.toml_sections import Section
from giveway.robot.motor_current import SENSING
from giveway.scenario.scenario import BUMPERS
from giveway.study.metrics import DRIVETRAIN, IMPACT_FORCE, INERTIA, SMALLEST_PUSH, all_metrics, usual_sense
from giveway.study.quantities import columns
from giveway.study.setup import DrivetrainPlan, Goal

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.simulation.run_warnings import Stated
    from giveway.study.setup import Case

    Real = NDArray[np.float64]

__all__ = ["derived", "drivetrain_plan_of", "metrics_shown", "wanted"]

LOADS = ("base", "wheel")
DELAY_MAX = 64
DRIVETRAIN_TABLE = Table(
    "shows the metrics of the drivetrain",
    {
        "load": Choice("of the linear model", LOADS),
        "servo_delay": Whole("ticks of 0.5 ms", 0, DELAY_MAX),
    },
)
LINEAR = ("torque bandwidth", "first resonance", "servo gain margin", "servo phase margin", "servo delay margin")
WHEELS = 3
BY_CURRENT = 1  # of drivetrain.sensing
NO_CURRENT = (
    "robots with torque sensors: by motor current a push shows once a gear breaks away, which is no small signal; "
    "giveway detectability searches with simulated pushes"
)


def drivetrain_plan_of(top: Section) -> DrivetrainPlan:
    """The checked table, or what stands for it."""
    section = top.table("drivetrain")
    if section is None:
        return DrivetrainPlan()
    return DrivetrainPlan(section.choice("load", LOADS, LOADS[0]), section.whole("servo_delay", 0), True)


def metrics_shown(plan: DrivetrainPlan, cases: Sequence[Case]) -> list[Goal]:
    """What the table of the answers shows besides."""
    known = all_metrics()
    missing = [IMPACT_FORCE] if cases[0].hit is None else []
    missing += [SMALLEST_PUSH] if _by_current(cases) else []
    names = [name for name in DRIVETRAIN if plan.stated and name not in missing]
    return [Goal(known[name], usual_sense(known[name])) for name in names]


def wanted(goals: Mapping[str, Sequence[Goal]], cases: Sequence[Case]) -> tuple[str, ...]:
    """Which of the metrics ``goals`` need, which are listed by the table of the study file."""
    cannot = {IMPACT_FORCE: "nothing of a hit without [[collision]]"} if cases[0].hit is None else {}
    if _by_current(cases):
        cannot[SMALLEST_PUSH] = NO_CURRENT
    for table, listed in goals.items():
        for index, goal in enumerate(listed):
            if (why := cannot.get(goal.metric.name)) is not None:
                field = f"{table}[{index}]" + ("" if table == "report.metrics" else ".metric")
                raise GivewayError(field, goal.metric.name, why)
    asked = {goal.metric.name for listed in goals.values() for goal in listed}
    return tuple(name for name in DRIVETRAIN if name in asked)


def _by_current(cases: Sequence[Case]) -> bool:
    """Whether torque is the motors' current in a scenario of the study."""
    usual = columns().start[columns().index[f"testbed.{SENSING}"]]
    return any(case.scenario.parameters("testbed").get(SENSING, usual) == BY_CURRENT for case in cases)


def derived(names: Sequence[str], plan: DrivetrainPlan, values: Real, stated: Stated) -> dict[str, tuple[Real, str]]:
    """Metrics ``names`` of runs with the parameters ``values`` (n, columns), with their units."""
    found: dict[str, Real] = {}
    if not names:
        return {}
    if any(name in LINEAR for name in names):
        found |= _linear(names, plan, values)
    if SMALLEST_PUSH in names:
        found[SMALLEST_PUSH] = _smallest_push(values)
    found[INERTIA] = _reflected_inertia(values)
    if IMPACT_FORCE in names:
        found[IMPACT_FORCE] = _impact_force(values, found[INERTIA], stated)
    return {name: (found[name], DRIVETRAIN[name]) for name in names}


def _of(values: Real, name: str) -> Real:
    return np.asarray(values[:, columns().index[name]])


def _linear(names: Sequence[str], plan: DrivetrainPlan, values: Real) -> dict[str, Real]:
    from giveway.drivetrain.many import ManyDrivetrains

    def testbed(name: str) -> Real:
        return _of(values, f"testbed.{name}")

    friction = sum(testbed(f"drivetrain.friction_scale[{wheel}]") for wheel in range(WHEELS)) / WHEELS
    radius = testbed("wheel.radius")
    load = testbed("wheel.inertia")
    if plan.load == "base":
        rolling = testbed("roller.inertia") * (radius / testbed("roller.radius")) ** 2
        load = load + testbed("base.mass") * radius**2 / 1.5 + rolling
    numbers = np.stack(
        [
            *(testbed(f"drivetrain.{name}") for name in ("motor_inertia", "stiffness", "damping")),
            testbed("drivetrain.gear_viscous") * friction,
            load,
            *(testbed(f"servo.{name}") for name in ("kp", "kd", "derivative_cutoff")),
            testbed(SENSING),
        ],
        axis=1,
    )
    different, which = np.unique(numbers, axis=0, return_inverse=True)  # most runs of a design are of one drivetrain
    models = ManyDrivetrains.of(different[:, :-1], plan.servo_delay)
    found: dict[str, Real] = {}
    if "torque bandwidth" in names:
        found["torque bandwidth"] = models.bandwidth_hz(different[:, -1] == BY_CURRENT)
    if "first resonance" in names:
        found["first resonance"] = models.first_resonance_hz()
    if any(name.startswith("servo") for name in names):
        margins = models.margins()
        found["servo gain margin"] = margins.gain_db
        found["servo phase margin"] = margins.phase_deg
        found["servo delay margin"] = 1e3 * margins.delay_s
    return {name: column[which.ravel()] for name, column in found.items()}


def _smallest_push(values: Real) -> Real:
    from giveway.drivetrain.smallest_push import CONTROLLER, TESTBED, smallest_push_n

    controller = {name: _of(values, f"controller.{name}") for name in CONTROLLER}
    found = smallest_push_n(controller, {name: _of(values, f"testbed.{name}") for name in TESTBED})
    return np.where(_of(values, f"testbed.{SENSING}") == BY_CURRENT, np.nan, found)  # of designs that choose a current


def _reflected_inertia(values: Real) -> Real:
    def testbed(name: str) -> Real:
        return _of(values, f"testbed.{name}")

    turning = (testbed("wheel.inertia") + testbed("drivetrain.motor_inertia")) / testbed("wheel.radius") ** 2
    return testbed("base.mass") + 1.5 * (turning + testbed("roller.inertia") / testbed("roller.radius") ** 2)


def _impact_force(values: Real, inertia: Real, stated: Stated) -> Real:
    def testbed(name: str) -> Real:
        return _of(values, f"testbed.{name}")

    kind = testbed("bumper.kind")
    contact, spring = testbed("contact.stiffness"), testbed("bumper.spring_rate")
    # Of other bumpers none is assumed: their force may be anything below that of the cover alone.
    bumper = np.isin(kind, [list(BUMPERS).index(name) for name in ("spring", "magnetic")])
    stiffness = np.where(bumper, contact * spring / (contact + spring), contact)
    preload = np.where(bumper, testbed("bumper.preload"), 0.0)
    latch = np.where(kind == list(BUMPERS).index("magnetic"), testbed("bumper.latch_force"), 0.0)
    slider = testbed("slider.mass")
    energy = stiffness * stated.contact_speed_mps**2 * inertia * slider / (inertia + slider)
    return np.maximum(latch, np.sqrt(preload**2 + energy))
