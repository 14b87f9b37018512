"""Every metric: its definition from the batch library, and its formula."""

from __future__ import annotations

import tomllib
from pathlib import Path

from giveway.library.batch_library import native_metrics
from giveway.study.metrics import DRIVETRAIN

from docs.markdown import escaped

__all__ = ["formulas", "pages"]

HEAD = """# Metrics

What a run is judged by. One place computes them, `fmu/batch/metrics.cpp`, from the rows of a run: for runs over the
FMUs, in the batch library by either method, and for traces that were read from a folder, with the same bits. In
brackets stands what the testbed knows to be true. Studies know metrics with a truth as `NAME (true)` and as
`NAME (error)`, the absolute difference of both.

In the formulas $c$ is the row of the first contact, $d$ that of the detection, $e$ the last one, $h$ the time between
two rows; $F$ is the contact's force on the robot and $\\hat F$ what the robot estimates.

## Of every run

"""
OF_DRIVETRAIN = """
## Of the drivetrain

These follow from the parameters of each run, without a simulation; {doc}`/how_to/drivetrain_study` says how to ask for
them. $F_0$ is the bumper's preload, $F_L$ the force of its latch, $k$ the stiffness of contact and spring in series,
$m$ the reflected inertia, $m_s$ the slider's mass.

"""


def formulas() -> dict[str, str]:
    """LaTeX by the metric's name."""
    return dict(tomllib.loads(Path(__file__).with_name("metric_formulas.toml").read_text(encoding="utf-8")))


def pages(root: Path) -> dict[str, str]:
    """One page; the definitions are those of the installed library, not of files below ``root``."""
    written = formulas()
    told = {one.name: (one.unit, one.description) for one in native_metrics()}
    text = HEAD + "".join(_entry(name, *what, written) for name, what in told.items()) + OF_DRIVETRAIN
    return {
        "reference/metrics.md": text + "".join(_entry(name, unit, "", written) for name, unit in DRIVETRAIN.items())
    }


def _entry(name: str, unit: str, words: str, written: dict[str, str]) -> str:
    """A term of a definition list."""
    parts = [escaped(words) + "." if words else "", f"${written[name]}$" if name in written else ""]
    return f"`{name}`, {unit}\n: " + "\n\n  ".join(part for part in parts if part) + "\n\n"
