"""giveway: collision reflexes for omnidirectional robot bases, as a co-simulation.

Three lines to a plot::

    import giveway
    result = giveway.run(giveway.experiment("motionless").scenario("magnetic"))
    result.traces["testbed.truth.contact_force"].plot()

Importing this package is light: numerical libraries are loaded when a run starts.
"""

from __future__ import annotations

import importlib.metadata
import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any

from giveway.errors import GivewayError
from giveway.scenario import Scenario

if TYPE_CHECKING:
    from giveway.experiments import Experiment
    from giveway.master import Progress
    from giveway.result import Result
    from giveway.study import Study

__all__ = ["GivewayError", "Scenario", "Study", "__version__", "experiment", "load", "read_scenario", "run"]

try:
    __version__ = importlib.metadata.version("giveway")
except importlib.metadata.PackageNotFoundError:  # used from a source tree
    __version__ = "0+source"

logging.getLogger(__name__).addHandler(logging.NullHandler())


def run(scenario: Scenario, progress: Progress | None = None) -> Result:
    """Co-simulate ``scenario`` and return traces, metrics and manifest.

    ``progress``, if given, is called now and then with the simulated time and the duration (both in s).
    Ctrl-C ends the run cleanly; the result then holds what was computed and says so in its manifest.
    """
    from giveway import runner

    return runner.run(scenario, progress)


def load(folder: Path | str) -> Result:
    """Read a result that was saved with `Result.save` or ``giveway run --out``."""
    from giveway import result

    return result.load(folder)


def experiment(name: str) -> Experiment:
    """The experiment called ``name``, e.g. "motionless"."""
    from giveway import experiments

    return experiments.get(name)


def read_scenario(path: Path | str) -> Scenario:
    """The scenario in a TOML file, checked; see ``examples/``."""
    from giveway import scenario_file

    return scenario_file.read_scenario(path)


def __getattr__(name: str) -> Any:
    if name == "Result":
        from giveway.result import Result

        return Result
    if name == "Study":
        from giveway.study import Study

        return Study
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
