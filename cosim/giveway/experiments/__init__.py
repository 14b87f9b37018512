"""The experiments. Each module of this package that defines ``EXPERIMENT`` is one: adding one is adding a file."""

from __future__ import annotations

import functools
import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from giveway.errors import UnknownNameError

if TYPE_CHECKING:
    from giveway.scenario import Scenario

__all__ = ["Experiment", "all_experiments", "get"]


@dataclass(frozen=True)
class Experiment:
    """One experiment.

    Attributes:
        name: what the command line calls it.
        summary: one sentence.
        bumpers: the bumpers it is run with.
        scenario: makes the scenario for a bumper; refuses an unknown one.
    """

    name: str
    summary: str
    bumpers: tuple[str, ...]
    scenario: Callable[[str], Scenario]


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


def get(name: str) -> Experiment:
    """The experiment called ``name``; UnknownNameError offers the nearest one."""
    experiments = all_experiments()
    if name not in experiments:
        raise UnknownNameError("experiment", name, experiments)
    return experiments[name]
