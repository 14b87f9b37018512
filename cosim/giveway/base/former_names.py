"""Module names of earlier versions: importing one gives the module that now has its content, and a FutureWarning."""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import MappingProxyType, ModuleType

__all__ = ["FORMER_NAMES", "forward_former_names", "name_now"]

PACKAGE = "giveway"
FORMER_NAMES = MappingProxyType({
    "approach": "scenario.approach",
    "bench_batch": "bench.collisions",
    "bench_solvers": "bench.solvers",
    "body_regions": "scenario.body_regions",
    "calibration": "identification",
    "calibration.command": "identification.calibrated_robot",
    "checks": "base.checks",
    "drivetrain_analysis": "drivetrain.analysis",
    "drivetrain_record": "drivetrain.record",
    "errors": "base.errors",
    "failures": "base.failures",
    "files": "base.files",
    "fmi2_callbacks": "simulation.fmi2_callbacks",
    "fmu": "simulation.fmu",
    "fmu_archive": "fmu_tools.archive",
    "fmu_binaries": "fmu_tools.binaries",
    "fmu_check": "fmu_tools.check",
    "fmu_check.units": "fmu_tools.check.unit_definitions",
    "fmu_child": "fmu_tools.child",
    "fmu_commands": "fmu_tools.command",
    "fmu_description": "fmu_tools.description",
    "fmu_info": "fmu_tools.info",
    "fmu_inputs": "fmu_tools.inputs",
    "fmu_limits": "fmu_tools.limits",
    "fmu_page": "fmu_tools.page",
    "fmu_process": "fmu_tools.process",
    "fmu_run": "fmu_tools.run",
    "fmu_xml": "fmu_tools.xml_files",
    "footprint": "robot.footprint",
    "impulse_trials": "experiments.impulse_trials",
    "isolation": "fmu_tools.isolation",
    "master": "simulation.master",
    "metric_names": "simulation.metric_names",
    "metrics": "simulation.metrics",
    "native": "base.native",
    "noise_range": "experiments.noise_range",
    "plan": "scenario.plan",
    "plan_limits": "scenario.plan_limits",
    "presliding": "identification.presliding",
    "push_response": "simulation.push_response",
    "random_collisions": "scenario.random_collisions",
    "report.circle": "report.push_path",
    "report.calibration": "identification.figures",
    "report.drivetrain": "drivetrain.pictures",
    "report.impact_response": "experiments.figures.impact_response",
    "report.impulse_share": "experiments.figures.impulse_share",
    "report.reproduction": "experiments.reproduction.page",
    "report.reversal": "experiments.figures.reversal",
    "report.scene_view": "experiments.figures.scene_view",
    "report.static_pushes": "experiments.figures.static_pushes",
    "reproduce": "experiments.reproduction.reproduce",
    "reproduction": "experiments.reproduction.findings",
    "result": "simulation.result",
    "robot_changes": "robot.changes",
    "run_warnings": "simulation.run_warnings",
    "runner": "simulation.runner",
    "scenario_file": "scenario.scenario_file",
    "ssp": "fmu_tools.ssp",
    "stated_contact": "scenario.stated_contact",
    "static_pushes": "experiments.static_push_study",
    "study.native_part": "library.work",
    "summary": "simulation.summary",
    "sweep": "drivetrain.frequency_response",
    "table_files": "robot.table_files",
    "terminal": "base.terminal",
    "toml_lines": "base.toml_lines",
    "toml_sections": "base.toml_sections",
    "units": "base.units",
    "variables": "robot.variables",
    "words": "base.words",
})  # fmt: skip
"""Name of a module or of a folder of modules, without the package, and its name now."""


def name_now(name: str) -> str | None:
    """The present full name of the module formerly called ``name``; None if that is not a former name."""
    package, _, inside = name.partition(".")
    if package != PACKAGE:
        return None
    whole, rest = inside, ""
    while whole:
        if whole in FORMER_NAMES:
            return f"{PACKAGE}.{FORMER_NAMES[whole]}{rest}"
        whole, _, last = whole.rpartition(".")
        rest = f".{last}{rest}"
    return None


def forward_former_names() -> None:
    """Make former names importable."""
    if not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())  # first: the folder of the native files has the name of a former module


class _Finder(MetaPathFinder):
    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        now = name_now(fullname)
        return None if now is None else ModuleSpec(fullname, _Forward(now))


class _Forward(Loader):
    def __init__(self, now: str) -> None:
        self._now = now

    def exec_module(self, module: ModuleType) -> None:
        warnings.warn(f"{module.__name__} is {self._now} now", FutureWarning, stacklevel=2)
        sys.modules[module.__name__] = importlib.import_module(self._now)
