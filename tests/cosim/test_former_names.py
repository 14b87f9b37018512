"""Modules that moved are still found under the names they had, each with a warning that names the new one."""

from __future__ import annotations

import importlib
import subprocess
import sys

import giveway
import pytest
from giveway.base.former_names import FORMER_NAMES, name_now

FORMER_MODULES = {
    "giveway.plan": "giveway.scenario.plan",
    "giveway.native": "giveway.base.native",  # the folder of the native files has this name, too
    "giveway.calibration.motion_log": "giveway.identification.motion_log",  # of a folder that moved
    "giveway.report.scene_view": "giveway.experiments.figures.scene_view",  # of a folder that stays
    "giveway.fmu_check.units": "giveway.fmu_tools.check.unit_definitions",  # has another name in a folder that moved
}


@pytest.mark.parametrize(("former", "now"), FORMER_MODULES.items())
def test_former_name_is_the_module_itself(former: str, now: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not a copy of it: two would be two kinds of every class. The warning points at the line that imports."""
    for name in [name for name in sys.modules if name_now(name)]:
        monkeypatch.delitem(sys.modules, name)
    with pytest.warns(FutureWarning, match=f"{former} is {now} now") as warned:
        exec(compile(f"import {former}", "user.py", "exec"), {})
    assert sys.modules[former] is sys.modules[now]
    assert warned[-1].filename == "user.py"


@pytest.mark.filterwarnings("ignore::FutureWarning")
@pytest.mark.parametrize("former", FORMER_NAMES)
def test_every_former_name_leads_to_a_module(former: str) -> None:
    assert importlib.import_module(f"giveway.{former}").__name__ == f"giveway.{FORMER_NAMES[former]}"


FORMER_USES = (
    "from giveway.robot import Entry, Robot, read_robot",
    "from giveway.scenario import BUMPERS, Scenario",
    "from giveway.drivetrain import Drivetrain, Servo, read, response",
    "from giveway.bench import Timing, measure",
    "from giveway.batch import run, run_many",
    "from giveway.report import write_report",
    "from giveway import batch, experiments, study",
)


@pytest.mark.parametrize("line", FORMER_USES)
def test_what_has_the_same_name_gives_the_same_things_silently(line: str) -> None:
    subprocess.run([sys.executable, "-W", "error::FutureWarning", "-c", line], check=True)


def test_attribute_of_the_package() -> None:
    """`giveway.plan` was there after `import giveway`."""
    code = "import giveway; assert giveway.plan.Rest is giveway.scenario.plan.Rest"
    subprocess.run([sys.executable, "-W", "ignore::FutureWarning", "-c", code], check=True)


def test_unknown_names_stay_unknown() -> None:
    with pytest.raises(ModuleNotFoundError, match=r"No module named .giveway\.planet."):
        importlib.import_module("giveway.planet")
    with pytest.raises(AttributeError):
        _ = giveway.planet  # type: ignore[attr-defined]
    assert name_now("someone.plan") is None
