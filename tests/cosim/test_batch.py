"""The batch library gives what the FMUs give, bit for bit, alone and among others, and ends cleanly."""

from __future__ import annotations

import ctypes
import dataclasses
import os
import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import giveway
import numpy as np
import pytest
import reference_metrics
import xarray
from batch_cases import CASES, JUDGED, UNSOLVABLE, strong_push
from cosim_helpers import short
from giveway import batch
from giveway.base import native
from giveway.base.errors import FileError, GivewayError, SimulationError, UnknownNameError
from giveway.base.gravity import GRAVITY_MPS2
from giveway.library import batch_library, recorded
from giveway.robot import variables
from giveway.scenario.body_regions import body_region
from giveway.scenario.plan import PLAN_INPUTS, PUSH_INPUTS
from giveway.simulation import metrics
from giveway.simulation.native_engine import NativeRuns
from numpy.typing import NDArray

FORCE, TICK = "testbed.truth.contact_force", "controller.detection.tick"


def bits(table: xarray.Dataset) -> dict[str, bytes]:
    """Every variable's bytes, NaN and the sign of zero included."""
    return {str(name): values.values.tobytes() for name, values in table.data_vars.items()}


@pytest.mark.parametrize("case", CASES)
def test_every_trace_has_the_bits_of_the_co_simulation(case: str) -> None:
    fmus, native_run = giveway.run(CASES[case]), giveway.run(CASES[case], engine="native")
    assert native_run.traces.identical(fmus.traces)  # names, types, labels, times
    assert bits(native_run.traces) == bits(fmus.traces)
    assert native_run.metrics == fmus.metrics
    for key in ("parameters", "parameters_set", "exchange_order", "seed", "robot"):
        assert native_run.manifest[key] == fmus.manifest[key]


def test_the_cases_differ_from_each_other() -> None:
    runs = [bits(batch.run(scenario).traces) for scenario in CASES.values()]
    assert len({tuple(sorted(run.items())) for run in runs}) == len(CASES)


def test_the_manifest_names_the_library(tmp_path: Path) -> None:
    result = batch.run(short())
    assert result.manifest["scenario"]["fmi_version"] is None
    for model in native.MODELS:
        assert result.manifest["fmus"][model]["file"] == "giveway_batch.so"
        assert result.manifest["fmus"][model]["token"]
    assert giveway.load(result.save(tmp_path / "run")).manifest == result.manifest


@pytest.mark.parametrize("case", JUDGED)
def test_metrics_are_those_of_the_reference_s_formulas(case: str) -> None:
    scenario = JUDGED[case]
    table = batch.run_many([scenario])
    result = batch.run(scenario)
    region = scenario.judged
    of_traces = (result.traces, result.manifest["parameters"])
    for metric in (*reference_metrics.collision(*of_traces), *reference_metrics.design(*of_traces, region)):
        value = float(table[metric.name][0])
        assert table[metric.name].attrs["units"] == metric.unit
        # Both follow the same definitions; sums in another order differ by some roundings. A direction error is a
        # difference of directions near 180 deg.
        near = {"rel": 1e-9, "abs": 1e-11}
        expected = np.nan if metric.value is None else metric.value
        if metric.name == "transient force share" and region is not None and region.peak_limit_n == 0.0:
            expected = np.inf  # a metric of a single run is finite or None
        assert value == pytest.approx(expected, nan_ok=True, **near), metric
        if metric.truth is not None:
            assert float(table[f"{metric.name} (true)"][0]) == pytest.approx(metric.truth, **near), metric


def all_traces() -> list[str]:
    """Every output, and the inputs that tables drive."""
    return [
        f"{model}.{variable.name}"
        for model in native.MODELS
        for variable in variables.table(model)
        if variable.causality == "output" or variable.name in (*PLAN_INPUTS, *PUSH_INPUTS)
    ]


@pytest.mark.parametrize("method", batch.METHODS)
@pytest.mark.parametrize("case", JUDGED)
def test_recorded_traces_give_the_bits_of_the_run_s_own_metrics(case: str, method: str) -> None:
    scenario = JUDGED[case]
    table = batch.run_many([scenario], method=method, traces=all_traces())
    traces = table[all_traces()].isel(run=0)
    parameters = {model: scenario.parameters(model) for model in native.MODELS}
    region = scenario.judged
    limits = (0.0, 0.0) if region is None else (region.peak_limit_n, region.lasting_limit_n)
    columns = {str(name): values.values for name, values in traces.data_vars.items()}
    values, truth = recorded.evaluate(table["time"].values, columns, parameters, limits)
    for index, metric in enumerate(batch_library.native_metrics()):
        assert values[index].tobytes() == table[metric.name].values[0].tobytes(), metric
        if metric.has_truth:
            assert truth[index].tobytes() == table[f"{metric.name} (true)"].values[0].tobytes(), metric


@pytest.mark.parametrize("rows", [1, 2, 150, 200, 300])
def test_a_run_that_ended_early_is_judged_by_what_it_has(rows: int) -> None:
    result = giveway.run(short("magnetic"))
    parameters = result.manifest["parameters"]
    traces = result.traces.isel(time=slice(0, rows))
    expected = reference_metrics.collision(traces, parameters)
    found = metrics.collision(traces, parameters)
    assert [metric.name for metric in found] == [metric.name for metric in expected]
    for one, other in zip(found, expected, strict=True):
        numbers, known = ([np.nan if v is None else v for v in (m.value, m.truth)] for m in (one, other))
        assert numbers == pytest.approx(known, nan_ok=True, rel=1e-9, abs=1e-11), one  # sums in another order
        assert one.unit == other.unit
        assert one.value is None or one.decimals == other.decimals


def test_numbers_of_a_design() -> None:
    """Which case shows what: none of these values is the same in all cases."""
    cases = ("a person", "pressed into its stop", "thrown back", "caught again", "no transient contact allowed", "tips")
    table = batch.run_many([dataclasses.replace(JUDGED[name]) for name in cases])
    numbers = {name: {str(key): values.values[run] for key, values in table.items()} for run, name in enumerate(cases)}
    person = numbers["a person"]
    assert person["transient force"] == person["peak force of the run"] > person["lasting force"] > 0.0
    region = body_region("lower leg")
    assert person["transient force share"] == pytest.approx(person["transient force"] / region.peak_limit_n)
    assert person["lasting force share"] == pytest.approx(person["lasting force"] / region.lasting_limit_n)
    assert np.isnan(numbers["tips"]["transient force share"])
    assert numbers["no transient contact allowed"]["transient force share"] == np.inf
    assert np.isnan(numbers["no transient contact allowed"]["lasting force share"])  # it ended too early
    assert numbers["pressed into its stop"]["bottoming margin"] < 0.0 < person["bottoming margin"]
    assert 0.0 < numbers["thrown back"]["rebound speed"] < numbers["thrown back"]["contact speed"]
    assert person["contacts"] == 1.0  # the plate bounces off for 20 ms before the magnet lets go: that is one contact
    assert person["peak force of the first contact"] == person["peak force of the run"]
    assert numbers["caught again"]["re-latches"] >= 1.0
    assert numbers["caught again"]["re-latch time"] > 0.0
    assert numbers["pressed into its stop"]["re-latches"] == 0.0
    # Both plants see the same hit; the one that tips lags behind the load of its wheels.
    assert 0.0 < numbers["tips"]["tip margin"] < 1.0


def test_numbers_of_what_was_otherwise() -> None:
    """Which of the cases shows what."""
    cases = ("hit twice", "a plan beyond the limits", "sensor at its end", "sensor fault", "motor at its end")
    cases += ("drives into it",)
    table = batch.run_many([JUDGED[name] for name in cases])
    numbers = {name: {str(key): values.values[run] for key, values in table.items()} for run, name in enumerate(cases)}
    twice = numbers["hit twice"]
    assert twice["contacts"] == 2.0
    assert twice["peak force of the run"] > 1.05 * twice["peak force of the first contact"] > 100.0
    fast = numbers["a plan beyond the limits"]
    # 0.8 less 0.5 m/s for 0.2 s, and what it takes to reach 0.5 m/s at 1.5 m/s2: 0.5 V t; the correction gains nothing.
    assert fast["distance from the plan"] == pytest.approx(1e3 * (0.8 * 0.2 - 0.5 * 1.5 * 0.2**2), rel=0.02)
    assert 3.0 < fast["angle from the plan"] < np.degrees(2.0 * 0.2)
    drives = numbers["drives into it"]
    assert drives["distance from the plan"] < 0.01
    assert drives["robot speed at contact"] == pytest.approx(0.22, rel=0.005)
    assert drives["contact speed"] == pytest.approx(drives["robot speed at contact"], rel=1e-3)
    assert numbers["sensor at its end"]["sensed torque share"] == 1.0
    assert numbers["sensor at its end"]["time in sensor fault"] == 0.0
    assert numbers["sensor fault"]["time in sensor fault"] > 0.0
    assert numbers["motor at its end"]["motor torque share"] == pytest.approx(1.0, abs=1e-7)  # single precision
    assert 0.0 < twice["motor torque share"] < 1.0


def test_numbers_of_the_last_row() -> None:
    result = batch.run(short())
    table = batch.run_many([short()]).isel(run=0)
    last = {name: values[-1].item() for name, values in result.traces.data_vars.items()}
    assert table["contact time"] == last["testbed.truth.first_contact_time"]
    assert table["detections"] == last["controller.detection.count"] == 1
    assert table["events"] == last["testbed.events"]
    assert table["contact at end"] == last["testbed.truth.contact"]
    assert table["latched at end"] == last["testbed.truth.latched"]
    assert table["rope taut at end"] == last["testbed.truth.rope_taut"] == 1
    impulse = np.hypot(*(last[f"testbed.truth.contact_impulse_{axis}"] for axis in "xy"))
    assert float(table["contact impulse"]) == pytest.approx(impulse, rel=1e-14)


def designs() -> list[giveway.Scenario]:
    return [
        short(("none", "spring", "magnetic")[i % 3], seed=i, testbed={"slider.mass": 5.0 + i}, duration_s=0.3)
        for i in range(12)
    ]


def test_threads_and_order_change_no_bit() -> None:
    scenarios = designs()
    alone = batch.run_many(scenarios, threads=1, traces=[FORCE, TICK])
    assert set(alone["status"].values) == {"ok"}
    assert len({float(force) for force in alone["peak force of the run"]}) == len(scenarios)
    for threads in (2, 5, 40):
        assert bits(batch.run_many(scenarios, threads=threads, traces=[FORCE, TICK])) == bits(alone)
    backwards = batch.run_many(scenarios[::-1], threads=2, traces=[FORCE, TICK])
    assert bits(backwards.isel(run=slice(None, None, -1))) == bits(alone)


def test_batches_at_the_same_time_do_not_meet() -> None:
    scenarios = designs()
    alone = bits(batch.run_many(scenarios, threads=1))
    found: list[dict[str, bytes]] = []
    callers = [threading.Thread(target=lambda: found.append(bits(batch.run_many(scenarios)))) for _ in range(3)]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert found == [alone] * 3


def test_traces_of_many_are_those_of_one() -> None:
    table = batch.run_many(designs()[:3], traces=[FORCE, TICK, "testbed.truth.contact"])
    assert table[FORCE].dims == ("run", "time")
    assert table[FORCE].attrs["units"] == "N"
    for index, scenario in enumerate(designs()[:3]):
        result = batch.run(scenario)
        for name in (FORCE, TICK, "testbed.truth.contact"):
            assert table[name][index].values.tobytes() == result.traces[name].values.tobytes()
            assert table[name].dtype == result.traces[name].dtype
    assert table["time"].values.tobytes() == result.traces["time"].values.tobytes()


def test_no_runs_make_an_empty_table() -> None:
    assert batch.run_many([]).sizes["run"] == 0


# Wrong input


def test_a_wrong_parameter_is_refused_with_the_runs_number_before_anything_runs() -> None:
    with pytest.raises(GivewayError, match=r"run 1: testbed\.slider\.mass: -1") as caught:
        batch.run_many([short(), short(testbed={"slider.mass": -1.0})])
    assert "from 0.1 to 1000 kg" in str(caught.value)
    with pytest.raises(UnknownNameError, match=r"run 0: .*did you mean slider\.mass"):
        batch.run_many([short(testbed={"slider.mas": 1.0})])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"threads": 0}, "threads: 0 is not allowed"),
        ({"threads": 1025}, "from 1 to 1024"),
        ({"traces": ["plant.truth.x"]}, "model: plant is unknown"),
        ({"traces": ["testbed.truth.contact_forc"]}, "did you mean truth.contact_force"),
        ({"traces": ["testbed.slider.mass"]}, "testbed.slider.mass is a parameter"),
    ],
)
def test_wrong_arguments_are_named(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(GivewayError, match=message):
        batch.run_many([short()], **arguments)  # type: ignore[arg-type]


def test_traces_need_one_grid() -> None:
    with pytest.raises(GivewayError, match="scenarios of one duration and step"):
        batch.run_many([short(), short(duration_s=0.4)], traces=[FORCE])
    assert batch.run_many([short(), short(duration_s=0.4)])["simulated"].values.tolist() == [0.5, 0.4]


def test_a_plan_out_of_range_is_named_with_its_row() -> None:
    def far_away(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        rows = np.zeros((len(time_s), 9))
        rows[7, 1] = 2e4
        return rows

    with pytest.raises(GivewayError, match=r"controller\.plan\.y: 20000\.0 is not allowed.*from -10000 to 10000 m"):
        batch.run(short(plan=far_away))
    wrong, right = batch.run_many([short(plan=far_away), short()])["message"].values
    assert wrong.startswith("plan, row 7: controller.plan.y = 20000 is not allowed")
    assert right == ""


def test_gravity_is_that_of_the_plant() -> None:
    plant = ctypes.CDLL(str(native.batch_library())).gwb_gravity
    plant.restype = ctypes.c_double
    assert plant() == GRAVITY_MPS2


def test_a_library_of_another_table_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    controller, text = native.variables("controller"), native.variables("testbed").read_text(encoding="utf-8")
    changed = tmp_path / "testbed.variables.toml"
    changed.write_text(text.replace('name = "slider.mass"', 'name = "slider.weight"'), encoding="utf-8")
    monkeypatch.setattr(native, "variables", lambda model: changed if model == "testbed" else controller)
    batch_library._load.cache_clear()  # as in a new process
    with pytest.raises(FileError, match=r"another variable table: testbed\.slider\.weight differs"):
        batch.run(short())


def test_a_file_that_is_no_library_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "giveway_batch.so").write_text("not a library")
    monkeypatch.setattr(native, "batch_library", lambda: tmp_path / "giveway_batch.so")
    with pytest.raises(FileError, match="cannot be loaded"):
        batch.run(short())


# Runs that fail


def test_a_failed_run_says_when_and_why_and_stops_nobody() -> None:
    failing = short(push=strong_push, testbed=UNSOLVABLE)
    refused = short(testbed={"outline.count": 4})
    table = batch.run_many([short(), failing, refused, short()], threads=2, traces=["testbed.truth.vx"])
    assert table["status"].values.tolist() == ["ok", "failed", "refused", "ok"]
    assert table["message"].values[1].startswith("testbed: ERK cannot go on at t = 0.1")
    assert "outline" in table["message"].values[2]
    ends = table["simulated"].values
    assert ends[[0, 3]].tolist() == [0.5, 0.5]
    assert 0.1 < ends[1] < 0.2
    assert ends[2] == 0.0
    # No numbers from a run that failed, but its traces up to the last good time.
    for name in ("peak force of the run", "contact speed", "energy residual", "energy residual (true)", "events"):
        assert np.isnan(table[name].values[[1, 2]]).all()
        assert np.isfinite(table[name].values[[0, 3]]).all()
    speed = table["testbed.truth.vx"].values[1]
    last = round(ends[1] / 0.001)
    assert speed[last] > 1.0
    assert (speed[last + 1 :] == 0.0).all()
    assert bits(table.isel(run=[0])) == bits(table.isel(run=[3]))


@pytest.mark.parametrize("changes", [{"push": strong_push, "testbed": UNSOLVABLE}, {"testbed": {"outline.count": 4}}])
def test_a_failure_is_raised_with_the_time_and_words_of_the_co_simulation(changes: dict[str, object]) -> None:
    errors = []
    for way in (giveway.run, batch.run):
        with pytest.raises(SimulationError) as caught:
            way(short(**changes))
        errors.append(caught.value)
    fmus, library = errors
    assert (library.field, library.time_s) == (fmus.field, fmus.time_s)
    assert str(fmus.value).endswith(str(library.value))  # the FMU adds the name of the FMI function


# Progress and cancelling


def test_progress_counts_runs_up_to_the_end() -> None:
    seen: list[tuple[int, int]] = []
    batch.run_many([short(duration_s=3.0) for _ in range(8)], threads=1, progress=lambda *state: seen.append(state))
    assert seen[-1] == (8, 8)
    assert seen == sorted(seen)


def test_progress_of_one_run_is_in_seconds() -> None:
    seen: list[tuple[float, float]] = []
    batch.run(short(duration_s=20.0), lambda now_s, duration_s: seen.append((now_s, duration_s)))
    assert seen[-1] == (pytest.approx(20.0), 20.0)
    assert len(seen) > 1
    assert [now for now, _ in seen] == sorted(now for now, _ in seen)


def interrupt_once() -> Callable[[float, float], None]:
    """A progress function that presses Ctrl-C when it is called first."""
    pressed = threading.Event()

    def progress(_done: float, _all: float) -> None:
        if not pressed.is_set():
            pressed.set()
            os.kill(os.getpid(), signal.SIGINT)

    return progress


def endless() -> giveway.Scenario:
    """Takes longer than any test may: some 20 s of computing."""
    return short(duration_s=3000.0, step_s=0.01)


def test_ctrl_c_keeps_every_row_of_a_run_that_was_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    ended: list[tuple[int, float]] = []
    execute = NativeRuns.execute

    def observed(self: NativeRuns, *arguments: Any) -> bool:
        interrupted = execute(self, *arguments)
        ended.append((int(self.results["rows"][0]), float(self.results["time_s"][0])))
        return interrupted

    monkeypatch.setattr(NativeRuns, "execute", observed)
    scenario = short(duration_s=250.0)
    result = batch.run(scenario, interrupt_once())
    ((rows, at_s),) = ended
    assert result.interrupted
    # Cancelled where the next row would have been made; all before it are there.
    assert rows > 1
    assert at_s == pytest.approx(rows * scenario.step_s, rel=1e-12)
    assert result.traces.sizes["time"] == rows
    assert result.manifest["simulated_s"] == result.traces["time"].values[-1]
    whole = batch.run(dataclasses.replace(scenario, duration_s=rows * scenario.step_s))
    for name, trace in whole.traces.data_vars.items():
        assert trace.values[:rows].tobytes() == result.traces[name].values.tobytes(), name


def test_ctrl_c_keeps_the_runs_that_are_done_and_ends_soon() -> None:
    scenarios = [short(), *(endless() for _ in range(4))]
    started = time.perf_counter()
    table = batch.run_many(scenarios, threads=2, progress=interrupt_once())
    assert time.perf_counter() - started < 10.0
    assert table.attrs["interrupted"]
    assert table["status"].values.tolist() == ["ok", *["cancelled"] * 4]
    assert table["message"].values[1].startswith("cancelled at t = ")
    assert table["message"].values[4] == "cancelled before the start"
    assert 0.0 < float(table["simulated"][1]) < 3000.0
    assert np.isnan(table["peak force of the run"].values[1:]).all()
    assert float(table["peak force of the run"][0]) == float(batch.run_many([short()])["peak force of the run"][0])


def test_an_error_in_the_progress_function_ends_the_batch() -> None:
    def broken(_done: int, _all: int) -> None:
        raise ZeroDivisionError

    started = time.perf_counter()
    with pytest.raises(ZeroDivisionError):
        batch.run_many([endless() for _ in range(4)], threads=2, progress=broken)
    assert time.perf_counter() - started < 10.0


def test_the_interpreter_is_free_while_the_library_runs() -> None:
    batch.run(short(duration_s=0.1))
    runner = threading.Thread(target=lambda: batch.run_many([short(duration_s=100.0)], threads=1))
    runner.start()
    turns = 0
    while runner.is_alive():
        time.sleep(0.001)
        turns += 1
    assert turns > 20  # a held interpreter would let this thread turn once or twice
