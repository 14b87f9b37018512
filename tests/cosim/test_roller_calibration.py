"""The fit of the roller friction: recovers what was put in, says how sure it is, refuses what cannot tell."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.optimize
from arc_logs import ALPHA, B_R, R_W, STEP_S, Swing, arc_log, csv_lines, sine, world_torques
from cosim_helpers import Cli, folder_content
from giveway import batch
from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.experiments.roller_calibration import ARCS, RECORDED, _change_s, arc_scenario, log_of
from giveway.identification.disturbance import Limits, find_disturbance
from giveway.identification.motion_log import MotionLog
from giveway.identification.roller_fit import EVALUATIONS, Fit, RestZone, Samples, fit, half_widths, prepare
from giveway.identification.roller_friction import (
    Calibration,
    Estimate,
    FittedLog,
    UnidentifiableError,
    _force_uncertainty,
    calibrate,
)
from giveway.identification.torque_model import TorqueModel
from giveway.robot.changes import NewValue, changed_robot
from giveway.robot.robot_file import Robot, read_robot
from giveway.robot.variables import table
from giveway.scenario.approach import Approach, edge_middle, meet, outline_of
from PIL import Image
from scipy.signal import lfilter

GOOD = arc_log((1.0, 0.0, 0.0), sine(1.5, 0.1), 30.0)
# Peak speed at the rim of the moving rollers per wheel rate, wheel 0 alone: r_w / sqrt(3).
RIM_M = R_W / math.sqrt(3.0)


# What decides which samples count and what is refused; not to move with the default robot.
PINNED = {"detector.leak_motion": 3.0, "roller.presliding_stiffness": 25900.0, "roller.stribeck_speed": 0.0025}


@pytest.fixture(scope="module")
def robot_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    changes = {name: NewValue(value, "this test", "assumed") for name, value in PINNED.items()}
    path = tmp_path_factory.mktemp("robot") / "trikey.toml"
    path.write_text(changed_robot(native.robot(), changes))
    return path


@pytest.fixture(scope="module")
def robot(robot_file: Path) -> Robot:
    return read_robot(robot_file)


@pytest.fixture(scope="module")
def good(robot: Robot) -> Calibration:
    return calibrate([GOOD], robot)


def test_recovers_friction_and_tare(good: Calibration) -> None:
    assert good.coulomb_torque_nm.value == pytest.approx(B_R, rel=0.01)
    assert good.tanh_slope_s_rad.value == pytest.approx(ALPHA, rel=0.01)
    assert good.coulomb_torque_nm.holds(B_R)
    assert good.tanh_slope_s_rad.holds(ALPHA)
    # Five standard deviations of the mean of 15,000 samples of 0.03 N m.
    assert good.logs[0].offset_nm == pytest.approx([0.08, -0.05, 0.02], abs=5.0 * 0.03 / math.sqrt(15000.0))
    assert good.explained > 0.99


def test_model_and_log_agree_where_it_was_fitted(good: Calibration) -> None:
    log = good.logs[0]
    left = (log.torque_nm - log.model_nm)[log.used]
    # Noise of 0.03 N m at 500 Hz behind a Gaussian of 25 samples: 0.03/sqrt(2 sqrt(pi) 25) = 3.2 mN m.
    assert np.std(left) == pytest.approx(0.0032, rel=0.1)
    assert 0.5 < log.used.mean() < 0.95


def interval_hits(logs: Sequence[MotionLog], robot: Robot) -> tuple[int, int]:
    hits = [0, 0]
    for log in logs:
        model = TorqueModel.of(robot)
        samples = prepare(log, model, 28.0)
        found = fit([samples], [RestZone.of(robot).free(samples, model.roller_radius_m)], model)
        widths = half_widths(found)
        hits[0] += abs(found.x[0] - B_R) <= widths[0]
        hits[1] += abs(found.x[1] - ALPHA) <= widths[1]
    return hits[0], hits[1]


def correlated(log: MotionLog, seed: int, nm: float, time_s: float) -> MotionLog:
    """``log`` with correlated noise: correlation time ``time_s``, amplitude ``nm``, stronger at speed."""
    rng = np.random.default_rng(seed)
    keep = math.exp(-STEP_S / time_s)
    noise = np.zeros_like(log.torque_nm)
    new = rng.normal(0.0, nm, noise[1:].shape)
    noise[1:] = lfilter([math.sqrt(1.0 - keep**2)], [1.0, -keep], new, axis=0)
    speed = np.abs(np.gradient(log.wheel_angle_rad[:, :1], STEP_S, axis=0))
    return dataclasses.replace(log, torque_nm=log.torque_nm + noise * (0.3 + speed))


def test_intervals_hold_what_they_promise_for_correlated_uneven_noise(robot: Robot) -> None:
    """Residual part of the interval alone, 40 logs. Intervals for independent samples would be five times narrower."""
    logs = [correlated(GOOD, seed, 0.1, 0.3) for seed in range(40)]
    # Of 40 intervals of 95 % fewer than 33 hold with a probability of 0.1 %; few blocks cost some coverage, too.
    assert min(interval_hits(logs, robot)) >= 33
    assert interval_hits(logs[:3], robot) != (0, 0)


@pytest.mark.parametrize(
    ("from_noise", "from_choices"), [((0.003, 0.0), (0.004, 0.0)), ((0.0, 1.5), (0.0, 2.0)), ((0.005, 9.0), (0.0, 0.0))]
)
def test_the_uncertainty_of_the_force_is_the_widest_place_of_the_band(
    from_noise: tuple[float, float], from_choices: tuple[float, float]
) -> None:
    """Over a dense grid of rates, from rest to where tanh has long been 1; coarser points miss a tenth of a percent."""
    coulomb = Estimate(0.02, from_noise[0], from_choices[0])
    slope = Estimate(5.0, from_noise[1], from_choices[1])
    half = [math.hypot(noise, choice) for noise, choice in zip(from_noise, from_choices, strict=True)]
    rate = np.linspace(0.0, 40.0, 200_001)
    band = 0.5 * 0.02 * (np.tanh((5.0 + half[1]) * rate) - np.tanh(max(0.0, 5.0 - half[1]) * rate))
    assert _force_uncertainty(coulomb, slope) == pytest.approx(np.hypot(half[0], band).max(), rel=1e-3)


def test_the_force_is_uncertain_without_end_where_an_estimate_is() -> None:
    sure, unsure = Estimate(0.02, 0.001, 0.0), Estimate(5.0, math.inf, 0.0)
    assert _force_uncertainty(sure, unsure) == math.inf
    assert _force_uncertainty(unsure, sure) == math.inf


def test_two_logs_have_their_own_tares(robot: Robot) -> None:
    other = arc_log((1.0, 1.0, 0.0), sine(1.5, 0.1), 20.0, offset_nm=(-0.3, 0.2, 0.1), name="other.csv")
    both = calibrate([GOOD, other], robot)
    assert both.logs[1].offset_nm == pytest.approx([-0.3, 0.2, 0.1], abs=0.005)
    assert both.tanh_slope_s_rad.holds(ALPHA)
    assert [log.name for log in both.logs] == ["arc.csv", "other.csv"]


def pushed(log: MotionLog, rows: slice, torque_nm: Sequence[float]) -> MotionLog:
    torque = log.torque_nm.copy()
    torque[rows] += torque_nm
    return dataclasses.replace(log, torque_nm=torque)


def part(log: MotionLog, rows: slice, name: str) -> MotionLog:
    return MotionLog(name, log.time_s[rows], log.wheel_angle_rad[rows], log.torque_nm[rows])


# From 8 s on, 1 and 9 s of a hand that turns the robot; a blow of 0.1 s; 1 s of half a newton, which may pass.
@pytest.mark.parametrize(
    ("rows", "torque_nm", "until_s"),
    [
        (slice(4000, 4500), (1.5, 1.5, 1.5), 9.0),
        (slice(4000, 8500), (1.5, 1.5, 1.5), 17.0),
        (slice(4000, 4050), (4.0, -4.0, 0.0), 8.1),
        (slice(4000, 4500), (0.05, -0.05, 0.0), None),
    ],
)
def test_a_log_in_which_something_was_hit_is_refused_with_the_time(
    rows: slice, torque_nm: tuple[float, float, float], until_s: float | None, robot: Robot
) -> None:
    touched = pushed(GOOD, rows, torque_nm)
    other = arc_log((1.0, 1.0, 0.0), sine(1.5, 0.1), 20.0, name="other.csv")
    if until_s is None:
        calibrate([other, touched], robot)
        return
    with pytest.raises(UnidentifiableError, match=r"^arc\.csv: from .* something touched the robot") as refusal:
        calibrate([other, touched], robot)
    begin, end = (float(number) for number in re.findall(r"from ([\d.]+) to ([\d.]+) s", str(refusal.value))[0])
    # The low-pass (0.05 s) smears each end by some 0.1 s; times are told to 0.1 s.
    assert (begin, end) == pytest.approx((8.0, until_s), abs=0.15)
    if until_s < 10.0:  # what is left serves as well
        left = [part(touched, slice(0, 3900), "before.csv"), part(touched, slice(rows.stop + 100, None), "after.csv")]
        assert calibrate(left, robot).coulomb_torque_nm.holds(B_R)


def test_a_hit_of_the_testbeds_robot_is_found(robot: Robot) -> None:
    """A slider of 9 kg at 0.3 m/s, 8 s into the first arc of 4.2; the same drive without it is free motion."""
    arc = next(iter(ARCS))
    free = arc_scenario(arc, "bristle rollers", robot, seed=1)
    everything = {v.name: v.start for v in table("testbed").select("parameter") if v.start is not None}
    testbed = {**everything, **free.testbed, "bumper.kind": 0}
    point = edge_middle(outline_of(testbed), 0)
    tare_s = 0.1  # then the plan's clock starts
    hit = meet(Approach(point, 0.3, time_s=8.0), testbed, free.plan, tare_s)
    runs = batch.run_many([free, dataclasses.replace(free, testbed={**free.testbed, **hit})], traces=RECORDED)
    assert calibrate([log_of("free.csv", runs, 0, robot)], robot).explained > 0.9
    with pytest.raises(UnidentifiableError, match=r"^hit\.csv: from (7\.9|8\.0) to"):
        calibrate([log_of("hit.csv", runs, 1, robot)], robot)


def test_the_same_log_twice_is_refused(robot: Robot) -> None:
    with pytest.raises(UnidentifiableError, match=r"arc\.csv: is given twice"):
        calibrate([GOOD, GOOD], robot)
    later = dataclasses.replace(GOOD, name="later.csv", time_s=GOOD.time_s + 60.0)
    with pytest.raises(UnidentifiableError, match=r"later\.csv: has the same content as arc\.csv"):
        calibrate([GOOD, later], robot)


def with_friction(law: Callable[[np.ndarray], np.ndarray]) -> MotionLog:
    """`GOOD` with rollers of another law."""
    torque, _ = world_torques(GOOD.wheel_angle_rad, STEP_S, law)
    return dataclasses.replace(GOOD, torque_nm=torque + np.random.default_rng(1).normal(0.0, 0.03, torque.shape))


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (
            lambda rate: B_R * np.tanh(20.0 * rate),
            ("does not grow with the speed: 0.2 N m", "roller.coulomb_torque to 0.2"),
        ),
        (lambda rate: B_R * np.tanh(20.0 * rate) * np.exp(-np.abs(rate) / 5.0), ("falls with the speed",)),
        (lambda rate: 0.0 * rate, ("does not show", "0.0032 N m of noise")),
        (lambda rate: 0.02 * rate, ("too slow", "grows with the speed", "B_r alpha = 0.02 N m s/rad")),
    ],
)
def test_rollers_of_another_law_are_refused_for_what_they_are(
    law: Callable[[np.ndarray], np.ndarray], words: Sequence[str], robot: Robot
) -> None:
    with pytest.raises(UnidentifiableError) as refusal:
        calibrate([with_friction(law)], robot)
    for word in words:
        assert word in str(refusal.value)


def test_uneven_sampling(robot: Robot) -> None:
    rng = np.random.default_rng(4)
    keep = np.sort(rng.choice(len(GOOD.time_s), len(GOOD.time_s) // 2, replace=False))
    thinned = dataclasses.replace(
        GOOD,
        time_s=GOOD.time_s[keep],
        wheel_angle_rad=GOOD.wheel_angle_rad[keep],
        torque_nm=GOOD.torque_nm[keep],
    )
    assert calibrate([thinned], robot).tanh_slope_s_rad.value == pytest.approx(ALPHA, rel=0.02)


def zigzag(rims_mps: Sequence[float], period_s: float) -> Swing:
    """Forth and back at constant speeds, one after the other."""

    def swing(t: np.ndarray) -> np.ndarray:
        speed = np.array(rims_mps)[(t / period_s).astype(int) % len(rims_mps)] / RIM_M
        forth = np.where((t / period_s) % 1.0 < 0.5, 1.0, -1.0)
        return np.cumsum(speed * forth) * STEP_S

    return swing


def negated(log: MotionLog) -> MotionLog:
    return dataclasses.replace(log, torque_nm=-log.torque_nm)


ARC = (1.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("log", "words"),
    [
        (lambda: arc_log(ARC, lambda t: 0.0 * t, 10.0), "never get away from rest"),
        (lambda: arc_log((1.0, 1.0, 1.0), sine(3.0, 0.2), 10.0), "spins on the spot"),
        # 18 mm/s at the rim at most: alpha times the rate is 0.76.
        (lambda: arc_log(ARC, sine(0.018 / RIM_M / (2.0 * math.pi * 0.05), 0.05), 40.0, noise_nm=1.0), "too slow"),
        (lambda: arc_log(ARC, zigzag((0.1, 0.25), 4.0), 32.0, noise_nm=0.3), "never slow"),
        (lambda: arc_log(ARC, zigzag((0.1, 0.1), 4.0), 32.0), "one speed only"),
        (lambda: arc_log(ARC, lambda t: 2.0 * t + 0.8 * np.sin(t), 30.0, noise_nm=0.3), "one way only"),
        (lambda: arc_log(ARC, sine(0.5, 0.5), 4.0), "5 numbers need 10 ("),
        (lambda: arc_log(ARC, sine(1.5, 0.1), 20.0, noise_nm=8.0), "too noisy ("),
        (lambda: dataclasses.replace(GOOD, torque_nm=4.0 * np.roll(GOOD.torque_nm, 1250, axis=0)), "explains"),
        (lambda: arc_log(ARC, sine(1.5, 0.1), 0.3), "too short"),
        (lambda: negated(GOOD), "signs of angles and torques"),
        (lambda: dataclasses.replace(GOOD, torque_nm=GOOD.torque_nm[:, [1, 2, 0]]), "order of the wheels"),
        (lambda: dataclasses.replace(GOOD, torque_nm=GOOD.torque_nm * [1.0, 0.0, 1.0]), "torque_1 never changes"),
        (lambda: dataclasses.replace(GOOD, torque_nm=GOOD.torque_nm + 40.0), "sensor's limit of 28 N m"),
        (lambda: dataclasses.replace(GOOD, time_s=GOOD.time_s * 100.0), "at most 0.05 s"),
    ],
)
def test_refuses_what_cannot_tell(log: Callable[[], MotionLog], words: str, robot: Robot) -> None:
    with pytest.raises(GivewayError, match=r"arc\.csv") as refusal:
        calibrate([log()], robot)
    assert words in str(refusal.value)


def test_a_refused_log_counts_beside_a_good_one(robot: Robot) -> None:
    slow = arc_log(ARC, sine(1.5, 0.1), 4.0, name="short.csv")
    with pytest.raises(UnidentifiableError):
        calibrate([slow], robot)
    assert calibrate([GOOD, slow], robot).tanh_slope_s_rad.holds(ALPHA)


def test_a_fit_that_stands_still_ends(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    """With tolerances that no step can meet, as where a parameter is not determined."""
    solve, taken = scipy.optimize.least_squares, []

    def never_content(*arguments: Any, **options: Any) -> Any:
        found = solve(*arguments, **{**options, "ftol": None, "xtol": None, "gtol": 2.3e-16})
        taken.append(found.nfev)
        return found

    monkeypatch.setattr(scipy.optimize, "least_squares", never_content)
    assert calibrate([GOOD], robot).tanh_slope_s_rad.holds(ALPHA)
    assert max(taken) == EVALUATIONS


def test_saturated_samples_do_not_take_part(robot: Robot) -> None:
    torque = GOOD.torque_nm.copy()
    torque[3000:3500] = 28.0
    found = calibrate([dataclasses.replace(GOOD, torque_nm=torque)], robot)
    log = found.logs[0]
    near = np.abs(log.time_s - 3250 * STEP_S) < 0.6
    assert not log.used[near].any()
    assert found.coulomb_torque_nm.value == pytest.approx(B_R, rel=0.01)


# The command


@pytest.fixture
def log_file(tmp_path: Path) -> Path:
    path = tmp_path / "drive.csv"
    path.write_text("\n".join(csv_lines(GOOD)))
    return path


def test_an_unknown_shipped_robot_is_named(cli: Cli, log_file: Path, tmp_path: Path) -> None:
    done = cli("calibrate", "drive.csv", "--robot", "triky", "--out", "new/mine.toml")
    assert done.returncode == 2
    assert "--robot: triky is unknown; allowed: delivery" in done.stderr
    assert not (tmp_path / "new").exists()


def test_command_writes_robot_file_and_picture(
    cli: Cli, tmp_path: Path, log_file: Path, robot_file: Path, good: Calibration
) -> None:
    done = cli("calibrate", "drive.csv", "--robot", str(robot_file), "--out", "new/mine.toml")
    assert (done.returncode, done.stderr) == (0, "")
    assert "B_r" in done.stdout
    assert folder_content(tmp_path / "new") == ["mine.png", "mine.toml"]
    new = read_robot(tmp_path / "new" / "mine.toml")
    # 5 digits are written; the log's own text has 9.
    assert new.value("roller.coulomb_torque") == pytest.approx(good.coulomb_torque_nm.value, rel=1e-4)
    assert new.value("roller.tanh_slope") == pytest.approx(good.tanh_slope_s_rad.value, rel=1e-4)
    text = (tmp_path / "new" / "mine.toml").read_text()
    for words in ("drive.csv (sha256 ", "95 % interval", 'provenance = "fitted"', "# --- Wheels and rollers"):
        assert words in text
    with Image.open(tmp_path / "new" / "mine.png") as picture:
        assert len(picture.convert("RGB").getcolors(1 << 24) or []) > 50  # something is drawn


def test_new_robot_file_runs(process: Cli, log_file: Path, robot_file: Path) -> None:
    process("calibrate", "drive.csv", "--robot", str(robot_file), "--out", "mine.toml")
    done = process("run", "motionless", "--robot", "mine.toml", "--duration", "0.05", "--out", "run")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("drive.csv", "--out", "new.txt"), "ends with .toml"),
        (("none.csv", "--out", "new.toml"), "none.csv: no such file"),
        (("drive.csv", "slow.csv", "--out", "new.toml"), "slow.csv: line 1: there is no column"),
        (("still.csv", "--out", "new.toml"), "never get away from rest"),
        (("drive.csv", "--out", "folder/new.toml"), "is not a file"),
        (("--out", "new.toml"), "Missing argument"),
    ],
)
def test_command_refuses_and_writes_nothing(
    cli: Cli, tmp_path: Path, log_file: Path, robot_file: Path, arguments: tuple[str, ...], words: str
) -> None:
    still = dataclasses.replace(GOOD, wheel_angle_rad=0.0 * GOOD.wheel_angle_rad)
    (tmp_path / "still.csv").write_text("\n".join(csv_lines(still)))
    (tmp_path / "slow.csv").write_text("a,b\n1,2\n")
    (tmp_path / "folder" / "new.toml").mkdir(parents=True)
    before = folder_content(tmp_path)
    done = cli("calibrate", *arguments, "--robot", str(robot_file))
    assert done.returncode == 2
    assert words in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert folder_content(tmp_path) == before


def test_command_keeps_the_old_robot_file(cli: Cli, tmp_path: Path, log_file: Path) -> None:
    (tmp_path / "robot.toml").write_text(native.robot().read_text())
    done = cli("calibrate", "drive.csv", "--robot", "robot.toml", "--out", "./robot.toml")
    assert done.returncode == 2
    assert "another file" in done.stderr
    assert (tmp_path / "robot.toml").read_text() == native.robot().read_text()


def test_blocks_are_as_long_as_the_noise_hangs_together(robot: Robot) -> None:
    """Three correlation times of 2 x 0.3 s; white noise hangs together through the smoothing, 0.05 s, alone."""
    model = TorqueModel.of(robot)
    lengths = []
    for log in (GOOD, correlated(GOOD, 1, 0.1, 0.3)):
        samples = prepare(log, model, 28.0)
        lengths.append(fit([samples], [RestZone.of(robot).free(samples, model.roller_radius_m)], model).block_s)
    assert lengths[0] == pytest.approx(3.0 * 2.0 * math.sqrt(math.pi) * 0.05, rel=0.5)
    assert lengths[1] == pytest.approx(3.0 * 2.0 * 0.3, rel=0.5)


@pytest.mark.parametrize("last", [149, 199])
def test_a_disturbance_lasts_from_its_first_to_its_last_sample(last: int, robot: Robot) -> None:
    """Also one at the end of the log: nothing comes after it."""
    count, step_s = 200, 0.05
    zeros, torque = np.zeros((count, 3)), np.zeros((count, 3))
    torque[120 : last + 1] = (1.5, 1.5, 1.5)
    sound = np.ones(count, dtype=bool)
    samples = Samples(step_s * np.arange(count), zeros, torque, zeros, zeros, zeros, sound)
    nothing = Fit(np.zeros(5), np.zeros((1, 5)), np.zeros((5, 5)), 1, 1.0, 0.0)
    limits = Limits(leak_n=3.0, impulse_newton_s=0.5)
    found = find_disturbance([samples], [sound], nothing, TorqueModel.of(robot), limits)
    assert found is not None
    assert (found.begin_s, found.end_s) == (step_s * 120, step_s * last)


@pytest.mark.parametrize("offsets_nm", [(0.0, 0.0, 0.0), (0.5, 0.0, -0.5)])
def test_the_change_of_plateaus_is_that_of_wheel_0_without_its_tare(offsets_nm: tuple[float, float, float]) -> None:
    """A wave of 1 N m that takes 0.2 s from 0.9 to -0.9 and back, over a tare that differs from wheel to wheel."""
    time_s = 0.01 * np.arange(1000)
    phase = np.mod(time_s, 4.0)
    wave = np.clip((np.abs(phase - 2.0) - 1.0) * 9.0, -1.0, 1.0)  # 1.8 of the way at 9 per second
    zeros, every = np.zeros((1000, 3)), np.ones(1000, dtype=bool)
    torque = np.stack([wave, zeros[:, 0], zeros[:, 0]], axis=1) + offsets_nm
    log = FittedLog("log", time_s, zeros, torque, zeros, torque, every, every, np.array(offsets_nm))
    # To two samples: each end is one of them.
    assert _change_s(log, 1.0) == pytest.approx(0.2, abs=0.021)
