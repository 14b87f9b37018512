"""giveway_batch.wasm gives the bits of the native batch library, in Node and in a real browser."""

from __future__ import annotations

import base64
import dataclasses
import re
from typing import Any

import numpy as np
import pytest
from batch_cases import JUDGED, UNSOLVABLE, strong_push
from cosim_helpers import short
from giveway import batch
from giveway.base import native
from giveway.library import batch_library
from giveway.robot import variables
from giveway.scenario.plan import PLAN_INPUTS, PUSH_INPUTS
from giveway.simulation.native_engine import NativeRuns, Trace
from numpy.typing import NDArray

from web.engines import Chromium, Node, spec_of

TRACES = [
    Trace(model, variable)
    for model in native.MODELS
    for variable in variables.table(model)
    if variable.causality == "output" or variable.name in (*PLAN_INPUTS, *PUSH_INPUTS)
]
NAMES = [trace.name for trace in TRACES]
CASES = [(method, case) for method in batch.METHODS for case in JUDGED]
FAILING = {
    "a step fails": short(push=strong_push, testbed=UNSOLVABLE),
    "a model refuses": short(testbed={"outline.count": 4}),
}
# What no scenario lets through, set in the spec.
WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "parameter": ({"settings": {"testbed.slider.mass": -1.0}}, "testbed.slider.mass"),
    "integer": ({"settings": {"testbed.solver.method": 0.5}}, "testbed.solver.method"),
    "step": ({"step_s": 7.0}, "step_s"),
    "steps": ({"step_count": 0}, "step_count"),
    "limit": ({"transient_limit_n": -1.0}, "transient_limit_n"),
    "unknown": ({"settings": {"testbed.slider.weight": 1.0}}, "variable"),
    "method": ({"method": "exact"}, "method"),
    "plan": ({"plan": base64.b64encode(bytes(8 * 10)).decode()}, "plan"),
    "trace": ({"traces": ["testbed.slider.mass"]}, "testbed.slider.mass"),
}


@pytest.fixture(scope="module")
def answers() -> dict[str, Any]:
    specs = [spec_of(JUDGED[case], NAMES, method) for method, case in CASES]
    specs += [spec_of(scenario, []) for scenario in FAILING.values()]
    plain = {"step_s": 0.001, "step_count": 10}
    specs += [plain | changed for changed, _ in WRONG.values()]
    return {engine.name: engine.call("compute", specs) for engine in (Node(), Chromium())}


@pytest.fixture(params=["Node", "Chromium"])
def answer(request: pytest.FixtureRequest, answers: dict[str, Any]) -> Any:
    return answers[request.param]


def native_run(method: str, case: str) -> NativeRuns:
    scenario = JUDGED[case]
    runs = NativeRuns([scenario], [{model: scenario.parameters(model) for model in native.MODELS}], TRACES)
    lanes = None if method == "event-exact" else 1
    assert not runs.execute(batch_library.options(1, method, lanes, None), lambda _: None)
    return runs


# The solvers besides the default take every step by a power that the system's mathematics library computes.
SYSTEM_S_POWER = {("event-exact", "Adams"), ("event-exact", "BDF")}
NEAR = 1e-9  # of a signal's peak, as between platforms (fmu/README.md)


def near(found: str, expected: NDArray[Any]) -> bool:
    if found == base64_of(expected):
        return True
    values = np.frombuffer(base64.b64decode(found), expected.dtype)
    return bool(np.all(np.abs(values - expected) <= NEAR * np.max(np.abs(expected))))


def base64_of(values: Any) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()


@pytest.mark.parametrize(("method", "case"), CASES)
def test_every_metric_and_trace_has_the_native_bits(answer: Any, method: str, case: str) -> None:
    runs = native_run(method, case)
    result, metrics = runs.results[0], runs.library.metrics
    assert result["status"] == batch_library.OK
    in_worker, on_page = (answer[kind][CASES.index((method, case))] for kind in ("runs", "again"))
    if (method, case) in SYSTEM_S_POWER:
        assert [t.name for t in TRACES if not near(in_worker["traces"][t.name], runs.traces[t.name][0])] == []
        return
    traces = {trace.name: base64_of(runs.traces[trace.name][0]) for trace in TRACES}
    values = {metric.name: base64_of(result["metric"][i]) for i, metric in enumerate(metrics)}
    truths = {metric.name: base64_of(result["truth"][i]) for i, metric in enumerate(metrics) if metric.has_truth}
    assert in_worker["metrics"] == values
    assert in_worker["truths"] == truths
    assert [name for name in NAMES if in_worker["traces"][name] != traces[name]] == []
    assert in_worker["method"] == batch.METHODS[result["method"]]
    assert (in_worker["time_s"], in_worker["plant_step_s"]) == (result["time_s"], result["plant_step_s"])
    assert on_page.pop("evaluated") == {"metrics": values, "truths": truths}
    assert on_page == in_worker


def test_a_run_that_fails_throws_the_library_s_words(answer: Any) -> None:
    for index, scenario in enumerate(FAILING.values(), len(CASES)):
        runs = NativeRuns([scenario], [{model: scenario.parameters(model) for model in native.MODELS}], [])
        runs.execute(batch_library.options(1, "event-exact", None, None), lambda _: None)
        thrown = answer["runs"][index]
        assert thrown["name"] == "SimulationError"
        assert thrown["time_s"] == runs.results["time_s"][0]
        # An integrator that gives up after 10,000 tiny steps does so at a time of its own.
        numbers = re.compile(r"[\d.]+(e-\d+)? s\b")
        text = runs.results["message"][0].decode()
        assert numbers.sub("", thrown["message"]) == numbers.sub("", text) != ""


@pytest.mark.parametrize("case", WRONG)
def test_wrong_input_throws_with_field_value_and_allowed(answer: Any, case: str) -> None:
    thrown = answer["runs"][len(CASES) + len(FAILING) + list(WRONG).index(case)]
    assert thrown["name"] == "GivewayError"
    assert thrown["field"] == WRONG[case][1]
    assert thrown["allowed"]
    assert thrown["message"].startswith(f"{thrown['field']} = ")
    assert f"{thrown['value']} is not allowed: {thrown['allowed']}" in thrown["message"]


def test_the_words_are_those_of_the_native_library(answer: Any) -> None:
    scenario = short()
    runs = NativeRuns([scenario], [{"controller": {}, "testbed": {"slider.mass": -1.0}}], [])
    runs.execute(batch_library.options(1, "event-exact", None, None), lambda _: None)
    thrown = answer["runs"][len(CASES) + len(FAILING)]
    assert thrown["message"] == runs.results["message"][0].decode()


def test_variables_and_metrics_are_those_of_the_tables(answer: Any) -> None:
    expected = [
        (f"{model}.{v.name}", v.reference, v.type, v.causality)
        for model in native.MODELS
        for v in variables.table(model)
    ]
    found = [(v["name"], v["reference"], v["type"], v["causality"]) for v in answer["variables"]]
    assert sorted(found) == sorted(expected)
    library = batch_library.library()
    assert answer["metrics"] == [dataclasses.asdict(metric) for metric in library.metrics]
    assert answer["tokens"] == [library.models[model].token for model in native.MODELS]
    windows = library.windows()
    assert answer["windows"] == {name: getattr(windows, name) for name, _ in windows._fields_}


def test_two_workers_where_there_are_cores(answer: Any) -> None:
    assert answer["workers"] in (1, 2)


def test_a_run_that_waits_can_be_taken_back(answer: Any) -> None:
    assert answer["taken_back"]["name"] == "AbortError"


def test_workers_that_were_ended_say_so(answer: Any) -> None:
    assert [thrown["message"] for thrown in answer["ended"]] == ["the workers were ended"] * 2
