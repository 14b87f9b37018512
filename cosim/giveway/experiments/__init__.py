"""The experiments. Each module of this package that defines ``EXPERIMENT`` is one: adding one is adding a file.

`giveway run NAME` runs those with a ``scenario``, `giveway reproduce` those with a ``reproduce``.
"""

from __future__ import annotations

import dataclasses
import functools
import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from giveway.base.errors import GivewayError, UnknownNameError
from giveway.robot.presets import DEFAULT, check_preset

if TYPE_CHECKING:
    from giveway.experiments.reproduction.findings import Effort, Findings
    from giveway.scenario.scenario import Scenario

__all__ = ["PAPER_BUMPERS", "Experiment", "all_experiments", "get"]

PAPER_BUMPERS = ("none", "spring", "magnetic")


class _MakesScenario(Protocol):
    def __call__(self, bumper: str, *, robot: Path | None = None, preset: str = DEFAULT) -> Scenario: ...


def _refuse_single_run(name: str, _bumper: str, *, robot: Path | None = None, preset: str = DEFAULT) -> Scenario:
    del robot, preset
    single = ", ".join(one.name for one in all_experiments().values() if one.is_single_run)
    allowed = f"{single}; {name} is more than one run, and `giveway reproduce --only {name}` does them all"
    raise GivewayError("experiment", name, allowed)


_NO_SINGLE_RUN: _MakesScenario = functools.partial(_refuse_single_run, "")  # set after the experiment has its name


@dataclass(frozen=True)
class Experiment:
    """One experiment.

    Attributes:
        name: what the command line calls it.
        summary: one sentence.
        section: its section in the paper ("5.2"), or "" if the paper does not have it; orders the report.
        bumpers: the bumpers its scenario is run with.
        scenario: makes the scenario for a bumper and, if given, the robot file ``robot`` and the controller's
            ``preset``; refuses an unknown bumper, or a robot with which the experiment is not possible. None for an
            experiment of several runs.
        reproduce: computes its part of the reproduction, or None if it has none.
    """

    name: str
    summary: str
    section: str = ""
    bumpers: tuple[str, ...] = ()
    scenario: _MakesScenario = _NO_SINGLE_RUN
    reproduce: Callable[[Effort], Findings] | None = None

    def __post_init__(self) -> None:
        if self.scenario is _NO_SINGLE_RUN:
            object.__setattr__(self, "scenario", functools.partial(_refuse_single_run, self.name))

    @property
    def is_single_run(self) -> bool:
        """It has a scenario, which `giveway run` runs."""
        return getattr(self.scenario, "func", None) is not _refuse_single_run

    def with_preset(self, preset: str) -> Experiment:
        """The same with ``preset`` where its scenario is not told another one."""
        check_preset(preset)
        if preset == DEFAULT or not self.is_single_run:
            return self
        return dataclasses.replace(self, scenario=functools.partial(self.scenario, preset=preset))


@functools.cache
def all_experiments() -> dict[str, Experiment]:
    """Every experiment by name."""
    found: dict[str, Experiment] = {}
    for module_info in pkgutil.iter_modules(__path__):
        module = importlib.import_module(f"{__name__}.{module_info.name}")
        experiment = getattr(module, "EXPERIMENT", None)
        if experiment is not None:
            found[experiment.name] = experiment
    return found


def get(name: str, preset: str = DEFAULT) -> Experiment:
    """The experiment called ``name``; UnknownNameError offers the nearest one."""
    experiments = all_experiments()
    if name not in experiments:
        raise UnknownNameError("experiment", name, experiments)
    return experiments[name].with_preset(preset)
