"""Scenarios and variable tables check what they are given and name field, value and allowed range."""

from __future__ import annotations

import dataclasses
import math
import subprocess
import sys
import tomllib
import typing

import giveway
import pytest
from giveway.base import native
from giveway.base.errors import GivewayError, UnknownNameError
from giveway.robot.variables import parse_assignments, table
from giveway.scenario import BUMPERS
from giveway.scenario.plan import Rest
from giveway.study import Study


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"duration_s": 0.0}, "duration_s"),
        ({"duration_s": math.nan}, "duration_s"),
        ({"duration_s": 3601.0}, "duration_s"),
        ({"step_s": 0.0}, "step_s"),
        ({"step_s": math.inf}, "step_s"),
        ({"bumper": "rubber"}, "bumper"),
        ({"fmi_version": 1}, "fmi_version"),
        ({"seed": -1}, "seed"),
        ({"seed": 1.5}, "seed"),
        ({"duration_s": True}, "duration_s"),
    ],
)
def test_a_scenario_refuses(changes: dict[str, object], field: str) -> None:
    with pytest.raises(GivewayError) as caught:
        giveway.Scenario(**{"name": "x", "duration_s": 1.0, **changes})  # type: ignore[arg-type]
    assert caught.value.field == field
    assert "\n" not in str(caught.value)


def test_a_scenario_cannot_be_changed_through_the_callers_dict() -> None:
    overrides = {"base.mass": 40.0}
    scenario = giveway.Scenario("x", 1.0, testbed=overrides)
    overrides["base.mass"] = -1.0
    assert scenario.testbed["base.mass"] == 40.0
    with pytest.raises(TypeError):
        scenario.testbed["base.mass"] = 1.0  # type: ignore[index]
    with pytest.raises(dataclasses.FrozenInstanceError):
        scenario.duration_s = 2.0  # type: ignore[misc]


def test_bumper_and_seed_become_parameters_and_overrides_win() -> None:
    scenario = giveway.Scenario("x", 1.0, bumper="spring", seed=7, testbed={"base.mass": 40.0})
    assert scenario.parameters("testbed") == {
        "bumper.kind": 1, "slider.present": False, "electronics.seed": 7, "base.mass": 40.0,
    }  # fmt: skip
    assert scenario.parameters("controller") == {}


def test_nothing_collides_unless_asked() -> None:
    bare = giveway.Scenario("x", 1.0)
    assert bare.parameters("testbed")["slider.present"] is False
    result = giveway.run(bare)
    assert result.traces["testbed.truth.contact_force"].max() == 0.0
    assert result.metric("false detections").value == 0
    asked = giveway.Scenario("x", 1.0, testbed={"slider.present": True, "slider.mass": 5.0})
    assert asked.parameters("testbed")["slider.mass"] == 5.0
    for name in ("slider.mass", "rope.attached"):
        with pytest.raises(GivewayError, match=rf"testbed\.{name}.*slider\.present"):
            giveway.Scenario("x", 1.0, testbed={name: 1})


def test_overrides_from_python_are_checked_too() -> None:
    with pytest.raises(GivewayError, match=r"testbed\.base\.mass"):
        giveway.Scenario("x", 1.0, testbed={"base.mass": math.nan}).parameters("testbed")


def test_every_bound_is_inclusive_and_its_neighbour_is_refused() -> None:
    checked = 0
    for model in ("testbed", "controller"):
        for variable in table(model).select("parameter", "real"):
            for bound, outward in ((variable.minimum, -math.inf), (variable.maximum, math.inf)):
                if math.isinf(bound):
                    continue
                assert table(model).check(variable.name, bound) == bound
                with pytest.raises(GivewayError):
                    table(model).check(variable.name, math.nextafter(bound, outward))
                checked += 1
    assert checked > 100  # every table states ranges; an empty loop would prove nothing


def test_starts_lie_in_their_ranges() -> None:
    for model in ("testbed", "controller"):
        for variable in table(model).select("parameter"):
            assert table(model).check(variable.name, variable.start) == variable.start


@pytest.mark.parametrize(("text", "value"), [("true", True), ("1", True), ("False", False), ("off", False)])
def test_booleans_as_text(text: str, value: bool) -> None:
    assert parse_assignments([f"testbed.slider.present={text}"])["testbed"] == {"slider.present": value}


def test_a_boolean_is_not_a_number() -> None:
    with pytest.raises(GivewayError):
        table("testbed").check("base.mass", True)
    with pytest.raises(GivewayError):
        table("testbed").check("slider.present", 2)


def test_the_last_assignment_wins() -> None:
    assignments = parse_assignments(["testbed.base.mass=30", "testbed.base.mass=40"])
    assert assignments["testbed"]["base.mass"] == 40.0


def test_unknown_names_offer_the_nearest() -> None:
    with pytest.raises(UnknownNameError) as caught:
        table("testbed").check("slider.mas", 1.0)
    assert "slider.mass" in caught.value.nearest


def test_rest_is_a_pose_without_motion() -> None:
    import numpy as np

    plan = Rest(1.0, 2.0, 0.5)(np.arange(4.0))
    assert plan.shape == (4, 9)
    assert (plan[:, :3] == [1.0, 2.0, 0.5]).all()
    assert not plan[:, 3:].any()
    with pytest.raises(GivewayError):
        Rest(math.nan)


def test_importing_the_package_is_light() -> None:
    # Numerical and drawing libraries cost most of a second: the command line must not wait for them.
    heavy = {"numpy", "xarray", "matplotlib", "fmpy", "pyarrow", "pandas", "jinja2", "rich"}
    code = "import sys, giveway; print(' '.join(sys.modules))"
    modules = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "giveway" in modules
    assert not heavy & set(modules)
    # Every room's command is imported at every start; Typer itself may draw with rich.
    code = "import sys, giveway.cli; print(' '.join(sys.modules))"
    modules = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "giveway.bench.command" in modules
    assert not (heavy - {"rich"}) & set(modules)
    # Experiments are looked up, and a wrong name refused, without what labels, draws or runs them.
    code = "import sys, giveway.cli; giveway.cli._main(['list', '--quiet']); print(' '.join(sys.modules))"
    modules = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "giveway.experiments.motionless" in modules
    assert not (heavy - {"rich", "numpy"}) & set(modules)


def test_the_names_of_the_bumpers_are_those_of_the_table() -> None:
    with native.variables("testbed").open("rb") as file:
        entries = {entry["name"]: entry for entry in tomllib.load(file)["variable"]}
    assert list(BUMPERS) == entries["bumper.kind"]["choices"]
    assert list(BUMPERS.values()) == list(range(len(BUMPERS)))
    # What an editor offers is written down, since a type checker reads no tables.
    hints = typing.get_type_hints(Study.__init__, vars(giveway.study))
    assert set(typing.get_args(typing.get_args(hints["bumper"])[0])) == set(BUMPERS)


def test_a_long_run_is_allowed_where_its_traces_fit() -> None:
    hour = giveway.Scenario("x", 3600.0)
    hour.check_traces(columns=0)
    hour.check_traces(columns=27)  # 27 x 3,600,001 values are below 1e8, 28 are not
    with pytest.raises(GivewayError, match="28 traces"):
        hour.check_traces(columns=28)
    with pytest.raises(GivewayError, match="duration_s"):
        hour.check_traces(columns=7, runs=4)
    with pytest.raises(GivewayError, match="duration_s"):
        giveway.run(hour)
