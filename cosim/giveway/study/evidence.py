"""Evidence for one design of a study: what it does over speed, place and test mass, worst case within its tolerances.

The runs are a study of their own in DIR/evidence/design-N, stored and reused like any other one.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import GivewayError
from giveway.base.units import WrittenUnit
from giveway.study.chosen import hit_of
from giveway.study.engine import Report, sweep
from giveway.study.frames import best_design, every_run
from giveway.study.limit_lines import unit_of
from giveway.study.quantities import find, value_of
from giveway.study.store import EVIDENCE
from giveway.study.study_file import check

if TYPE_CHECKING:
    import pandas
    from numpy.typing import NDArray

    from giveway.study.answers import Answers
    from giveway.study.setup import Setup

__all__ = ["COLUMNS", "NOTICE", "Evidence", "evidence", "evidence_setup"]

NOTICE = "Evidence from simulation, not certification: it does not replace a test on the machine, nor ISO/TS 15066."
SPEEDS = (0.25, 0.5, 0.75, 1.0, 1.25)  # shares of the fastest hit that the study has
MASSES = (0.5, 1.0, 2.0)  # shares of the heaviest
PLACES = (0.1, 0.5, 0.9)  # shares of each side of the outline
AFTER_S = 0.8  # that a run lasts after the contact at least: the lasting force is known 0.5 s after it
_SPEED, _MASS, _AROUND, _OFFSET, _DIRECTION = (
    "collision.speed", "collision.mass", "collision.around", "collision.offset", "collision.direction",
)  # fmt: skip
COLUMNS = {
    "peak force": ("transient force", 1),
    "lasting force": ("lasting force", 1),
    "travel": ("bumper compression", 1),
    "over-travel": ("bottoming margin", -1),
    "detection time": ("detection time", 1),
}
"""Columns of the table: the metric, and whether the largest (1) or the smallest (-1) is the worst."""


@dataclass(frozen=True)
class Evidence:
    """What was found.

    Attributes:
        design: of the study.
        folder: of the runs, and of evidence.html and evidence.csv.
        answers: of the study that these runs are.
        table: a line per collision, speed, place and mass: nominal and worst of every one of `COLUMNS` and of the
            mean pressure, if the contact's area is stated; how many runs failed.
    """

    design: int
    folder: Path
    answers: Answers
    table: pandas.DataFrame


def evidence(
    answers: Answers,
    design: int | None = None,
    *,
    speeds: Sequence[float] | None = None,
    masses: Sequence[float] | None = None,
    threads: int | None = None,
    progress: Report | None = None,
) -> Evidence:
    """Run a design of a study over speed, place and test mass, or take what is stored.

    Args:
        answers: of the study.
        design: its number; None: the recommended one.
        speeds: at the contact, m/s; None: a quarter to five quarters of the study's fastest hit.
        masses: of what collides, kg; None: half, whole and twice the heaviest; a body region has its own.
        threads: native ones; None: all processors.
        progress: called now and then.

    Raises:
        GivewayError: no design is allowed, there is no such one, or the study has no collision.
    """
    from giveway.study.answers import load

    number = best_design(answers) if design is None else answers.check_design(design)
    folder = answers.folder / EVIDENCE / f"design-{number}"
    outcome = sweep(evidence_setup(answers, number, speeds, masses), folder, threads=threads, progress=progress)
    if outcome.interrupted:
        raise KeyboardInterrupt
    found = load(folder)
    return Evidence(number, folder, found, _table(answers, found))


def evidence_setup(
    answers: Answers, design: int, speeds: Sequence[float] | None, masses: Sequence[float] | None
) -> Setup:
    """The study of one design over speed, place and mass."""
    setup = answers.setup
    hits = [case.hit for case in setup.cases if case.hit is not None]
    if not hits:
        raise GivewayError("collision", "nothing", "[[collision]]: evidence is about hits")
    document = copy.deepcopy(answers.manifest["study"])
    _fix(answers, design, document)
    added = [{"quantity": _SPEED, "values": _speeds(answers, speeds)}]
    if setup.cases[0].scenario.body_region is None:
        added.append({"quantity": _MASS, "values": _masses(answers, masses)})
    elif masses is not None:
        raise GivewayError("--masses", list(masses), "nothing: the body region has its own mass")
    touched = {one.quantity.name for one in setup.varied} | {one.quantity.name for one in setup.tolerances}
    if all(hit.direction_deg is None for hit in hits) and not touched & {_OFFSET, _DIRECTION}:
        added.append({"quantity": _AROUND, "values": _places(answers)})
    names = [one["quantity"] for one in added]
    document["vary"] = [one for one in document.get("vary", []) if one["quantity"] not in names] + added
    kept = [one for one in setup.tolerances if not (one.replaces and one.quantity.name in names)]
    stated = [one.quantity.name for one in kept]  # the table says speed, mass and place itself
    document["tolerance"] = [one for one in document.get("tolerance", []) if one["quantity"] in stated]
    document["designs"] = {"kind": "factorial"}
    document["report"] = {"chosen": 0}
    document["name"] = f"design {design} of {setup.name}"[:80]
    document.pop("optimise", None)
    document.pop("sure", None)
    last = max((hit.time_s for hit in hits if hit.time_s is not None), default=0.0)
    document["scenario"]["duration"] = max(float(document["scenario"]["duration"]), last + AFTER_S)
    return check(document, answers.folder, document["name"])


def _fix(answers: Answers, design: int, document: dict[str, Any]) -> None:
    """Every quantity and part of the study has the design's value."""
    given = {one["quantity"]: one for one in document.get("vary", [])}
    parts = {one["name"]: one for one in document.get("parts", [])}
    document["vary"] = []
    for one, value in zip(answers.setup.varied, answers.designs[design].tolist(), strict=True):
        kind, name = one.quantity.kind, one.quantity.name
        if one.parts is not None:
            parts[name]["only"] = [one.text(value)]
            parts[name].pop("nominal", None)
            continue
        typed: Any = {"choice": one.quantity.text(value) if kind == "choice" else "", "boolean": bool(value),
                      "integer": int(value)}.get(kind, value)  # fmt: skip
        also = {"also": given[name]["also"]} if "also" in given.get(name, {}) else {}
        document["vary"].append({"quantity": name, "values": [typed], **also})


def _checked(option: str, values: Sequence[float], name: str) -> list[float]:
    """Values of a quantity, within its range."""
    quantity = find(option, name)
    return [value_of(option, value, quantity) for value in values]


def _speeds(answers: Answers, speeds: Sequence[float] | None) -> list[float]:
    if speeds is not None:
        return _checked("--speeds", speeds, _SPEED)
    fastest = _largest(answers, _SPEED, [case.hit.speed_mps for case in answers.setup.cases if case.hit is not None])
    return [float(f"{share * fastest:.3g}") for share in SPEEDS]


def _masses(answers: Answers, masses: Sequence[float] | None) -> list[float]:
    if masses is not None:
        return _checked("--masses", masses, _MASS)
    stated = [float(case.scenario.parameters("testbed")["slider.mass"] or 0.0) for case in answers.setup.cases]
    return [float(f"{share * _largest(answers, _MASS, stated):.3g}") for share in MASSES]


def _largest(answers: Answers, name: str, stated: Sequence[float]) -> float:
    """The largest value that the study gives a quantity of the hit."""
    varied = [j for j, one in enumerate(answers.setup.varied) if one.quantity.name == name]
    return float(answers.designs[:, varied[0]].max()) if varied else max(stated)


def _places(answers: Answers) -> list[float]:
    outline = answers.runs.cases[0].outline
    lengths = np.hypot(*(np.roll(outline, -1, axis=0) - outline).T)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    return [float((ends[i] + share * lengths[i]) / ends[-1]) for i in range(len(lengths)) for share in PLACES]


def _table(study: Answers, found: Answers) -> pandas.DataFrame:
    """The lines of `Evidence.table`."""
    import pandas

    runs = every_run(found, sorted({metric for metric, _ in COLUMNS.values()}))
    area = found.setup.cases[0].scenario.contact_area_m2
    names = [one.quantity.name for one in found.setup.varied]
    rows: list[dict[str, Any]] = []
    for design in range(len(found.designs)):
        value = dict(zip(names, found.designs[design].tolist(), strict=True))
        for case, its in enumerate(found.setup.cases):
            hit = hit_of(found.runs, design, 0, case)
            mass = value.get(_MASS, float(its.scenario.parameters("testbed")["slider.mass"] or 0.0))
            row = {"collision": its.name, "speed [m/s]": value[_SPEED], "x [mm]": round(1e3 * hit["point_x"], 1),
                   "y [mm]": round(1e3 * hit["point_y"], 1), "mass [kg]": mass}  # fmt: skip
            for name, (metric, sense) in COLUMNS.items():
                unit = unit_of(study, (metric,), str(runs[metric].attrs["units"]))
                of_samples = runs[metric].values[design, :, case]
                row |= _two(name, of_samples, sense, unit)
                if area is not None and metric.endswith("force"):
                    row |= _two(name.replace("force", "pressure"), of_samples / (1e4 * area), 1, WrittenUnit("N/cm2"))
            row["failed runs"] = int(found.failed[design])
            rows.append(row)
    return pandas.DataFrame(rows)


def _two(name: str, samples: NDArray[np.float64], sense: int, unit: WrittenUnit) -> dict[str, float]:
    """The nominal value and the worst of all; over-travel is how far the stop was compressed."""
    # What one sample does not know, such as the time of a detection that did not come, the worst case does not either.
    worst = math.nan if np.isnan(samples).any() else float(samples.max() if sense > 0 else samples.min())
    pair = [unit.of(one) for one in (float(samples[0]), worst)]
    if sense < 0:
        pair = [one if math.isnan(one) else max(0.0, -one) for one in pair]
    return {f"{name}, nominal [{unit.name}]": pair[0], f"{name}, worst [{unit.name}]": pair[1]}
