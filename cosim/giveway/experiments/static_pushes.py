"""Static pushes on the unpowered robot (Kim, Llado, Sentis 2016, 5.1).

The weight of 1 kg pushes the robot, whose gears hold it; position, direction and magnitude are estimated from the
torque sensors alone. The paper did this four times. Here it is done on many robots with different rollers, so that the
paper's four pushes can be compared with a distribution. Then each robot's three presliding stiffnesses are identified
from three known pushes (`giveway.identification.presliding`), and the controller with these stiffnesses is judged on
other placements and other noise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from giveway.experiments import Experiment
from giveway.experiments.reproduction.findings import Effort, Findings, Row, Target

if TYPE_CHECKING:
    from giveway.experiments.static_push_study.statics import Statics
    from giveway.experiments.static_push_study.study import Study
    from giveway.experiments.static_push_study.trials import Readings

BAND = Target(5.0, 95.0, "5 to 95")  # outside: fewer than one group of four in ten is as extreme
MEAN, TAIL = "mean", "95th percentile"
# Errors of the calibrated controller: quantity, unit, largest mean and largest 95th percentile.
COMPENSATED = (("magnitude", "%", 5.0, 12.0), ("direction", "deg", 2.0, 5.0), ("location", "cm", 1.0, 3.0))
STRONGEST = 1  # its column among the paper's numbers
STATIC_SEED = 53
SCATTERS = tuple(0.02 * step for step in range(5, 101))
DRIFTS_NM = tuple(0.005 * step for step in range(1, 61))


def reproduce(effort: Effort) -> Findings:
    """5.1's numbers beside their distribution over groups of four pushes, and the errors left after calibration."""
    from giveway.experiments.figures.static_pushes import pictures
    from giveway.experiments.static_push_study.placements import default_outline
    from giveway.experiments.static_push_study.statics import Statics
    from giveway.experiments.static_push_study.study import Sizes, run_study

    statics = Statics(default_outline(), effort.pick(2000, 300), STATIC_SEED)
    drift_nm = _drift_needed(statics)
    sizes = Sizes(robots=effort.pick(120, 4), pushes=effort.pick(12, 4), threads=effort.threads)
    study = run_study(sizes, drift_nm, effort.progress)
    rows = [*_group_rows(study, statics), *_compensated_rows(study)]
    return Findings(rows, pictures(study), _notes(study))


def _group_rows(study: Study, statics: Statics) -> list[Row]:
    """The paper's six numbers against random groups of four pushes on one robot, and its four placements."""
    import numpy as np

    from giveway.experiments.static_push_study.groups import PRINTED, group_values, percentile_of

    groups, placed = group_values(study.random), group_values(study.paper)
    rows = []
    for column, printed in enumerate(PRINTED):
        name, unit = printed.name, printed.unit
        percentile = percentile_of(printed.value, groups[:, column])
        reason = "" if BAND.met(percentile) else _reason(column, study, statics)
        rows += [
            Row(f"{name}, median", float(np.median(groups[:, column])), unit, "assumed"),
            Row(f"{name}, as in Fig. 9, median", float(np.median(placed[:, column])), unit, "assumed"),
            Row(
                f"{name}: percentile of the paper's {printed.text}",
                percentile,
                "% of groups",
                "assumed",
                printed,
                BAND,
                reason,
            ),
        ]
    missing = 100.0 * float(np.mean(~study.random.on_outline))
    rows.append(Row("pushes whose zero-moment line misses the outline", missing, "%", "assumed"))
    return rows


def _reason(column: int, study: Study, statics: Statics) -> str:
    """The parameter values for which the paper's number in ``column`` would be a typical one."""
    from giveway.experiments.static_push_study.groups import PRINTED, group_values, percentile_of
    from giveway.experiments.static_push_study.robots import SCATTER, presliding_stiffness_n_per_m
    from giveway.experiments.static_push_study.statics import first_reaching

    paper = PRINTED[column].value
    drifted = percentile_of(paper, group_values(study.drifted)[:, column])
    drift = f"torque zeros that drift by {study.drift_nm:g} N m after the tare put it at {drifted:.0f} %"
    if PRINTED[column].unit == "cm":  # a location needs the outline, which the static model lacks
        return drift

    def place(scatter: float) -> float:
        magnitude, direction = statics.feel(presliding_stiffness_n_per_m(), scatter)
        values = (magnitude.min(1), magnitude.max(1), direction.max(1), direction.mean(1))[column]
        return percentile_of(paper, values)

    scatter = first_reaching(SCATTERS, lambda scatter: BAND.met(place(scatter)))
    if scatter is None:
        return f"no scatter of the presliding stiffness up to {SCATTERS[-1]:g} brings it into the band; {drift}"
    if scatter <= SCATTER:
        return f"at the edge of the band: the static model on {statics.groups} robots puts it at {place(SCATTER):.0f} %"
    return f"the presliding stiffness would have to scatter by {scatter:.2f} instead of {SCATTER:g}; {drift}"


def _drift_needed(statics: Statics) -> float:
    """The least drift of the torque zeros (N m) for which the paper's strongest push, 10 N, is in the band."""
    from giveway.experiments.static_push_study.groups import PRINTED, percentile_of
    from giveway.experiments.static_push_study.robots import SCATTER, presliding_stiffness_n_per_m
    from giveway.experiments.static_push_study.statics import first_reaching

    def reached(drift_nm: float) -> bool:
        magnitude, _ = statics.feel(presliding_stiffness_n_per_m(), SCATTER, drift_nm)
        return BAND.met(percentile_of(PRINTED[STRONGEST].value, magnitude.max(1)))

    found = first_reaching(DRIFTS_NM, reached)
    return DRIFTS_NM[-1] if found is None else found


def _errors(readings: Readings) -> dict[str, tuple[float, float]]:
    """Mean and 95th percentile of the absolute errors, by quantity of `COMPENSATED`."""
    import numpy as np

    errors = {
        "magnitude": np.abs(readings.magnitude_error_percent),
        "direction": np.abs(readings.direction_error_deg),
        "location": readings.location_error_cm,
    }
    return {name: (float(values.mean()), float(np.quantile(values, 0.95))) for name, values in errors.items()}


def _compensated_rows(study: Study) -> list[Row]:
    """Errors of the calibrated controller on placements, loads and noise that were not used for the calibration."""
    import numpy as np

    from giveway.experiments.static_push_study.study import KNOWN_PUSHES

    stiffness = 100.0 * float(np.sqrt(np.mean(study.calibration_errors(KNOWN_PUSHES) ** 2)))
    rows = [Row(f"presliding stiffness from {KNOWN_PUSHES} known pushes, rms error", stiffness, "%", "assumed")]
    before, after = _errors(study.random), _errors(study.random_compensated)
    for name, unit, mean, tail in COMPENSATED:
        for index, (which, most) in enumerate(((MEAN, mean), (TAIL, tail))):
            target, ours = Target(maximum=most), after[name][index]
            rows.append(
                Row(
                    f"{name} error, compensated, {which}",
                    ours,
                    unit,
                    "assumed",
                    target=target,
                    reason="" if target.met(ours) else f"{before[name][index]:.2g} {unit} without compensation",
                    decimals=2,
                )
            )
    missing = 100.0 * float(np.mean(~study.random_compensated.on_outline))
    rows.append(Row("zero-moment line misses the outline, compensated", missing, "%", "assumed"))
    return rows


def _notes(study: Study) -> list[str]:
    """The runs, the deviations from the paper, and the changes that would remove them."""
    return [*_setting(study), *_strongest(study), *_calibration(study)]


def _setting(study: Study) -> list[str]:
    from giveway.experiments.static_push_study.robots import LOAD_SHARE, SCATTER
    from giveway.experiments.static_push_study.trials import WEIGHT_N

    return [
        f"{len(study.random.trials)} random pushes of {WEIGHT_N:g} N on {len(study.robots)} unpowered robots: anywhere "
        "on the outline, up to 30 deg from the inward normal, each with its own noise and roller loads. A roller's "
        f"presliding stiffness scatters log-normally by {SCATTER:g} about the robot file's, from wheel to wheel, "
        f"fixed per robot; earlier motion left up to {100.0 * LOAD_SHARE:.0f} % of its friction limit in each roller. "
        "Pushes whose zero-moment line misses the outline count, with the nearest outline point.",
        "The paper prints no coordinates for Fig. 9: its four placements here are on one side, at its middle and "
        "towards both corners, straight on and leaning by 20 deg to either side.",
    ]


def _strongest(study: Study) -> list[str]:
    """Why no push is felt completely, and which change would achieve it."""
    import numpy as np

    from giveway.experiments.static_push_study.groups import PAPER_FORCE_N, PRINTED, group_values, percentile_of
    from giveway.experiments.static_push_study.trials import WEIGHT_N

    groups, loaded, drifted = (group_values(found) for found in (study.random, study.loaded, study.drifted))
    column = STRONGEST
    places = ", ".join(
        f"{printed.value:g} {printed.unit} at {percentile_of(printed.value, drifted[:, index]):.0f}"
        for index, printed in enumerate(PRINTED)
    )
    return [
        f"The strongest of four pushes is felt with {np.quantile(groups[:, column], 0.95):.1f} % or more in 5 % of the "
        f"groups, and with {groups[:, column].max():.1f} % at most; the paper's best reaches 0 % of its 10 N. Without "
        f"any roller the weight of 1 kg is {100.0 * (WEIGHT_N / PAPER_FORCE_N - 1.0):.1f} %, and rollers at rest only "
        "take away from that. Rollers that earlier motion left loaded anywhere up to their friction limit raise the "
        f"{np.quantile(groups[:, column], 0.95):.1f} % to {np.quantile(loaded[:, column], 0.95):.1f} %. What does "
        f"reach 0 % are zeros of the torque signals that move by {study.drift_nm:g} N m (standard deviation) between "
        f"tare and reading. Percentiles of the paper's six numbers are then: {places}.",
    ]


def _calibration(study: Study) -> list[str]:
    import numpy as np

    from giveway.experiments.static_push_study.study import KNOWN_PUSHES

    counts = (2, KNOWN_PUSHES, 2 * KNOWN_PUSHES)
    spread = [100.0 * float(np.sqrt(np.mean(study.calibration_errors(count) ** 2))) for count in counts]
    errors = _errors(study.loaded_compensated)
    left = ", ".join(f"{errors[name][0]:.1f} / {errors[name][1]:.1f} {unit}" for name, unit, _, _ in COMPENSATED)
    return [
        f"{counts[0]}, {counts[1]} and {counts[2]} known pushes tell a robot's stiffnesses to {spread[0]:.1f}, "
        f"{spread[1]:.1f} and {spread[2]:.1f} % (rms). With locked motors the encoders do not turn: what is left after "
        "compensation is torque noise, in the reading and through the calibration.",
        "Where earlier motion left the rollers loaded anywhere up to their friction limit, some of them slip under the "
        "push, which neither tare nor encoders can tell. The compensated errors of magnitude, direction and location "
        f"are then {left} (mean / 95th percentile).",
    ]


EXPERIMENT = Experiment(
    name="static_pushes",
    summary="A weight of 1 kg pushes the unpowered robot, which says where, from which side and how hard (paper, 5.1).",
    section="5.1",
    reproduce=reproduce,
)
