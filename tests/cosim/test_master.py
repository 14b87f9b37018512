"""The master: same bits for both FMI versions and every repetition, documented order, clean ends."""

from __future__ import annotations

import dataclasses
import signal
import tempfile
import threading
from pathlib import Path

import giveway
import numpy as np
import pytest
from cosim_helpers import short
from giveway.base import native
from giveway.base.errors import FileError, GivewayError, SimulationError
from giveway.robot.variables import table
from giveway.simulation.fmu import _unpack, open_fmu
from giveway.simulation.master import simulate
from giveway.simulation.result import Result
from numpy.typing import NDArray


def same_bits(first: Result, second: Result) -> bool:
    return all(
        first.traces[name].values.tobytes() == second.traces[name].values.tobytes() for name in first.traces.data_vars
    )


def test_fmi_2_and_fmi_3_give_the_same_bits(short_run: Result) -> None:
    other = giveway.run(short(fmi_version=2))
    assert set(other.traces.data_vars) == set(short_run.traces.data_vars)
    assert same_bits(short_run, other)


def test_the_seed_decides_the_noise_and_nothing_else_does(short_run: Result) -> None:
    assert same_bits(short_run, giveway.run(short()))
    other = giveway.run(short(seed=12345))
    assert not same_bits(short_run, other)
    # Before anything moves, the truth does not depend on the noise of the sensors.
    assert (other.traces["testbed.truth.rope_tension"][0] == short_run.traces["testbed.truth.rope_tension"][0]).all()


def test_sensors_of_a_step_reach_the_controller_in_that_step(short_run: Result) -> None:
    # Row k of the plant's input is what the controller made of row k: a held command moves the plant in row k + 1.
    tick = short_run.traces["controller.tick"].values
    assert (np.diff(tick) == 1).all()
    counter = short_run.traces["testbed.sensor.counter"].values
    assert (np.diff(counter[5:]) == 1).all()  # the first samples are still on the bus


def test_a_push_is_felt_and_the_robot_moves_away() -> None:
    # 60 N towards -x at the base's corner over wheel 0, for as long as the run: slider absent.
    def push(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        push = np.zeros((len(time_s), 4))
        push[(time_s >= 0.3) & (time_s < 0.5)] = (-60.0, 0.0, 0.35, 0.0)
        return push

    result = giveway.run(short(duration_s=1.5, push=push, testbed={"slider.present": False}))
    traces = result.traces
    assert traces["controller.detection.count"][-1] == 1
    assert abs(abs(float(traces["controller.detection.direction"][-1])) - np.pi) < np.radians(15.0)
    assert float(traces["testbed.truth.x"][-1]) < -0.1
    # The push is on record, and explains the detection.
    pushed = traces["time"].values[traces["testbed.push.force_x"].values == -60.0]
    assert (pushed[0], pushed[-1]) == pytest.approx((0.3, 0.499), abs=1e-9)
    assert result.metric("false detections").value == 0.0


@pytest.mark.parametrize("shape", [(3, 4), (501, 3)])
def test_a_push_of_the_wrong_shape_is_refused(shape: tuple[int, int]) -> None:
    with pytest.raises(GivewayError, match="push"):
        giveway.run(short(push=lambda _time: np.zeros(shape)))


def test_a_plan_with_nan_is_refused() -> None:
    with pytest.raises(GivewayError, match="plan"):
        giveway.run(short(plan=lambda time: np.full((len(time), 9), np.nan)))


@pytest.mark.parametrize("fmi_version", [2, 3])
def test_an_fmus_refusal_carries_its_words_and_the_time(fmi_version: int) -> None:
    with pytest.raises(SimulationError) as caught:
        giveway.run(short(fmi_version=fmi_version, testbed={"outline.count": 4}))
    assert caught.value.time_s == 0.0
    assert "outline" in str(caught.value)


def test_ctrl_c_keeps_every_row_that_was_computed() -> None:
    pressed_s: list[float] = []

    def press_once(now_s: float, _duration_s: float) -> None:
        if now_s >= 0.2 and not pressed_s:
            pressed_s.append(now_s)
            signal.raise_signal(signal.SIGINT)

    result = giveway.run(dataclasses.replace(short(), duration_s=60.0), press_once)
    assert result.interrupted
    # Progress is told after the row of its time.
    assert result.manifest["simulated_s"] == result.traces["time"].values[-1] == pressed_s[0]
    whole = giveway.run(dataclasses.replace(short(), duration_s=0.3))
    for name, trace in whole.traces.data_vars.items():
        found = result.traces[name].values
        assert trace.values[: len(found)].tobytes() == found.tobytes(), name


def test_ctrl_c_may_come_at_any_time() -> None:
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    started = threading.Event()

    def progress(_now_s: float, _duration_s: float) -> None:
        if not started.is_set():
            started.set()
            timer.start()

    result = giveway.run(dataclasses.replace(short(), duration_s=60.0), progress)
    timer.join()
    assert result.interrupted
    assert 0.0 < result.traces["time"].values[-1] == result.manifest["simulated_s"] < 60.0


def test_ctrl_c_that_is_ignored_from_the_start_stays_ignored() -> None:
    """As the shell has it for what runs in the background of a script, and nohup wants it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # until the end of the test
    result = giveway.run(short(), lambda _now_s, _duration_s: signal.raise_signal(signal.SIGINT))
    assert not result.interrupted
    assert result.manifest["simulated_s"] == 0.5


def test_progress_reports_up_to_the_end() -> None:
    seen: list[tuple[float, float]] = []
    giveway.run(short(), lambda now_s, duration_s: seen.append((now_s, duration_s)))
    assert seen[-1] == (pytest.approx(0.5), 0.5)
    assert [now for now, _ in seen] == sorted(now for now, _ in seen)


def test_an_fmu_is_unpacked_once_per_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    _unpack.cache_clear()
    simulate(short())
    unpacked = set(tmp_path.iterdir())
    assert len(unpacked) == 2  # controller and testbed
    simulate(short())
    assert set(tmp_path.iterdir()) == unpacked
    monkeypatch.undo()
    _unpack.cache_clear()  # the next test's are not below this one's folder


def test_an_fmu_of_another_table_is_refused() -> None:
    file = open_fmu(native.fmu("testbed", 3))
    file.check_matches(table("testbed"))
    with pytest.raises(FileError, match="another variable table"):
        file.check_matches(table("controller"))


def test_a_file_that_is_no_fmu_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.fmu"
    path.write_bytes(b"PK but not really")
    with pytest.raises(FileError, match="not a usable FMU"):
        open_fmu(path)
    with pytest.raises(FileError, match="cannot be read"):
        open_fmu(tmp_path / "absent.fmu")


def test_a_profiled_run_gives_the_same_bits(short_run: Result) -> None:
    record = simulate(short(), profile=True)
    assert set(record.step_wall_s) == {"controller", "testbed"}
    assert all(0.0 < wall <= record.wall_s for wall in record.step_wall_s.values())
    for name, values in record.traces.items():
        assert values.tobytes() == short_run.traces[name].values.tobytes()
