"""`giveway crowd curves`: each detector against a form of its own, the counting, the figure's labels, the command."""

from __future__ import annotations

import csv
import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from figure_labels import Curve as DrawnCurve
from figure_labels import band, check_panels, check_planted, curve
from giveway.base import native
from giveway.cli import _main as cli_main
from giveway.crowd.curves import curve as curve_module
from giveway.crowd.curves import cusum, figure, glr, kalman, matched_filter, noise, work
from giveway.crowd.curves.alarms import LOCKED, alarms, delay_ms
from giveway.crowd.curves.candidates import CANDIDATES, FULL, IMPULSE, OURS, RESIDUAL, scaled
from giveway.crowd.curves.curve import at_level, curves, usable
from giveway.crowd.curves.recorded import RESIDUAL_TRACES, record
from giveway.crowd.curves.situations import MOTION, REST, SITUATIONS, STARTING, situations
from giveway.crowd.drive import Drive, Leg
from giveway.crowd.endurance import drive
from giveway.crowd.population import start_value
from giveway.crowd.statistics import rate_interval
from numpy.typing import NDArray
from scipy.signal import lfilter
from scipy.stats import chi2

STEP_S = 1e-3
WHITE = noise.Noise((1.0, 1.0, 1.0), ((1.0, *[0.0] * noise.ORDER),) * 3)


def white(*shape: int) -> NDArray[np.float64]:
    return np.random.default_rng(1).standard_normal(shape)


def test_cumulative_sums_of_a_known_sequence() -> None:
    assert cusum.page(np.array([1.0, -2.0, 3.0, 1.0, -1.0, -9.0, 0.5])).tolist() == [1, 0, 3, 4, 3, 0, 0.5]
    samples = white(3, 500)
    samples[:2, 300:] += 0.8
    angles = [2.0 * math.pi * n / 8 for n in range(8)]
    largest = [0.0] * 500
    for u in [(math.cos(a), math.sin(a), 0.0) for a in angles] + [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]:
        g = 0.0
        for k in range(500):
            g = max(0.0, g + cusum.CHANGE * (float(np.dot(u, samples[:, k])) - 0.5 * cusum.CHANGE))
            largest[k] = max(largest[k], g)
    assert cusum.CHANGE * cusum.statistic(samples) == pytest.approx(largest, abs=1e-9)


def test_a_matched_filter_on_white_noise_alarms_as_often_as_theory_says() -> None:
    signature = WHITE.signature(matched_filter.courses()[1])
    ticks = signature.shape[-1]
    squares = matched_filter.correlated(white(40, 3, 20_000), signature)[:, ticks - 1 :: ticks].ravel()  # independent
    for probability in (0.1, 0.01, 0.001):
        found = float(np.mean(squares > chi2.isf(probability, 3)))
        # Five standard deviations of a count.
        assert found == pytest.approx(probability, abs=5.0 * math.sqrt(probability / len(squares)))


def test_a_matched_filter_gathers_all_of_its_course() -> None:
    signature = WHITE.signature(matched_filter.courses()[2])
    samples = np.zeros((3, 300))
    samples[:, 100 : 100 + signature.shape[-1]] = 2.0 * signature
    found = matched_filter.correlated(samples, signature)
    assert int(np.argmax(found)) == 100 + signature.shape[-1] - 1
    assert float(found.max()) == pytest.approx(4.0 * float((signature**2).sum()))
    assert float(matched_filter.statistic(samples, WHITE).max()) >= math.sqrt(float(found.max())) - 1e-9


def test_the_likelihood_ratio_is_that_of_least_squares() -> None:
    samples = white(3, 300)
    samples[0, 150:] += 3.0
    row, most = 180, 0.0
    for age_s in glr.AGES_S:
        ticks = round(age_s / STEP_S)
        # A step through the estimator and the high-pass, tick by tick.
        keep, slow = math.exp(-200.0 * STEP_S), math.exp(-STEP_S / 0.3)
        step, first, second, before, passed = [], 0.0, 0.0, 0.0, 0.0
        for _ in range(ticks):
            first += (1.0 - keep) * (1.0 - first)
            second += (1.0 - keep) * (first - second)
            passed, before = slow * passed + second - before, second
            step.append(passed)
        gain = 0.0
        for component in samples[:, row - ticks + 1 : row + 1]:
            (size,), (left,) = np.linalg.lstsq(np.array(step)[:, None], component, rcond=None)[:2]
            assert math.isfinite(size)
            gain += float(component @ component) - float(left)
        most = max(most, gain)
    assert float(glr.statistic(samples, WHITE)[row]) == pytest.approx(math.sqrt(most), rel=1e-9)


def test_the_observer_is_the_kalman_filter_of_the_displacement() -> None:
    wandering, variance = 1.0e5, 1e-10
    h = STEP_S
    a = np.array([[1.0, h, h * h / 2.0], [0.0, 1.0, h], [0.0, 0.0, 1.0]])
    c = np.array([1.0, 0.0, 0.0])
    spread = np.diag([1e-6, 1e-2, 1e4])
    for _ in range(3000):  # Riccati's recursion, until it stands
        spread = a @ spread @ a.T + np.diag([0.0, 0.0, wandering * h])
        gain = spread @ c / (c @ spread @ c + variance)
        spread = spread - np.outer(gain, c @ spread)
    time_s = h * np.arange(600)
    force = 30.0 * np.sin(math.pi * np.clip((time_s - 0.2) / 0.15, 0.0, 1.0))
    true, state, felt, displacement = np.zeros(3), np.zeros(3), [], []
    for value in force:
        true = np.array([*(a @ [true[0], true[1], value])[:2], 0.0])
        displacement.append(true[0])
        state = a @ state
        state = state + gain * (true[0] - state[0])
        felt.append(state[2])
    residual = np.diff(displacement, 2, prepend=[0.0, 0.0]) / h**2
    poles = kalman.observer_poles(wandering, variance)
    denominator = np.real(np.poly(poles))
    found = lfilter([denominator.sum()], denominator, residual)
    assert np.abs(poles).max() < 1.0
    # Second differences come half a tick late, the recursion's zeros shift it by up to one more: 30 N sin over 150 ms
    # changes by 0.6 N in a tick.
    assert found == pytest.approx(np.array(felt), abs=1.0)
    assert max(felt) > 20.0


def test_whitening_recovers_a_known_process() -> None:
    series = lfilter([1.0], [1.0, -1.2, 0.5], 3.0 * white(3, 60_000), axis=-1)
    found = noise.learned([series[:, :30_000], series[:, 30_000:]])
    for row in found.whitening:
        # Over the innovation's 3; a coefficient's standard deviation is about 1 / sqrt(60,000).
        assert 3.0 * np.array(row[:4]) == pytest.approx([1.0, -1.2, 0.5, 0.0], abs=0.03)
    flat = found.whitened(series)
    assert flat.var(axis=-1) == pytest.approx(1.0, abs=0.03)
    for lag in (1, 2, 5):
        assert np.abs(np.mean(flat[:, lag:] * flat[:, :-lag], axis=-1)).max() < 0.03


def test_the_high_pass_forgets_and_takes_a_new_zero() -> None:
    step = np.ones((3, 900))
    passed = noise.high_passed(step)
    assert passed[0, 300] == pytest.approx(math.exp(-1.0))
    again = noise.restarted(passed, [400])
    assert again[:, :400] == pytest.approx(passed[:, :400])
    # What was there on average in the 0.1 s before is gone, and what remains decays as before.
    mean = passed[0, 300:400].mean()
    assert again[0, 400:] == pytest.approx(passed[0, 400:] - mean * np.exp(-np.arange(500) / 300.0))


def test_situations_of_a_drive() -> None:
    leg = Leg(1.0, 0.2, 0.5, cruise_s=2.0)
    time_s = np.arange(0.0, 6.0, STEP_S)
    plan = Drive((leg,))(time_s)
    found = situations(np.hypot(plan[:, 3], plan[:, 4]), 0.24 * plan[:, 5], STEP_S)
    # The ramp's last degrees change so little that they count as constant: 20 ms at most.
    for at_s, where in (
        (0.0, REST),
        (1.1, STARTING),
        (leg.cruise_from_s + 0.1, STARTING),
        (leg.cruise_from_s + 0.21, MOTION),
        (leg.cruise_to_s - 0.01, MOTION),
        (leg.cruise_to_s + 0.05, STARTING),
        (leg.end_s + 0.2, STARTING),
        (leg.end_s + 0.31, REST),
    ):
        assert found[round(at_s / STEP_S)] == where, at_s


def test_alarms_have_a_lock_out_and_delays_a_deadline() -> None:
    statistic = np.zeros(1000)
    for row in (0, 100, 350, 700, 701):
        statistic[row] = 2.0
    statistic[800:] = 2.0
    assert alarms(statistic, 1.0, STEP_S).tolist() == [0, 350, 700]
    assert alarms(statistic, 2.0, STEP_S).tolist() == []
    rows = np.array([100, 350, 700])
    assert delay_ms(rows, STEP_S, 0.65, 0.9) == pytest.approx(50.0)  # the last alarm was just 0.3 s ago
    assert delay_ms(rows, STEP_S, 0.6605, 0.9) == pytest.approx(39.5)
    assert delay_ms(rows, STEP_S, 0.66, 0.69) == math.inf
    assert delay_ms(rows, STEP_S, 0.5, 0.9) == LOCKED


def test_rates_have_exact_intervals() -> None:
    rate, low, high = rate_interval(3, 2.0)
    assert (rate, low, high) == pytest.approx((1.5, chi2.ppf(0.025, 6) / 4.0, chi2.ppf(0.975, 8) / 4.0))
    assert rate_interval(0, 2.0) == pytest.approx((0.0, 0.0, -math.log(0.05) / 2.0))


def records() -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Of 40 hits in each situation and 2 h in each: larger thresholds, longer delays, fewer alarms."""
    quiet, hits = [], []
    for number in range(20):
        per_threshold = {
            one.name: [[max(8 - index, 0) * (number % 2)] * len(SITUATIONS) for index in range(len(one.thresholds))]
            for one in CANDIDATES
        }
        seconds = {one.name: [[360.0] * len(SITUATIONS)] * len(one.thresholds) for one in CANDIDATES}
        quiet.append({"number": number, "message": "", "alarms": per_threshold, "seconds": seconds})
    for number in range(120):
        delays: dict[str, list[float | None]] = {
            one.name: [10.0 + index + 0.1 * number + place for index in range(len(one.thresholds))]
            for place, one in enumerate(CANDIDATES)
        }
        delays[OURS.name][-1] = None if number < 12 else delays[OURS.name][-1]
        delays[OURS.name][0] = LOCKED if number < 6 else delays[OURS.name][0]
        hits.append({"start_s": 1.0, "where": number % 3, "stated": number % 2 == 0, "delays": delays, "message": ""})
    return hits, quiet


def test_points_count_and_the_table_takes_the_smallest_threshold() -> None:
    hits, quiet = records()
    found = list(curves(hits, quiet))
    assert len(found) == len(SITUATIONS) * len(CANDIDATES)
    (ours,) = [one for one in found if one.candidate is OURS and one.situation == "at rest"]
    assert [point.alarms for point in ours.points] == [80, 70, 60, 50, 40]
    assert [point.hits for point in ours.points] == [38, 40, 40, 40, 40]
    assert [point.locked for point in ours.points] == [2, 0, 0, 0, 0]
    assert [point.missed for point in ours.points] == [0, 0, 0, 0, 4]
    assert ours.points[0].per_hour == pytest.approx(rate_interval(80, 2.0))
    last = ours.points[-1]
    assert last.median_ms is not None
    assert last.p95_ms is not None
    assert last.p95_ms[0] == math.inf  # a tenth is missed
    assert at_level(ours, 30.0) is ours.points[2]
    assert at_level(ours, 10.0) is None
    glr_curve = found[5]
    assert glr_curve.candidate.name == "GLR"
    assert [point.alarms for point in usable(glr_curve)] == [80, 70, 60, 50, 40, 30, 20, 10, 0]
    quietest = at_level(glr_curve, 0.0)
    assert quietest is glr_curve.points[8]
    stated = next(curves(hits, quiet, stated=True))
    assert len(stated.points) == len(CANDIDATES[0].thresholds)
    assert stated.points[0].hits == 20
    rows = curve_module.table_rows([ours])
    assert rows[0][1].endswith("at 0.6")
    assert rows[0][2:] == ("-", "-", "-", "-")


def test_what_alarms_more_at_a_larger_threshold_is_not_drawn() -> None:
    hits, quiet = records()
    for record_ in quiet:
        record_["alarms"]["GLR"][0] = [0, 0, 0]  # always above: it never comes back
    shown = usable(list(curves(hits, quiet))[5])
    assert [point.alarms for point in shown] == [70, 60, 50, 40, 30, 20, 10, 0]


def wanted(found: list[curve_module.Curve], situation: str, what: str) -> list[DrawnCurve]:
    panel = []
    for one in found:
        if one.situation != situation:
            continue
        some = [point for point in usable(one) if point.alarms]
        at = [(point.median_ms if what == "median" else point.p95_ms) for point in some]
        pairs = [(p.per_hour[0], e) for p, e in zip(some, at, strict=True) if e is not None and math.isfinite(e[0])]
        rate = np.array([rate for rate, _ in pairs])
        low, mid, high = (np.array([e[i] for _, e in pairs]) for i in (1, 0, 2))
        high = np.minimum(high, figure.LONGEST_MS[what])
        panel += [curve(rate, "1/h", 1e-3 * mid, "s"), band(rate, "1/h", 1e-3 * low, 1e-3 * high, "s")]
        for point in usable(one):
            if not point.alarms:
                estimate = point.median_ms if what == "median" else point.p95_ms
                assert estimate is not None
                panel.append(curve([point.per_hour[2]], "1/h", [1e-3 * estimate[0]], "s"))
    return panel


def test_the_figure_s_labels_say_what_it_draws() -> None:
    hits, quiet = records()
    found = list(curves(hits, quiet))
    drawn = figure.draw("Delay", found)
    panels = [wanted(found, situation, what) for what in ("median", "p95") for situation in SITUATIONS]
    check_planted(drawn, lambda: check_panels(drawn, panels))
    assert "95 % bound" in drawn.legends[0].get_texts()[-1].get_text()


@pytest.fixture(scope="module")
def quiet_scenario() -> Any:
    return lambda controller: drive("tuning", "planar", 8, controller)[1]


def test_the_residual_s_average_is_what_the_controller_compares(quiet_scenario: Any) -> None:
    (candidate,) = [one for one in CANDIDATES if one.name == "force average"]
    assert candidate.settings is not None
    speeds = [f"controller.reference.{name}" for name in ("vx", "vy", "omega")]
    ours = record([quiet_scenario(RESIDUAL)], [*RESIDUAL_TRACES, *speeds], "fixed-step", 1, lambda _done: None)
    name = "controller.detection.statistic"
    theirs = record([quiet_scenario(candidate.settings)], (name,), "fixed-step", 1, lambda _done: None)
    wrench = ours.residual().wrench[0]
    window = round(start_value("estimator.average_window", "controller"))
    mean = lfilter(np.full(window, 1.0 / window), [1.0], wrench[:2], axis=-1)
    moving = ours.situations[0] == MOTION  # at rest another zero holds there
    assert moving.sum() > 1000
    # The outputs are floats of 32 bits, in sums of 20.
    assert theirs.traces[name][0][moving] == pytest.approx(np.hypot(*mean)[moving], abs=2e-5)
    assert not ours.failed
    # What is found in a tick belongs to the reference of the tick before.
    vx, vy, omega = (ours.traces[one][0] for one in speeds)
    of_row = situations(np.hypot(vx, vy), start_value("wheel.distance") * omega, STEP_S)
    assert (ours.situations[0][1:] == of_row[:-1]).all()
    assert (ours.situations[0] != of_row).any()


def test_all_thresholds_of_the_two_channels_are_scaled(quiet_scenario: Any) -> None:
    name = "controller.detection.statistic"
    large = [scaled(OURS, scale, {}) for scale in (5.0, 10.0)]
    both = record([quiet_scenario(own) for own in large], (name,), "fixed-step", 1, lambda _done: None)
    once, twice = both.traces[name]
    assert once.max() > 0.02
    assert once == pytest.approx(2.0 * twice, abs=1e-9)
    assert {**large[0], **FULL} == large[0]
    assert scaled(OURS, 2.0, {"channels.fast_rest": 5.0})["channels.fast_rest"] == 10.0


def test_the_command_draws_goes_on_and_refuses_what_it_cannot_do(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # Fewer runs: one textbook detector, and the two channels with their default.
    few = (CANDIDATES[5], dataclasses.replace(OURS, thresholds=(1.0,)))
    for module in (work, curve_module):
        monkeypatch.setattr(module, "CANDIDATES", few)
    monkeypatch.setattr(work, "HIT_KINDS", (0, 3))
    monkeypatch.setattr(work, "LEARNED_RUNS", 1)
    out = tmp_path / "curves"
    asked = ["crowd", "curves", "--robots", "3", "--hours", "0.008", "--threads", "1", "--out", str(out)]
    assert cli_main(asked) == 0
    assert "2 of 2 runs in" in capsys.readouterr().out
    assert {path.suffix for path in out.glob("curves.*")} == {".png", ".csv"}
    with (out / "curves.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 * len(SITUATIONS) * sum(len(one.thresholds) for one in few)
    of_all = [row for row in rows if row["hits of"] == "all" and row["detector"] == "GLR"]
    assert sum(int(row["hits"]) + int(row["locked"]) for row in of_all) == 2 * len(few[0].thresholds)
    assert cli_main(asked) == 0  # everything is there
    assert "runs in" not in capsys.readouterr().out
    for wrong, said in (
        (["--draw", "both"], "both"),
        (["--robots", "0"], "--robots"),
        (["--hours", "0"], "--hours"),
        (["--hours", "nan"], "--hours"),
        (["--threads", "0"], "--threads"),
        (["--group", "floating"], "floating"),
        (["--set", "testbed.base.mass=40"], "testbed.base.mass"),
        (["--set", "controller.no=1"], "no"),
    ):
        assert cli_main(["crowd", "curves", *wrong, "--out", str(tmp_path / "no")]) == 2, wrong
        assert said in capsys.readouterr().err
    assert not (tmp_path / "no").exists()


def test_robots_of_another_file_are_driven_hit_and_judged_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    file = native.robots()["lekiwi"]
    seen: list[tuple[Path | None, Path | None]] = []

    class Enough(Exception):
        pass

    def recorded(scenarios: Any, *_others: Any) -> None:
        seen.append((scenarios[0].robot, _others[-1]))
        raise Enough

    monkeypatch.setattr(work, "record", recorded)
    monkeypatch.setattr(work, "_model", lambda *_asked: None)
    of_file = [work.quiet_work("tuning", "planar", 0.01, {}, file), work.hits_work("tuning", "planar", 1 + 3, {}, file)]
    for one in of_file:
        with pytest.raises(Enough):
            one.compute([0], 1, lambda _done: None)
    assert seen == [(file, file), (file, file)]
    usual = work.quiet_work("tuning", "planar", 0.01, {})
    assert "robot" not in usual.asked  # what was stored before is still found
    assert usual.asked != of_file[0].asked
    # A threshold is scaled from the file's.
    name = "detector.impulse_threshold"
    assert scaled(IMPULSE, 2.0, {}, file)[name] == 2.0 * start_value(name, "controller", file)
    assert scaled(IMPULSE, 2.0, {}, file)[name] != scaled(IMPULSE, 2.0, {})[name]
