"""One design of a study as scenarios: to be simulated again event-exact with traces, or to be exported."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway.scenario.scenario import BUMPERS
from giveway.scenario.stated_contact import StatedContact
from giveway.study.runs import RunTable
from giveway.study.setup import Setup
from giveway.study.store import CHOSEN

if TYPE_CHECKING:
    from giveway.robot.variables import Value
    from giveway.scenario.scenario import Scenario
    from giveway.simulation.result import Result

__all__ = ["hit_of", "scenario_of_run", "settings_of_run", "simulate"]


def settings_of_run(table: RunTable, design: int, sample: int, case: int) -> dict[str, dict[str, Value]]:
    """Per model, every parameter of a run that differs from its start value, in its own type.

    Raises:
        GivewayError: the run is impossible; says why.
    """
    rows = table.rows(np.array([design]), np.array([sample]), case)
    if rows.refused:
        from giveway.base.errors import GivewayError

        raise GivewayError(f"design {design}", table.cases[case].case.name, rows.refused[0])
    found: dict[str, dict[str, Value]] = {"controller": {}, "testbed": {}}
    for column in table.used:
        name, value = table.columns.names[column], float(rows.values[0, column])
        kind = table.columns.variables[column].type
        model, _, variable = name.partition(".")
        found[model][variable] = bool(value) if kind == "boolean" else int(value) if kind == "integer" else value
    return found


def hit_of(table: RunTable, design: int, sample: int, case: int) -> dict[str, float]:
    """What the slider's start was computed from; empty without a collision."""
    rows = table.rows(np.array([design]), np.array([sample]), case)
    return {name: float(values[0]) for name, values in rows.hit.items()}


def scenario_of_run(setup: Setup, table: RunTable, design: int, sample: int = 0, case: int = 0) -> Scenario:
    """The scenario of one run of a study: `giveway.run` of it gives what the study has stored."""
    settings = settings_of_run(table, design, sample, case)
    kind = settings["testbed"].pop("bumper.kind", None)
    base = setup.cases[case].scenario
    bumper = base.bumper if kind is None else list(BUMPERS)[int(kind)]
    seed = settings["testbed"].pop("electronics.seed", base.seed)
    contact = base.contact
    if contact is not None:
        rows = table.rows(np.array([design]), np.array([sample]), case)
        stated, timed = rows.stated, contact.time_s is not None
        contact = StatedContact(
            float(stated.contact_speed_mps[0]),
            (float(stated.point_x_m[0]), float(stated.point_y_m[0])),
            float(stated.time_s[0]) if timed else None,
        )
    return dataclasses.replace(
        base,
        name=f"{setup.name}: design {design}, {setup.cases[case].name}"[:80],
        bumper=bumper,
        robot=None,  # its values are among the settings
        seed=None if seed is None else int(seed),
        body_region=None,  # its mass and stiffness are, too
        judge_as=base.body_region or base.judge_as,
        testbed=settings["testbed"],
        controller=settings["controller"],
        contact=contact,
    )


def simulate(setup: Setup, table: RunTable, folder: Path, design: int) -> dict[str, Result]:
    """Simulate every collision of ``design`` event-exact at nominal values; traces in ``folder/chosen/design-N``.

    Returns the results by the collision's name.
    """
    from giveway.base.files import replace_folder
    from giveway.simulation.runner import run

    results: dict[str, Result] = {}
    for number, case in enumerate(setup.cases):
        results[case.name] = run(scenario_of_run(setup, table, design, 0, number), engine="native")
    for name, result in results.items():
        with replace_folder(folder / CHOSEN / f"design-{design}" / name.replace("/", "-").replace(" ", "-")) as into:
            result.write_into(into)
    return results
