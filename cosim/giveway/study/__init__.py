"""Studies: thousands of bumper designs, stored so that nothing is lost, with first answers.

    study = giveway.Study("latch", duration=0.6, bumper="magnetic")
    study.collision("front", speed=0.5, mass=9.08, edge=0)
    study.vary("testbed.bumper.spring_rate", low=0.4, high=3.0, unit="N/mm", levels=5)
    study.vary("testbed.bumper.latch_force", low=0.0, high=100.0, levels=11)
    study.tolerance("testbed.bumper.latch_force", relative=0.3)
    study.objective("detection time")
    study.objective("peak force of the run")
    answers = study.run("out/latch")
    print(answers.table())

The keywords are the keys of a study file (`cosim/README.md`).
"""

from __future__ import annotations

import copy
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from giveway.study.answers import Answers
    from giveway.study.engine import Report
    from giveway.study.setup import Setup

__all__ = ["Study"]


class Study:
    """A study that is being put together; nothing is checked until `setup` or `run`."""

    def __init__(self, name: str, *, seed: int = 1, method: str = "event-exact", **scenario: Any) -> None:
        """``scenario``: the keys of ``[scenario]``: duration (s, needed), bumper, robot, body_region, plan, ..."""
        self.document: dict[str, Any] = {
            "schema_version": 1,
            "name": name,
            "seed": seed,
            "method": method,
            "scenario": {key: str(value) if isinstance(value, Path) else value for key, value in scenario.items()},
        }

    def collision(self, name: str, **keys: Any) -> Study:
        """One more collision that every design goes through: speed (m/s), mass (kg), edge or point, ..."""
        return self._add("collision", {"name": name, **keys})

    def vary(self, quantity: str, **keys: Any) -> Study:
        """A quantity that differs between designs: values, or low and high, with unit, levels, distribution, ..."""
        return self._add("vary", {"quantity": quantity, **keys})

    def tolerance(self, quantity: str, **keys: Any) -> Study:
        """A quantity that deviates from its design, by ``relative`` (0.3: 30 %) or ``absolute``."""
        return self._add("tolerance", {"quantity": quantity, **keys})

    def designs(self, kind: str, **keys: Any) -> Study:
        """How designs are made: "factorial", "latin-hypercube" (count), "sobol" (count), "one-at-a-time", ..."""
        self.document["designs"] = {"kind": kind, **keys}
        return self

    def tolerances(self, **keys: Any) -> Study:
        """How tolerances are sampled: samples, kind, noise_seeds."""
        self.document["tolerances"] = keys
        return self

    def objective(self, metric: str, **keys: Any) -> Study:
        """A metric that should be small, or large with ``goal="maximise"``."""
        return self._add("objective", {"metric": metric, **keys})

    def constraint(self, metric: str, **keys: Any) -> Study:
        """A metric with a ``minimum`` or a ``maximum``, in ``unit``."""
        return self._add("constraint", {"metric": metric, **keys})

    def report(self, **keys: Any) -> Study:
        """What the answers show besides: metrics (a list of names), chosen (how many designs get traces)."""
        self.document["report"] = keys
        return self

    def setup(self, folder: Path | str = ".") -> Setup:
        """The study, checked; paths in it are seen from ``folder``.

        Raises:
            GivewayError: names what is wrong by its key, such as ``vary[0].low``.
        """
        from giveway.study.study_file import check

        return check(copy.deepcopy(self.document), Path(folder), self.document["name"])

    def run(self, folder: Path | str, *, threads: int | None = None, progress: Report | bool = True) -> Answers:
        """Run what is missing in ``folder`` and return the answers; Ctrl-C ends it early, the same call goes on.

        Args:
            folder: where results are stored; made if it is not there.
            threads: native ones, 1 to 1024; None: all processors.
            progress: True: a bar on stderr at a terminal, else a line every few seconds; False: nothing; or what is
                called now and then with a `giveway.study.engine.Progress`.

        Raises:
            GivewayError: the study is wrong; nothing was run.
            FileError: the folder holds something else, is in use, or cannot be written.
            WriteError: the disk refused on the way; the parts before it are kept.
        """
        from giveway.study.answers import load
        from giveway.study.command import showing
        from giveway.study.engine import sweep

        setup = self.setup()
        with showing(setup.name) if progress is True else nullcontext(progress or None) as report:
            sweep(setup, folder, threads=threads, progress=report)
        return load(folder)

    def _add(self, table: str, entry: dict[str, Any]) -> Study:
        self.document.setdefault(table, []).append(entry)
        return self
