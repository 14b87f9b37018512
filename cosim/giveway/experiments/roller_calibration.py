"""Roller friction from two arcs (Kim, Llado, Sentis 2016, 4.2 and Fig. 7).

Wheel 0 moves as 3/2 - 3/2 cos(2 pi f t) rad while the others stand still; then wheels 0 and 1 do so together and the
robot turns about wheel 2. The servos drive the real plant, with bristle rollers and with the paper's tanh rollers,
noise, quantisation and a zero error on every torque sensor. From encoders and torques of both arcs B_r and alpha are
fitted. The paper does not print f; with 0.1 Hz the rollers pass slowly through the bend of the tanh.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from giveway.experiments import Experiment
from giveway.experiments.reproduction.findings import Effort, Findings, Picture, Row, Target
from giveway.paper.printed import printed
from giveway.robot.presets import NO_REFLEX, PAPER
from giveway.robot.wheels import WHEELS
from giveway.scenario.arcs import REST_S, WheelArc
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    import numpy as np
    import xarray
    from numpy.typing import NDArray

    from giveway.identification.motion_log import MotionLog
    from giveway.identification.roller_friction import Calibration, FittedLog
    from giveway.robot.robot_file import Robot

SWING_RAD = 1.5
FREQUENCY_HZ = 0.1
PERIODS = 3
ARCS: Mapping[str, tuple[float, float, float]] = {
    "wheel 0 moving": (1.0, 0.0, 0.0),
    "wheels 0 and 1 moving": (1.0, 1.0, 0.0),
}
PLANTS: Mapping[str, int] = {"bristle rollers": 0, "tanh rollers": 1}
OFFSET_NM = 0.1  # sensors are off by up to this; three times their noise
RECORDED = tuple(f"testbed.sensor.{what}[{wheel}]" for what in ("torque", "encoder") for wheel in range(WHEELS))
PLATEAU = 0.9  # of the largest wheel rate: the top of the wave
ERROR = 0.05  # of a fitted friction
EDGE = 0.9  # of the plateau: where a wave counts as risen


def arc_scenario(
    name: str, plant: str, robot: Robot, seed: int, offset_nm: Sequence[float] = (0.0, 0.0, 0.0)
) -> Scenario:
    """One arc of `ARCS` with the rollers of `PLANTS`; nothing but the floor touches the robot."""
    radius, distance = float(robot.value("wheel.radius")), float(robot.value("wheel.distance"))
    return Scenario(
        name,
        REST_S + PERIODS / FREQUENCY_HZ,
        bumper="none",
        testbed={
            "slider.present": False,
            "rope.attached": False,
            "roller.model": PLANTS[plant],
            **{f"electronics.torque_offset[{wheel}]": offset for wheel, offset in enumerate(offset_nm)},
        },
        controller=NO_REFLEX,
        plan=WheelArc(ARCS[name], SWING_RAD, FREQUENCY_HZ, radius, distance),
        seed=seed,
        preset=PAPER,
    )


def log_of(name: str, table: xarray.Dataset, run: int, robot: Robot) -> MotionLog:
    """The log that the robot's own computer would have written in ``run`` of a batch that recorded `RECORDED`."""
    import numpy as np

    from giveway.identification.motion_log import MotionLog, behind_drivetrain, counts_to_rad

    columns = [table[column].values[run].astype(np.float64) for column in RECORDED]
    torque, counts = np.stack(columns[:3], axis=1), np.stack(columns[3:], axis=1)
    angle = behind_drivetrain(counts_to_rad(counts, robot), torque, robot)
    return MotionLog(name, table["time"].values, angle, torque)


def reproduce(effort: Effort) -> Findings:
    """Both arcs on both plants over several seeds: ratio of the torques, B_r and alpha with their intervals."""
    import numpy as np

    from giveway import batch
    from giveway.base import native
    from giveway.identification.roller_friction import calibrate
    from giveway.robot.robot_file import read_robot

    robot = read_robot(native.robot())
    seeds = range(1, effort.pick(6, 1) + 1)
    cases = [(plant, seed) for plant in PLANTS for seed in seeds]
    scenarios = []
    for plant, seed in cases:
        offset = np.random.default_rng(seed).uniform(-OFFSET_NM, OFFSET_NM, WHEELS).tolist()
        scenarios += [arc_scenario(arc, plant, robot, seed, offset) for arc in ARCS]
    table = batch.run_many(
        scenarios, threads=effort.threads, traces=RECORDED, progress=lambda done, of: effort.progress(0.5 * done / of)
    )
    found: dict[str, list[Calibration]] = {plant: [] for plant in PLANTS}
    for index, (plant, _) in enumerate(cases):
        logs = [log_of(arc, table, len(ARCS) * index + i, robot) for i, arc in enumerate(ARCS)]
        found[plant].append(calibrate(logs, robot))
        effort.progress(0.5 + 0.5 * (index + 1) / len(cases))
    first = found["bristle rollers"][0]
    rows = [*_wave_rows(first.logs[0]), *(row for plant in PLANTS for row in _fit_rows(plant, found[plant], robot))]
    return Findings(rows, _pictures(first), _notes(first, robot))


def _wave_rows(log: FittedLog) -> list[Row]:
    """The square waves of the first arc: plateaus against each other and against the model, and how they change."""
    measured, model = _plateaus(log, log.torque_nm), _plateaus(log, log.model_nm)
    rows = [
        Row(
            f"torque of wheel {wheel} over wheel 0, wheel 0 moving",
            measured[wheel] / measured[0],
            "1",
            "computed",
            # Kinematics gives -1/2 exactly; noise and the fit's few per cent leave 5 % of it.
            target=Target.around(-0.5, 0.025),
            decimals=3,
        )
        for wheel in (1, 2)
    ]
    rows.append(
        Row(
            "plateau of wheel 0, measured over (27)",
            measured[0] / model[0],
            "1",
            "given",
            target=Target.around(1.0, 0.05),
            decimals=3,
        )
    )
    rows.append(Row("change of sign of the wave, wheel 0", _change_s(log, measured[0]), "s", "assumed", decimals=2))
    return rows


def _plateaus(log: FittedLog, torque: NDArray[np.float64]) -> NDArray[np.float64]:
    """Half the difference of the median torques at full speed in both directions, N m, shape (3,): free of the tare."""
    import numpy as np

    rate = np.gradient(log.wheel_angle_rad[:, 0], log.time_s)
    full = PLATEAU * float(np.abs(rate[log.sound]).max())
    forth, back = log.sound & (rate > full), log.sound & (rate < -full)
    return np.asarray(0.5 * (np.median(torque[forth], axis=0) - np.median(torque[back], axis=0)))


def _change_s(log: FittedLog, plateau: float) -> float:
    """Time from leaving 90 % of one plateau of wheel 0 to reaching 90 % of the next, median over the reversals, s."""
    import numpy as np

    wave = (log.torque_nm[:, 0] - log.offset_nm[0])[log.sound] / plateau
    time = log.time_s[log.sound]
    state = np.where(wave > EDGE, 1, np.where(wave < -EDGE, -1, 0))
    on = np.flatnonzero(state)
    turns = np.flatnonzero(np.diff(state[on]))
    return float(np.median(time[on[turns + 1]] - time[on[turns]]))


def _fit_rows(plant: str, found: Sequence[Calibration], robot: Robot) -> list[Row]:
    truths = {
        "B_r": (float(robot.value("roller.coulomb_torque")), [one.coulomb_torque_nm for one in found], "N.m"),
        "alpha": (float(robot.value("roller.tanh_slope")), [one.tanh_slope_s_rad for one in found], "s/rad"),
    }
    rows: list[Row] = []
    held: list[bool] = []
    for symbol, (truth, estimates, unit) in truths.items():
        values = [estimate.value for estimate in estimates]
        held += [estimate.holds(truth) for estimate in estimates]
        error = max(abs(value / truth - 1.0) for value in values)
        width = max(estimate.half_width / truth for estimate in estimates)
        paper = printed(symbol)
        around = Target.around(paper.value, ERROR * paper.value)
        rows += [
            Row(f"{symbol}, {plant}, mean", sum(values) / len(values), unit, "given", paper, around, decimals=4),
            Row(
                f"{symbol}, {plant}, largest error of {len(values)}",
                100.0 * error,
                "%",
                "computed",
                target=Target(maximum=100.0 * ERROR),
                decimals=2,
            ),
            Row(f"{symbol}, {plant}, widest half of an interval", 100.0 * width, "%", "computed", decimals=2),
        ]
    rows.append(
        Row(
            f"intervals that hold the truth, {plant}, of {len(held)}",
            100.0 * sum(held) / len(held),
            "%",
            "computed",
            # 95 % are promised; of 12 intervals one may miss.
            target=Target(minimum=90.0),
            decimals=0,
        )
    )
    return rows


def _pictures(found: Calibration) -> list[Picture]:
    from giveway.identification.figures import residual_figure, torque_figure

    return [
        Picture(
            "torques",
            "Wheel torques of the two arcs",
            "Left as measured on bristle rollers, tare taken off; right what (27) with the fitted friction says. The "
            "model passes through zero where the bristles turn over.",
            torque_figure(found),
            [("torques, wheel 0 moving", "about square waves"), ("B_r", "0.2 N m"), ("alpha", "0.4 s/rad")],
        ),
        Picture(
            "residuals",
            "What the calibration leaves",
            "Measured minus model. Grey samples, near rest, did not take part: stiction and presliding rule there.",
            residual_figure(found),
        ),
    ]


def _notes(found: Calibration, robot: Robot) -> list[str]:
    from giveway.identification.roller_fit import RestZone

    zone = RestZone.of(robot)
    bend = 1e3 * float(robot.value("roller.radius")) / float(robot.value("roller.tanh_slope"))
    log = found.logs[0]
    change = _change_s(log, _plateaus(log, log.torque_nm)[0])
    return [
        f"The waves are square but for their edges: the tanh bends over 1/alpha, {bend:.0f} mm/s at the rim of a "
        f"roller, and the rollers take {change:.2f} s from 90 % of one plateau to 90 % of the next at {FREQUENCY_HZ:g} "
        "Hz. Close to rest the bristles first hold at their stiction and then turn over in a step, which (28) does not "
        "know.",
        f"Samples with a roller slower than {1e3 * zone.speed_mps:.0f} mm/s or within {1e3 * zone.length_m:.1f} mm of "
        "a reversal are left out; on both sides of the reversal alike, so that the lag of the bristles cancels.",
        f"The intervals count {found.blocks} blocks of {found.block_s:.1f} s: residuals near the edges are correlated.",
    ]


EXPERIMENT = Experiment(
    name="roller_calibration",
    summary="Two arcs without contact, from which the friction of the rollers is fitted (paper, 4.2).",
    section="4.2",
    reproduce=reproduce,
)
