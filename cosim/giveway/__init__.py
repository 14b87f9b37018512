"""giveway: collision reflexes for omnidirectional robot bases, as a co-simulation.

Three lines to a plot::

    import giveway
    result = giveway.run(giveway.experiment("motionless").scenario("magnetic"))
    result.traces["testbed.truth.contact_force"].plot()

Importing this package is light: numerical libraries are loaded when a run starts.
"""

from __future__ import annotations

import importlib
import logging
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.base.errors import GivewayError
from giveway.base.former_names import FORMER_NAMES, forward_former_names
from giveway.base.version import VERSION
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    from giveway import batch
    from giveway.experiments import Experiment
    from giveway.simulation.master import Progress
    from giveway.simulation.result import Result
    from giveway.simulation.runner import Engine
    from giveway.study import Study
    from giveway.study.answers import Answers
    from giveway.tuning.tuned import tune

__all__ = [
    "Answers",
    "GivewayError",
    "Result",
    "Scenario",
    "Study",
    "__version__",
    "batch",
    "experiment",
    "load",
    "read_scenario",
    "run",
    "tune",
]

__version__ = VERSION
logging.getLogger(__name__).addHandler(logging.NullHandler())
forward_former_names()


def run(scenario: Scenario, progress: Progress | None = None, engine: Engine = "fmu") -> Result:
    """Run ``scenario`` and return traces, metrics and manifest.

    ``engine`` "fmu" steps the FMUs over FMPy; "native" gives the same bits from the batch library, several times as
    fast, and reads no FMU (``fmi_version`` says nothing then).

    ``progress``, if given, is called now and then with the simulated time and the duration (both in s). Ctrl-C ends the
    run cleanly; the result then contains the part that was computed, and its manifest says so.

    Raises:
        GivewayError: ``scenario`` is no scenario, something in it is not allowed, or there is no such engine.
        SimulationError: an FMU or the library failed.
    """
    if not isinstance(scenario, Scenario):
        allowed = (
            'a giveway.Scenario, such as giveway.experiment("motionless").scenario("magnetic") or '
            'giveway.read_scenario("examples/trolley.toml")'
        )
        raise GivewayError("scenario", repr(scenario), allowed)
    from giveway.simulation import runner

    return runner.run(scenario, progress, engine)


def load(folder: Path | str) -> Result:
    """Read a result that was saved with `Result.save` or ``giveway run --out``."""
    from giveway.simulation import result

    return result.load(folder)


def experiment(name: str, preset: str = "default") -> Experiment:
    """The experiment called ``name``, e.g. "motionless"; ``preset`` "paper": with the reflex of the paper."""
    from giveway import experiments

    return experiments.get(name, preset)


def read_scenario(path: Path | str) -> Scenario:
    """The scenario in a TOML file, checked; see ``examples/``."""
    from giveway.scenario import scenario_file

    return scenario_file.read_scenario(path)


_LATER = {
    "Answers": "giveway.study.answers",
    "Result": "giveway.simulation.result",
    "Study": "giveway.study",
    "batch": "giveway.batch",
    "tune": "giveway.tuning.tuned",
}


def __getattr__(name: str) -> object:
    if name in FORMER_NAMES:
        return importlib.import_module(f"{__name__}.{name}")
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = importlib.import_module(_LATER[name])
    return module if _LATER[name] == f"{__name__}.{name}" else getattr(module, name)


def __dir__() -> list[str]:
    return sorted([*__all__, *(name for name in globals() if name.startswith("__"))])
