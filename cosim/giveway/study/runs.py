"""The runs of a study as tables: every parameter of both models in one row per run, made with arrays, not one by one.

Run r belongs to design ``r // (samples * cases)``, tolerance sample and collision follow, the collision fastest. A row
is all that decides a run besides its collision's plan, pushes and duration: its hash is the run's key.
"""

from __future__ import annotations

import copy
import dataclasses
import hashlib
import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import GivewayError
from giveway.library.work import CaseWork, Work
from giveway.scenario.approach import Approaches, edge_middle, meet_many, outline_of
from giveway.scenario.plan_limits import LIMIT_NAMES, check_plan, limits_of
from giveway.scenario.scenario_file import PLAN_KEYS
from giveway.simulation.master import plan_table, push_table
from giveway.simulation.run_warnings import Stated, plan_speed
from giveway.study.distributions import Tolerance, Varied
from giveway.study.influences import INFLUENCES
from giveway.study.observed_motors import follow_motors, following
from giveway.study.part_rules import part_rules, refusals
from giveway.study.parts import choices_of
from giveway.study.quantities import Columns, columns, find
from giveway.study.setup import Case, Hit, Setup

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["KEY_SIZE", "Rows", "RunTable"]

KEY_SIZE = 16
COVER = "testbed.contact.stiffness"
SLIDER = ("slider.direction", "slider.target_x", "slider.target_y", "slider.run_up", "slider.speed")


@dataclass(frozen=True)
class Rows:
    """Some runs of one collision.

    Attributes:
        values: of every parameter, shape (n, columns).
        hit: per run, what the slider's start was computed from: speed, time, offset, around, direction, angle,
            point_x, point_y; units of the study file.
        stated: what the runs are asked to do.
        refused: why a run is impossible, by its index here.
    """

    values: NDArray[np.float64]
    hit: dict[str, NDArray[np.float64]]
    stated: Stated
    refused: dict[int, str]


class _CaseTable:
    """One collision: what all its runs share."""

    def __init__(self, case: Case, columns_: Columns) -> None:
        self.case = case
        scenario = case.scenario
        self.base = columns_.start.copy()
        self.set = np.zeros(len(self.base), dtype=bool)
        for model in ("controller", "testbed"):
            for name, value in scenario.parameters(model).items():
                where = columns_.index[f"{model}.{name}"]
                self.base[where], self.set[where] = float(value), True
        self.body = None if scenario.body_region is None else scenario.judged
        """What is hit: its stiffness lies in series with the cover's, which is what the rows hold until the end."""
        if self.body is not None:
            cover = dataclasses.replace(scenario, body_region=None).parameters("testbed")
            where = columns_.index[COVER]
            self.base[where] = float(cover.get("contact.stiffness", columns_.start[where]))
        self.plan = plan_table(scenario)
        self.push = push_table(scenario)
        self.outline = outline_of({name: float(v[0]) for name, v in columns_.testbed(self.base[None, :]).items()})

    def work(self) -> CaseWork:
        """What its runs share, for the library."""
        scenario, judged = self.case.scenario, self.case.scenario.judged
        limits = (0.0, 0.0) if judged is None else (judged.peak_limit_n, judged.lasting_limit_n)
        return CaseWork(scenario.step_s, scenario.steps, *limits, self.plan, self.push)

    def context(self, shared: dict[str, Any]) -> bytes:
        """Hash of all that decides a run besides its row."""
        scenario = self.case.scenario
        judged = scenario.body_region or scenario.judge_as
        own = {"step_s": scenario.step_s, "steps": scenario.steps, "body_region": judged}
        text = json.dumps({**shared, **own}, sort_keys=True)
        found = hashlib.blake2b(text.encode(), digest_size=32)
        found.update(np.ascontiguousarray(self.plan).tobytes())
        if self.push is not None:
            found.update(b"push" + np.ascontiguousarray(self.push).tobytes())
        return found.digest()


class RunTable:
    """All runs of ``setup`` over its ``designs`` (n, quantities) and ``deviations`` (samples, tolerances)."""

    def __init__(self, setup: Setup, designs: NDArray[np.float64], deviations: NDArray[np.float64]) -> None:
        self.columns = columns()
        self.designs, self.deviations = designs, deviations
        self.varied, self.tolerances = setup.varied, setup.tolerances
        self.noise_seeds = setup.noise_seeds
        self.noise_offsets: NDArray[np.float64] | None = None
        """Per sample, what its noise seed is greater by; None: the sample's number."""
        self.cases = [_CaseTable(case, self.columns) for case in setup.cases]
        self.samples = len(deviations)
        self.per_design = self.samples * len(self.cases)
        self.count = len(designs) * self.per_design
        self.derived, self.drivetrain = setup.derived, setup.drivetrain
        self.rules = [part_rules(choice) for choice in choices_of(setup.varied)]
        quantities = [quantity for one in setup.varied for quantity in one.sets]
        quantities += [one.quantity for one in setup.tolerances]
        self.crowd = setup.crowd
        touched = [self.columns.index[f"testbed.{name}"] for one in setup.crowd for name in one.parameters]
        touched += [column for quantity in quantities for column in quantity.columns]
        met = [self.columns.index[f"testbed.{name}"] for name in SLIDER] if setup.cases[0].hit is not None else []
        self.named = frozenset(quantity.name for quantity in quantities)
        """What varies."""
        touched += [self.columns.index[name] for name in following(self.named)]
        for cause in self.named & INFLUENCES.keys():
            touched += [self.columns.index[name] for name in INFLUENCES[cause].factors]
        if setup.noise_seeds:
            touched.append(self.columns.index["testbed.electronics.seed"])
        used = np.any([case.set for case in self.cases], axis=0)
        used[[*touched, *met]] = True
        self.used = np.flatnonzero(used)
        """Columns that are not at their start in some run."""
        self._case_works = tuple(one.work() for one in self.cases)

    def with_deviations(self, deviations: NDArray[np.float64], noise: NDArray[np.float64] | None = None) -> RunTable:
        """The same designs with other samples of the tolerances, and other `noise_offsets`."""
        found = copy.copy(self)
        found.deviations, found.samples, found.noise_offsets = deviations, len(deviations), noise
        found.per_design = found.samples * len(found.cases)
        found.count = len(found.designs) * found.per_design
        return found

    def robot_draws(self) -> list[tuple[str, int]]:
        """Of robots that differ: name and column of the deviations of every draw."""
        named = [
            f"{one.what} {draw + 1}" if one.draws > 1 else one.what for one in self.crowd for draw in range(one.draws)
        ]
        return [(name, len(self.tolerances) + j) for j, name in enumerate(named)]

    def split(self, run: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        """Design, tolerance sample and collision of runs."""
        design, rest = np.divmod(run, self.per_design)
        sample, case = np.divmod(rest, len(self.cases))
        return design, sample, case

    def rows(self, design: NDArray[np.int64], sample: NDArray[np.int64], case: int) -> Rows:
        """The parameters of runs of one collision."""
        table = self.cases[case]
        values = np.repeat(table.base[None, :], len(design), axis=0)
        hit = _nominal_hit(table.case.hit, len(design))
        free = hit | {name: np.full(len(design), cause.nominal) for name, cause in INFLUENCES.items()}
        for j, one in enumerate(self.varied):
            _write(values, free, one, self.designs[design, j])
        for j, tolerance in enumerate(self.tolerances):
            _deviate(values, free, tolerance, self.deviations[sample, j])
        self._draw_robots(values, sample)
        if self.noise_seeds:
            values[:, self.columns.index["testbed.electronics.seed"]] += (
                sample if self.noise_offsets is None else self.noise_offsets[sample]
            )
        unfit = self._misfits(design, values, free)
        self._influence(values, {name: free.pop(name) for name in INFLUENCES})
        follow_motors(values, self.columns.index, table.base, self.named)
        if table.body is not None:
            values[:, self.columns.index[COVER]] = table.body.stiffness_with(values[:, self.columns.index[COVER]])
        refused = self._beyond_limits(table, values)
        speed_mps = np.full(len(design), math.nan)
        if table.case.hit is not None:
            speed_mps, reasons = self._meet(table, values, free)
            refused = reasons | refused
        refused |= unfit
        values += 0.0  # no negative zeros: equal runs have equal rows
        return Rows(values, free, _stated(table.case, free, speed_mps), refused)

    def _draw_robots(self, values: NDArray[np.float64], sample: NDArray[np.int64]) -> None:
        """Write what robots of their own differ in; the nominal sample has the file's."""
        first = len(self.tolerances)
        for one in self.crowd:
            shares = self.deviations[sample, first : first + one.draws]
            first += one.draws
            drawn = ~np.isnan(shares).any(axis=1)
            for name, found in one.at(shares[drawn]):
                column = self.columns.index[f"testbed.{name}"]
                its = found * values[drawn, column] if one.scales else found
                values[drawn, column] = np.floor(its) if self.columns.whole[column] else its

    def _influence(self, values: NDArray[np.float64], causes: dict[str, NDArray[np.float64]]) -> None:
        """Multiply the parameters that causes change."""
        for name, its in causes.items():
            if (its == INFLUENCES[name].nominal).all():
                continue
            for parameter, factor in INFLUENCES[name].factors.items():
                column = self.columns.index[parameter]
                found = values[:, column] * factor(its)
                values[:, column] = np.rint(found) if self.columns.whole[column] else found

    def _misfits(
        self, design: NDArray[np.int64], values: NDArray[np.float64], free: dict[str, NDArray[np.float64]]
    ) -> dict[int, str]:
        """Why the parts of runs do not fit."""
        found: dict[int, str] = {}

        def of(name: str) -> NDArray[np.float64]:
            quantity = find(name, name)
            return values[:, quantity.columns[0]] if quantity.columns else free[name.removeprefix("collision.")]

        chosen = [(j, one.parts) for j, one in enumerate(self.varied) if one.parts is not None]
        kind = values[:, self.columns.index["testbed.bumper.kind"]]
        for (j, choice), rules in zip(chosen, self.rules, strict=True):
            part = self.designs[design, j].astype(np.intp)
            found = refusals(choice, rules, part, of, kind) | found
        return found

    def _beyond_limits(self, table: _CaseTable, values: NDArray[np.float64]) -> dict[int, str]:
        """Why the controller cannot follow the plan, per run: its limits may vary."""
        where = [self.columns.index[f"controller.{name}"] for name in LIMIT_NAMES]
        different, which = np.unique(values[:, where], axis=0, return_inverse=True)
        reasons: dict[int, str] = {}
        for index, row in enumerate(different):
            try:
                check_plan(table.case.scenario.plan, limits_of(dict(zip(LIMIT_NAMES, row.tolist(), strict=True))))
            except GivewayError as error:
                error.field = f"scenario.plan.{PLAN_KEYS[error.field.rpartition('.')[2]]}"
                reasons[index] = str(error)
        return {run: reasons[int(k)] for run, k in enumerate(which.ravel()) if int(k) in reasons} if reasons else {}

    def _meet(
        self, table: _CaseTable, values: NDArray[np.float64], hit: dict[str, NDArray[np.float64]]
    ) -> tuple[NDArray[np.float64], dict[int, str]]:
        """Write the slider's start for the hit; returns the contact speeds, and why runs are impossible."""
        case_hit = table.case.hit
        assert case_hit is not None
        refused: dict[int, str] = {}
        points, straight = _points(table.outline, case_hit, hit, refused)
        hit["point_x"], hit["point_y"] = points.T
        direction = np.radians(hit["direction"])
        turned = hit["angle"] != 0.0
        if turned.any():
            direction = np.where(turned, straight + np.radians(hit["angle"]), direction)
        testbed = self.columns.testbed(values)
        controller = self.columns.index
        tare = (
            values[:, controller["controller.estimator.tare_ticks"]]
            * values[:, controller["controller.controller.period"]]
        )
        with np.errstate(all="ignore"):
            met = meet_many(
                Approaches(points, hit["speed"], direction, None if case_hit.time_s is None else hit["time"]),
                testbed,
                table.case.scenario.plan,
                tare,
            )
        for name, found in met.slider.items():
            values[:, self.columns.index[f"testbed.{name}"]] = found
        names = {"point_m": "place", "speed_mps": "speed", "direction_rad": "direction"}
        for index, error in met.refused.items():
            error.field = f"collision.{names.get(error.field, error.field)}"
            refused.setdefault(index, str(error))
        duration_s = table.case.scenario.duration_s
        for run in np.flatnonzero(met.time_s >= duration_s).tolist():
            allowed = f"before the end of the run at {duration_s:g} s"
            refused.setdefault(run, str(GivewayError("collision.time", f"{met.time_s[run]:g}", allowed)))
        return met.contact_speed_mps, refused

    def work(
        self, values: NDArray[np.float64], case: NDArray[np.int64], method: str, plant_step_s: float | None
    ) -> Work:
        """Runs with parameters ``values`` (n, columns) of the collisions ``case`` (n,), for the library."""
        used = values[:, self.used]
        differing = np.flatnonzero((used != used[:1]).any(axis=0))
        return Work(
            self._case_works,
            case,
            self.columns.model[self.used],
            self.columns.reference[self.used],
            used[0].copy() if len(used) else np.zeros(len(self.used)),
            differing,
            used[:, differing],
            method,
            plant_step_s,
        )

    def keys(self, contexts: list[bytes], rows: Rows, case: int) -> list[bytes]:
        """The key of each row: equal keys are equal runs."""
        packed, size = np.ascontiguousarray(rows.values).tobytes(), rows.values.shape[1] * 8
        base = hashlib.blake2b(contexts[case], digest_size=KEY_SIZE)
        found = []
        for start in range(0, len(packed), size):
            digest = base.copy()
            digest.update(packed[start : start + size])
            found.append(digest.digest())
        return found


def _stated(case: Case, hit: dict[str, NDArray[np.float64]], speed_mps: NDArray[np.float64]) -> Stated:
    """What runs of ``case`` are asked to do."""
    count, unknown = len(speed_mps), np.full(len(speed_mps), math.nan)
    planned = plan_speed(case.scenario) if case.hit is not None else None
    return Stated(
        speed_mps,
        hit.get("point_x", unknown),
        hit.get("point_y", unknown),
        hit["time"] if case.hit is not None and case.hit.time_s is not None else unknown,
        unknown if planned is None else np.full(count, planned),
        np.full(count, case.scenario.duration_s),
        contact=np.full(count, case.hit is not None),
        region=np.full(count, case.scenario.judged is not None),
    )


def _nominal_hit(hit: Hit | None, count: int) -> dict[str, NDArray[np.float64]]:
    if hit is None:
        return {}
    nominal = {
        "speed": hit.speed_mps,
        "time": 0.0 if hit.time_s is None else hit.time_s,
        "offset": hit.offset_m,
        "around": math.nan,
        "direction": math.nan if hit.direction_deg is None else hit.direction_deg,
        "angle": 0.0,
    }
    return {name: np.full(count, value) for name, value in nominal.items()}


def _write(
    values: NDArray[np.float64], free: dict[str, NDArray[np.float64]], one: Varied, found: NDArray[np.float64]
) -> None:
    if one.parts is not None:
        part = found.astype(np.intp)
        given = [(setting.quantity, setting.values[part]) for setting in one.parts.settings]
    else:
        given = [(one.quantity, found)]
    for quantity, its in given:
        for column in quantity.columns:
            values[:, column] = its
        if not quantity.columns:
            free[quantity.name.removeprefix("collision.")] = its.copy()


def _deviate(
    values: NDArray[np.float64], free: dict[str, NDArray[np.float64]], one: Tolerance, by: NDArray[np.float64]
) -> None:
    def deviated(nominal: NDArray[np.float64]) -> NDArray[np.float64]:
        if one.replaces:
            return np.where(np.isnan(by), nominal, by)
        return nominal * (1.0 + by) if one.relative else nominal + by

    for column in one.quantity.columns:
        values[:, column] = deviated(values[:, column])
    if not one.quantity.columns:
        name = one.quantity.name.removeprefix("collision.")
        free[name] = deviated(free[name])


def _points(
    outline: NDArray[np.float64], hit: Hit, free: dict[str, NDArray[np.float64]], refused: dict[int, str]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Contact points (n, 2), and the direction straight into the robot there, rad, seen from the resting robot."""
    sides = np.roll(outline, -1, axis=0) - outline
    lengths = np.hypot(*sides.T)
    inward = np.arctan2(sides[:, 0], -sides[:, 1])  # of each side's normal
    count = len(free["speed"])
    if not np.isnan(free["around"]).all():
        ends = np.concatenate([[0.0], np.cumsum(lengths)])
        distance = np.mod(free["around"], 1.0) * ends[-1]
        side = np.clip(np.searchsorted(ends, distance, side="right") - 1, 0, len(outline) - 1)
        share = (distance - ends[side]) / lengths[side]
        return outline[side] + share[:, None] * sides[side], inward[side]
    if hit.point_m is not None:
        from giveway.scenario.approach import outward_normal

        normal = outward_normal(outline, hit.point_m)
        return np.tile(hit.point_m, (count, 1)), np.full(count, math.atan2(-normal[1], -normal[0]))
    assert hit.edge is not None
    half = 0.5 * float(lengths[hit.edge])
    for index in np.flatnonzero(np.abs(free["offset"]) > half):
        refused[int(index)] = (
            f"collision.offset: {free['offset'][index]:g} is not allowed; allowed: {-half:g} to {half:g} m"
        )
    offset = np.clip(free["offset"], -half, half)
    if (offset == offset[:1]).all():
        points = np.tile(edge_middle(outline, hit.edge, float(offset[0])) if count else (0.0, 0.0), (count, 1))
    else:
        middle = 0.5 * (outline[hit.edge] + outline[(hit.edge + 1) % len(outline)])
        points = middle + sides[hit.edge] * (offset / lengths[hit.edge])[:, None]
    return points, np.full(count, float(inward[hit.edge]))
