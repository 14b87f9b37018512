"""Studies: thousands of bumper designs, stored so that nothing is lost, with first answers.

    study = giveway.Study("latch", duration=1.1, bumper="magnetic")
    study.collision("front", speed=0.5, mass=9.08, edge=0)
    study.vary("testbed.bumper.spring_rate", low=0.4, high=3.0, unit="N/mm", levels=5)
    study.vary("testbed.bumper.latch_force", low=0.0, high=100.0, levels=11)
    study.tolerance("testbed.bumper.latch_force", relative=0.3)
    study.objective("detection time")
    study.objective("peak force of the run")
    answers = study.run("out/latch")
    print(answers.table())

The keywords are the keys of a study file (`giveway schema study`).
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from giveway.study.answers import Answers
    from giveway.study.engine import Report
    from giveway.study.setup import Setup

__all__ = ["Study"]

Keys = Mapping[str, Any]
Distribution = Literal["uniform", "loguniform", "triangular", "normal"]
OverCollisions = Literal["worst", "mean"]
OverTolerances = Literal["worst", "mean", "nominal"]
Limit = Literal["transient limit", "lasting limit"]


class Study:
    """A study that is being put together; nothing is checked until `setup` or `run`.

    Every method returns the study itself, so that calls can be chained. What is left out, or None, is as if its key
    were not in a study file.
    """

    def __init__(
        self,
        name: str,
        *,
        duration: float,
        bumper: Literal["none", "spring", "magnetic", "foam", "gas", "damper", "series", "lever", "table"]
        | Mapping[str, Any]
        | None = None,
        robot: Path | str | None = None,
        plan: Keys | None = None,
        push: Sequence[Keys] | None = None,
        body_region: str | None = None,
        judge_as: str | None = None,
        contact_area: Keys | None = None,
        preset: Literal["default", "paper"] | None = None,
        testbed: Keys | None = None,
        controller: Keys | None = None,
        noise_seed: int | None = None,
        seed: int = 1,
        method: Literal["event-exact", "fixed-step"] = "event-exact",
        plant_step: float | None = None,
        part_runs: int | None = None,
    ) -> None:
        """Begin with what all designs have in common.

        Args:
            name: 1 to 80 characters.
            duration: simulated time of a run, s.
            bumper: on what collides; "none" if left out. A law and its numbers: ``{"law": "foam", "travel": 0.05,
                "thickness": {"value": 60, "unit": "mm"}, ...}``.
            robot: file (TOML); left out: the robot that the FMUs were built with.
            plan: where the robot goes: ``{"kind": "straight", "speed": 0.3, ...}``; at rest if left out.
            push: external pushes, each with force (N), direction (deg), point (m), start (s), duration (s), ramp (s).
            body_region: what is hit, and its limits after ISO/TS 15066, e.g. "lower leg".
            judge_as: only its limits.
            contact_area: ``{"value": 50, "unit": "mm2"}``, for the mean pressure.
            preset: the controller's reflex; "default" if left out, or "paper".
            testbed, controller: parameters by name, ``{"slider.friction": 2.0}`` or as nested tables.
            noise_seed: of the sensors.
            seed: of the samplers.
            method: "event-exact", or "fixed-step" (7.6 times as fast).
            plant_step: of the plant with fixed steps, s; left out: as each run needs.
            part_runs: runs per stored part; left out: 5 s of work.
        """
        scenario = {
            "duration": duration,
            "bumper": bumper if bumper is None or isinstance(bumper, str) else _table(bumper),
            "robot": None if robot is None else str(robot),
            "plan": _table(plan),
            "push": None if push is None else [_table(one) for one in push],
            "body_region": body_region,
            "judge_as": judge_as,
            "contact_area": _table(contact_area),
            "preset": preset,
            "testbed": _table(testbed),
            "controller": _table(controller),
            "seed": noise_seed,
        }
        document = {"schema_version": 1, "name": name, "seed": seed, "method": method}
        self.document: dict[str, Any] = document | _given(
            {"plant_step": plant_step, "part_runs": part_runs, "scenario": _given(scenario)}
        )

    def collision(
        self,
        name: str,
        *,
        speed: float,
        mass: float | None = None,
        edge: int | None = None,
        offset: float | None = None,
        point: Sequence[float] | None = None,
        direction: float | None = None,
        time: float | None = None,
        rope: bool | None = None,
        height: float | None = None,
    ) -> Study:
        """One more collision that every design goes through.

        Args:
            name: for tables; one of its own.
            speed: of the slider along its rail at the contact, m/s; 0: it stands, and the robot runs into it.
            mass: whole sliding mass, kg; not needed with a body region.
            edge, offset: side of the outline, and m from its middle towards the next corner; or
            point: (x, y) on the outline, base frame, m.
            direction: of travel, deg, world frame; left out: straight into the side.
            time: of the contact, s; 0.5 if left out.
            rope: a hanging weight pulls the slider from rest, as long as it takes.
            height: of the contact above the floor, m; with it the base can tip.
        """
        place = {"edge": edge, "offset": offset, "point": _list(point), "direction": direction, "height": height}
        keys = {"speed": speed, "mass": mass, **place, "time": time, "rope": rope}
        return self._add("collision", {"name": name, **_given(keys)})

    def vary(
        self,
        quantity: str,
        *,
        values: Sequence[float | str | bool] | None = None,
        low: float | None = None,
        high: float | None = None,
        unit: str | None = None,
        levels: int | None = None,
        scale: Literal["linear", "log"] | None = None,
        distribution: Distribution | None = None,
        mode: float | None = None,
        mean: float | None = None,
        sigma: float | None = None,
        nominal: float | str | bool | None = None,
        also: Sequence[str] | None = None,
    ) -> Study:
        """A quantity that differs between designs.

        Args:
            quantity: a parameter (``testbed.bumper.spring_rate``), ``robot.`` and a number of the robot file, "bumper",
                "temperature", or of the hit (``collision.speed``).
            values: the values themselves; or
            low, high: its range, which ``levels`` divides, or a sampler fills.
            unit: of all numbers here, such as "N/mm"; left out: the quantity's own.
            levels: how many of them.
            scale: "log": evenly in its logarithm.
            distribution: of samples: "uniform", "loguniform", "triangular" or "normal".
            mode: of a triangular one; mean, sigma: of a normal one, truncated at low and high.
            nominal: its value while another quantity varies, for "one-at-a-time".
            also: other quantities that get the same value.
        """
        numbers = {"low": low, "high": high, "mode": mode, "mean": mean, "sigma": sigma, "nominal": nominal}
        keys = {"values": _list(values), **numbers, "unit": unit, "levels": levels, "scale": scale}
        return self._add(
            "vary", {"quantity": quantity, **_given({**keys, "distribution": distribution, "also": _list(also)})}
        )

    def parts(
        self,
        name: str,
        catalogue: Path | str,
        *,
        sets: Mapping[str, str],
        count: int | None = None,
        at_most: Mapping[str, str] | None = None,
        at_least: Mapping[str, str] | None = None,
        only: Sequence[str] | None = None,
        nominal: str | None = None,
    ) -> Study:
        """A part that designs choose from a catalogue.

        Args:
            name: what is chosen: "spring".
            catalogue: CSV file with one part per line.
            sets: quantities by name, each with the column that has its value: ``{"testbed.bumper.spring_rate":
                "rate"}``; ``"rate * count"`` for equal parts side by side, ``"rate / count"`` one behind the other.
            count: how many of it are built in; 1 if left out.
            at_most, at_least: quantities that a part limits, each with the column that has its limit.
            only: names of the parts that are admitted; left out: all.
            nominal: the part while another quantity varies, for "one-at-a-time".
        """
        tables = {"sets": dict(sets), "at_most": _table(at_most), "at_least": _table(at_least)}
        keys = {"count": count, **tables, "only": _list(only), "nominal": nominal}
        return self._add("parts", {"name": name, "catalogue": str(catalogue), **_given(keys)})

    def tolerance(
        self,
        quantity: str,
        *,
        relative: float | None = None,
        absolute: float | None = None,
        unit: str | None = None,
        distribution: Distribution | Literal["lognormal"] | None = None,
        deviation: Literal["relative", "absolute"] | None = None,
        low: float | None = None,
        high: float | None = None,
        mode: float | None = None,
        mean: float | None = None,
        sigma: float | None = None,
        also: Sequence[str] | None = None,
    ) -> Study:
        """A quantity that deviates from its design, or has a distribution of its own.

        Args:
            quantity: as in `vary`.
            relative: by this share (0.3: 30 % more or less); or
            absolute: by so much, in ``unit``; or the distribution with its numbers.
            unit: of all numbers here; left out: the quantity's own.
            distribution: between the ends "uniform" (if left out), "triangular" or "normal" (the ends are 3 sigma).
            deviation: what the numbers are about: left out: the quantity itself; else its deviation.
            low, high: ends; a normal or lognormal one needs none.
            mode: of a triangular one; mean, sigma: of a normal or lognormal one.
            also: other quantities that deviate alike.
        """
        keys = {"relative": relative, "absolute": absolute, "unit": unit, "distribution": distribution}
        numbers = {"deviation": deviation, "low": low, "high": high, "mode": mode, "mean": mean, "sigma": sigma}
        return self._add("tolerance", {"quantity": quantity, **_given({**keys, **numbers, "also": _list(also)})})

    def designs(
        self,
        kind: Literal["factorial", "latin-hypercube", "sobol", "one-at-a-time", "morris", "sobol-indices", "csv"],
        *,
        count: int | None = None,
        trajectories: int | None = None,
        grid: int | None = None,
        file: Path | str | None = None,
    ) -> Study:
        """How designs are made; without it: "factorial".

        Args:
            kind: every combination of levels, a sample of ``count``, one quantity at a time, or from a file.
            count: of "latin-hypercube" and "sobol"; of "sobol-indices": times quantities + 2.
            trajectories, grid: of "morris": how many, and on how many levels (even).
            file: of "csv": a line of quantities, ``name [unit]``, then one design per line.
        """
        keys = {"count": count, "trajectories": trajectories, "grid": grid, "file": None if file is None else str(file)}
        self.document["designs"] = {"kind": kind, **_given(keys)}
        return self

    def drivetrain(self, *, load: Literal["base", "wheel"] | None = None, servo_delay: int | None = None) -> Study:
        """Show all metrics of the drivetrain: servo margins, bandwidth, resonance, inertia, smallest push.

        Args:
            load: of the linear drivetrain: the "base" in straight motion (if left out), or a lifted "wheel".
            servo_delay: ticks of 0.5 ms from encoder to torque; 0 if left out. The runs have none.
        """
        self.document["drivetrain"] = _given({"load": load, "servo_delay": servo_delay})
        return self

    def tolerances(
        self,
        *,
        samples: int | None = None,
        kind: Literal["sobol", "latin-hypercube", "corners"] | None = None,
        noise_seeds: bool | None = None,
        robot: Literal["file", "crowd"] | None = None,
    ) -> Study:
        """How tolerances are sampled.

        Args:
            samples: how many for each design; 16 if left out.
            kind: "corners": every combination of both ends.
            noise_seeds: different sensor noise in every sample.
            robot: "crowd": another robot in every sample, drawn as for `giveway crowd`; its controller keeps the file.
                "file": always the file's. If left out, "crowd", and with corners "file".
        """
        keys = {"samples": samples, "kind": kind, "noise_seeds": noise_seeds, "robot": robot}
        self.document["tolerances"] = _given(keys)
        return self

    def sure(
        self,
        *,
        probability: bool | None = None,
        method: Literal["subset", "plain"] | None = None,
        runs: int | None = None,
        designs: int | None = None,
        indices: int | None = None,
    ) -> Study:
        """How sure the recommendation is made.

        Args:
            probability: that a limit is exceeded within the tolerances; True if left out.
            method: "subset" simulation (if left out) or "plain" sampling.
            runs: at most so many samples for each design; 5000 if left out.
            designs: how many of the best; 2 if left out.
            indices: base samples of the Sobol' indices of the recommended design; 512 if left out, 0: none.
        """
        keys = {"probability": probability, "method": method, "runs": runs, "designs": designs, "indices": indices}
        self.document["sure"] = _given(keys)
        return self

    def objective(
        self,
        metric: str,
        *,
        goal: Literal["minimise", "maximise"] | None = None,
        weight: float | None = None,
        collisions: OverCollisions | None = None,
        tolerances: OverTolerances | None = None,
    ) -> Study:
        """A metric that should be small, or large with ``goal="maximise"``.

        Args:
            metric: what the batch library measures, e.g. "detection time"; also ``NAME (error)``.
            goal: "minimise" if left out.
            weight: in the ranking, 0 to 1e6; 1 if left out.
            collisions, tolerances: what counts of them; "worst" if left out.
        """
        keys = {"goal": goal, "weight": weight, "collisions": collisions, "tolerances": tolerances}
        return self._add("objective", {"metric": metric, **_given(keys)})

    def constraint(
        self,
        metric: str,
        *,
        minimum: float | Limit | None = None,
        maximum: float | Limit | None = None,
        unit: str | None = None,
        collisions: OverCollisions | None = None,
        tolerances: OverTolerances | None = None,
    ) -> Study:
        """A metric with a limit.

        Args:
            metric: as in `objective`.
            minimum, maximum: one of them, in ``unit``; or "transient limit", "lasting limit" of the body region.
            unit: left out: the metric's own.
            collisions, tolerances: what counts of them; "worst" if left out.
        """
        keys = {"minimum": minimum, "maximum": maximum, "unit": unit, "collisions": collisions}
        return self._add("constraint", {"metric": metric, **_given({**keys, "tolerances": tolerances})})

    def report(self, *, metrics: Sequence[str] | None = None, chosen: int | None = None) -> Study:
        """What else the answers show.

        Args:
            metrics: more columns of the table.
            chosen: how many of the best designs get traces, 0 to 20; 3 if left out.
        """
        self.document["report"] = _given({"metrics": _list(metrics), "chosen": chosen})
        return self

    def setup(self, folder: Path | str = ".") -> Setup:
        """Check the study; relative paths in it start at ``folder``.

        Raises:
            GivewayError: names what is wrong by its key, such as ``vary[0].low``.
        """
        from giveway.study.study_file import check

        return check(copy.deepcopy(self.document), Path(folder), self.document["name"])

    def run(
        self,
        folder: Path | str,
        *,
        threads: int | None = None,
        dask: str | None = None,
        progress: Report | bool = True,
        files: bool = True,
    ) -> Answers:
        """Run what is missing in ``folder`` and return the answers; after Ctrl-C the same call continues.

        Args:
            folder: where results are stored; made if it is not there.
            threads: native ones, 1 to 1024; None: all processors.
            dask: address of a Dask scheduler, to whose workers the runs go; "local": to ``threads`` processes here (a
                script needs its work below ``if __name__ == "__main__"``).
            progress: True: a bar on stderr at a terminal, else a line every few seconds; False: nothing; or a
                function that is called now and then with a `giveway.study.engine.Progress`.
            files: write what `giveway sweep` writes: traces of the best designs, report.html, table.csv.

        Raises:
            GivewayError: the study is wrong; nothing was run.
            FileError: the folder holds something else, is in use, or cannot be written.
            WriteError: writing failed; the parts written before are kept.
            MissingExtraError, ClusterError: ``dask`` is not installed; no worker is left.
        """
        from giveway.study.answers import load
        from giveway.study.engine import sweep
        from giveway.study.messages import showing

        setup = self.setup()
        with showing(setup.name) if progress is True else nullcontext(progress or None) as report:
            outcome = sweep(setup, folder, threads=threads, progress=report, dask=dask)
        return _written(load(folder), files and not outcome.interrupted, progress is True, threads)

    def optimise(
        self,
        folder: Path | str,
        *,
        designs: int | None = None,
        population: int | None = None,
        patience: int | None = None,
        growth: float | None = None,
        reference: Sequence[float] | None = None,
        threads: int | None = None,
        dask: str | None = None,
        progress: Report | bool = True,
        files: bool = True,
    ) -> Answers:
        """Search the best designs in ``folder`` and return the answers; after Ctrl-C the same call continues.

        Args:
            folder: where results are stored; made if it is not there.
            designs: at most so many; 2000 if left out.
            population: designs of a generation; 24 if left out.
            patience, growth: the search ends when in 10 generations the hypervolume grew by no more than 0.001 of it.
            reference: point of the hypervolume, a value of each objective; left out: from the first designs.
            threads, dask, progress, files: as in `run`.

        Raises:
            MissingExtraError: pymoo, or what ``dask`` needs, is not installed.
            GivewayError: the study is wrong; nothing was run.
            FileError: the folder holds something else, is in use, or cannot be written.
            WriteError: writing failed; the parts written before are kept.
        """
        from giveway.study.answers import load
        from giveway.study.messages import showing
        from giveway.study.optimum import optimise
        from giveway.study.search_plan import OPTIMISED
        from giveway.study.study_file import check

        keys = {"designs": designs, "population": population, "patience": patience, "growth": growth}
        options = _given({**keys, "reference": _list(reference)})
        changed = {"designs": {"kind": OPTIMISED}, "optimise": self.document.get("optimise", {}) | options}
        setup = check(copy.deepcopy({**self.document, **changed}), Path(), self.document["name"])
        with showing(setup.name) if progress is True else nullcontext(progress or None) as report:
            found = optimise(setup, folder, threads=threads, progress=report, dask=dask)
        return _written(load(folder), files and not found.outcome.interrupted, progress is True, threads)

    def _add(self, table: str, entry: dict[str, Any]) -> Study:
        self.document.setdefault(table, []).append(entry)
        return self


def _written(answers: Answers, files: bool, shown: bool, threads: int | None) -> Answers:
    """The answers, with the files that the command writes; ``shown``: with bars."""
    if files:
        from giveway.base.terminal import progress_bars
        from giveway.study.certainty import make_sure
        from giveway.study.messages import CHOSEN, REPORT, SURE, showing, write_all
        from giveway.study.sure import wanted

        if wanted(answers):
            with showing(SURE) if shown else nullcontext() as report:
                make_sure(answers, threads, report)
        with progress_bars((CHOSEN, REPORT)) if shown else nullcontext(lambda name, share: None) as progress:
            write_all(answers, progress=progress)
    return answers


def _given(keys: Mapping[str, Any]) -> dict[str, Any]:
    """Those that are not None."""
    return {key: value for key, value in keys.items() if value is not None}


def _list(values: Sequence[Any] | None) -> list[Any] | Sequence[Any] | None:
    """As a study file has it; a string is no list and stays as it is: the check refuses it."""
    if values is None or isinstance(values, str):
        return values
    return [value.item() if hasattr(value, "item") else value for value in values]  # of an array, too


def _table(keys: Keys | None) -> dict[str, Any] | None:
    return None if keys is None else {key: _list(v) if isinstance(v, tuple) else v for key, v in keys.items()}
