"""What a run wrote as a log gives the run's bits in a replay; and the library's calls behind it."""

from __future__ import annotations

import ctypes
import dataclasses
import json
from pathlib import Path

import giveway
import numpy as np
import pyarrow.parquet
import pytest
from cosim_helpers import Cli, short
from giveway.base.errors import GivewayError, SimulationError
from giveway.library.batch_library import MESSAGE_SIZE, SETTING, library
from giveway.library.replay import ReplayedController, controller_outputs
from giveway.replay.mapping import Wishes
from giveway.replay.play import Choice, Replay, open_log
from giveway.replay.quantities import QUANTITIES
from giveway.replay.run_log import LOG_ENDINGS, write_log
from giveway.robot.variables import table
from giveway.simulation.result import Result

EVERY = tuple(controller_outputs())


def scenarios() -> dict[str, giveway.Scenario]:
    base = short()
    return {
        "default": base,
        "start values": giveway.Scenario("resting", 0.5),
        "paper": giveway.experiment("moving").scenario("none", preset="paper"),
        "two periods per step": dataclasses.replace(base, step_s=2e-3),
        "an IMU that the controller uses": short(
            testbed={"imu.present": True}, controller={"estimator.acceleration_source": 3}
        ),
    }


@pytest.fixture(scope="module", params=list(scenarios()))
def result(request: pytest.FixtureRequest) -> Result:
    scenario = dataclasses.replace(scenarios()[request.param], duration_s=0.5)
    return giveway.run(scenario, engine="native")


def replayed(path: Path, result: Result) -> dict[str, np.ndarray]:
    source = open_log(path, Wishes(), None, "motor_angle", "torque")
    assert source.origin.parameters == result.manifest["parameters_set"]["controller"]
    choice = Choice(source.origin.parameters or {}, source.origin.step_s or 0.0)
    with Replay(source, Wishes(), choice, EVERY) as replay:
        parts = [played.outputs for played in replay.all()]
    return {name: np.concatenate([part[name] for part in parts]) for name in EVERY}


@pytest.mark.parametrize("ending", LOG_ENDINGS)
def test_a_run_replays_to_its_bits(result: Result, ending: str, tmp_path: Path) -> None:
    write_log(tmp_path / f"run{ending}", result)
    found = replayed(tmp_path / f"run{ending}", result)
    for name in EVERY:
        assert found[name].tobytes() == result.traces[f"controller.{name}"].values.tobytes(), name


def test_faults_of_the_sensors_replay_to_their_bits(tmp_path: Path) -> None:
    """Inputs as a run with bad sensors would have them: not finite, missing, stale, jumps."""
    result = giveway.run(short(), engine="native")
    traces = result.traces.copy(deep=True)
    names = {name: f"testbed.sensor.{name}" for name in ("torque[1]", "encoder[2]", "counter", "present")}
    traces[names["torque[1]"]][150:155] = [np.nan, np.inf, -np.inf, np.nan, 1e6]
    traces[names["encoder[2]"]][200:] += 2**31 - 5
    traces[names["encoder[2]"]] = traces[names["encoder[2]"]].astype(np.int32)
    traces[names["counter"]][250:270] = traces[names["counter"]][250]
    traces[names["present"]][300:305] = False
    inputs = {
        one.controller: traces[f"testbed.{one.controller}"].values
        for one in QUANTITIES.values()
        if one.controller and f"testbed.{one.controller}" in traces
    }
    inputs |= {
        one.controller: traces[f"controller.{one.controller}"].values
        for one in QUANTITIES.values()
        if one.controller and f"controller.{one.controller}" in traces
    }
    with ReplayedController(result.manifest["parameters_set"]["controller"], 1e-3, EVERY) as controller:
        expected = controller.play(inputs)
    assert {4, 5, 6, 7, 8} <= set(expected["status"].tolist())
    for ending in LOG_ENDINGS:
        write_log(tmp_path / f"run{ending}", dataclasses.replace(result, traces=traces))
        found = replayed(tmp_path / f"run{ending}", result)
        for name in EVERY:
            assert found[name].tobytes() == expected[name].tobytes(), (ending, name)


def test_the_command_replays_the_bits_of_a_run(process: Cli, tmp_path: Path) -> None:
    done = process("run", "motionless", "--engine", "native", "--duration", "0.4", "--out", "run", "--log", "run.csv")
    assert done.returncode == 0, done.stderr
    done = process("replay", "run.csv", "--out", "replay", "--every-output")
    assert done.returncode == 0, done.stderr
    assert "1 detection\n" in done.stdout
    assert "report included:" in done.stdout.splitlines()[-1]
    run, replay = (
        pyarrow.parquet.read_table(tmp_path / name) for name in ("run/traces.parquet", "replay/replay.parquet")
    )
    for name in EVERY:
        assert replay[name].to_numpy().tobytes() == run[f"controller.{name}"].to_numpy().tobytes(), name
    manifest = json.loads((tmp_path / "replay/manifest.json").read_text())
    assert manifest["detection_count"] == 1
    assert manifest["warnings"] == []
    assert "<svg" in (tmp_path / "replay/report.html").read_text()


def test_no_log_is_written_with_another_ending(cli: Cli, tmp_path: Path) -> None:
    done = cli("run", "motionless", "--engine", "native", "--out", "run", "--log", "run.txt")
    assert done.returncode == 2
    assert "--log: run.txt is not allowed; allowed: a name that ends in .csv, .parquet, .mcap" in done.stderr
    assert not list(tmp_path.iterdir())


def test_the_library_goes_on_from_call_to_call() -> None:
    result = giveway.run(short(), engine="native")
    inputs = {
        f"sensor.{name}": result.traces[f"testbed.sensor.{name}"].values
        for name in (*(f"torque[{i}]" for i in range(3)), *(f"encoder[{i}]" for i in range(3)), "counter", "present")
    }
    with ReplayedController({}, 1e-3, EVERY) as whole, ReplayedController({}, 1e-3, EVERY) as parts:
        expected = whole.play(inputs)
        pieces = [parts.play({k: v[rows] for k, v in inputs.items()}) for rows in (slice(0, 7), slice(7, None))]
        for name in EVERY:
            assert np.concatenate([piece[name] for piece in pieces]).tobytes() == expected[name].tobytes(), name


def test_the_library_refuses_what_is_no_input_of_the_controller() -> None:
    with pytest.raises(SimulationError, match=r"settings\[0\].model = 1 is not allowed: 0 \(controller\)"):
        _start(1, table("testbed")["slider.mass"].reference, 1.0, 1e-3)
    with pytest.raises(SimulationError, match="step_s = 1 is not allowed"):
        _start(0, table("controller")["controller.period"].reference, 1e-3, 1.0)
    with (
        ReplayedController({}, 1e-3, ("mode",)) as controller,
        pytest.raises(GivewayError, match=r"row 3: controller.plan.x: 1e\+300 is not allowed"),
    ):
        controller.play({"plan.x": np.array([0.0, 0.0, 0.0, 1e300])})
    with pytest.raises(SimulationError, match="each of 0, 1 and 2 exactly once"):
        ReplayedController({"geometry.wheel_slot[0]": 1}, 1e-3, ())
    assert library().replay.steps(None, None, 0, 0, None) == 2
    library().replay.finish(None)


def _start(model: int, reference: int, value: float, step_s: float) -> None:
    settings = np.array([(model, reference, value)], dtype=SETTING)
    message, handle = ctypes.create_string_buffer(MESSAGE_SIZE), ctypes.c_void_p()
    assert not library().replay.start(settings.ctypes.data, 1, step_s, ctypes.byref(handle), message)
    raise SimulationError("library", message.value.decode(), 0.0)
