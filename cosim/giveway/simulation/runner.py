"""From a scenario to a result: run, label, judge, and record the origin."""

from __future__ import annotations

import dataclasses
import datetime
import hashlib
import importlib.metadata
import platform
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from giveway.base import native
from giveway.base.errors import UnknownNameError
from giveway.base.version import VERSION
from giveway.library.batch_library import OF_COLLISION, OF_FREE_RUN
from giveway.robot.variables import Value, table
from giveway.scenario.plan import Pushes, TimedPush
from giveway.scenario.plan_limits import check_plan_of
from giveway.simulation import master, metrics, native_engine
from giveway.simulation.master import OpenController, Progress, Record
from giveway.simulation.push_response import push_metrics, responses_of
from giveway.simulation.result import SCHEMA_VERSION, Result
from giveway.simulation.run_warnings import RunWarning, warnings_of

if TYPE_CHECKING:
    import xarray

    from giveway.scenario.scenario import Scenario

__all__ = ["ENGINES", "Engine", "judge", "run"]

_LIBRARIES = ("fmpy", "numpy", "xarray", "pyarrow")
Engine = Literal["fmu", "native"]
ENGINES: Mapping[Engine, Callable[[Scenario, Progress | None], Record]] = {
    "fmu": master.simulate,
    "native": native_engine.simulate,
}
EXCHANGE_ORDER = "sequential: sensors, controller, plant"


def run(
    scenario: Scenario,
    progress: Progress | None = None,
    engine: Engine = "fmu",
    controller: OpenController | None = None,
) -> Result:
    """Run ``scenario``; see `giveway.run`. ``controller`` takes the place of its FMU."""
    if engine not in ENGINES:
        raise UnknownNameError("engine", engine, ENGINES)
    check_plan_of(scenario)
    if controller is not None:
        return judge(scenario, master.simulate(scenario, progress, controller=controller))
    return judge(scenario, ENGINES[engine](scenario, progress))


def judge(scenario: Scenario, record: Record) -> Result:
    """``record`` with labels, metrics, warnings and manifest."""
    traces = _label(record)
    manifest = _manifest(scenario, record)
    parameters = manifest["parameters"]
    found = metrics.evaluate(traces, parameters)
    warnings: tuple[RunWarning, ...] = ()
    if not record.interrupted:  # otherwise the rest of the run is unknown
        warnings = warnings_of(scenario, tuple(found.values()))
    manifest["warnings"] = [warning.text for warning in warnings]
    felt = responses_of(traces, manifest).pushes
    pushes = tuple(push_metrics(one, traces, parameters) for one in felt)
    where = OF_COLLISION if parameters["testbed"]["slider.present"] else OF_FREE_RUN
    return Result(traces, metrics.shown(found, where), manifest, warnings, pushes)


def _stated(scenario: Scenario) -> dict[str, Any] | None:
    """The stated contact as plain data for JSON."""
    contact = scenario.contact
    if contact is None:
        return None
    point = None if contact.point_m is None else list(contact.point_m)
    return {"speed_mps": contact.speed_mps, "point_m": point, "time_s": contact.time_s}


def _begun(scenario: Scenario, record: Record) -> tuple[TimedPush, ...]:
    """The scheduled pushes that began before the run ended."""
    schedule = scenario.push.pushes if isinstance(scenario.push, Pushes) else ()
    return tuple(push for push in schedule if push.start_s < record.time_s[-1])


def _label(record: Record) -> xarray.Dataset:
    import xarray

    variables: dict[str, Any] = {}
    for model in native.MODELS:
        for variable in table(model):
            values = record.traces.get(f"{model}.{variable.name}")
            if values is not None:
                attributes = {"units": variable.unit or "1", "long_name": variable.description}
                variables[f"{model}.{variable.name}"] = ("time", values, attributes)
    time = ("time", record.time_s, {"units": "s", "long_name": "Simulated time"})
    return xarray.Dataset(variables, coords={"time": time})


def _manifest(scenario: Scenario, record: Record) -> dict[str, Any]:
    effective = {
        model: {v.name: record.parameters[model].get(v.name, v.start) for v in table(model).select("parameter")}
        for model in native.MODELS
    }
    robot = native.robot() if scenario.robot is None else Path(scenario.robot)
    return {
        "schema_version": SCHEMA_VERSION,
        "created": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "interrupted": record.interrupted,
        "simulated_s": float(record.time_s[-1]),
        "wall_s": record.wall_s,
        "scenario": {
            "name": scenario.name,
            "bumper": scenario.bumper,
            "preset": scenario.preset,
            "duration_s": scenario.duration_s,
            "step_s": scenario.step_s,
            "fmi_version": record.fmi_version,
            "plan": _describe(scenario.plan),
            "push": None if scenario.push is None else _describe(scenario.push),
            "pushes": [dataclasses.asdict(push) for push in _begun(scenario, record)],
            "body_region": scenario.body_region,
            "judge_as": scenario.judge_as,
            "contact_area_m2": scenario.contact_area_m2,
            "contact": _stated(scenario),
        },
        "robot": {"file": robot.name, "sha256": hashlib.sha256(robot.read_bytes()).hexdigest()},
        "exchange_order": EXCHANGE_ORDER,
        "seed": effective["testbed"]["electronics.seed"],
        "solver": _group(effective["testbed"], "solver."),
        "versions": {
            "giveway": VERSION,
            "python": platform.python_version(),
            **{name: importlib.metadata.version(name) for name in _LIBRARIES},
        },
        "platform": platform.platform(),
        "fmus": {
            model: {"file": file.path.name, "token": file.token, "sha256": file.sha256}
            for model, file in record.files.items()
        },
        "parameters_set": record.parameters,
        "parameters": effective,
    }


def _group(values: dict[str, Value | None], prefix: str) -> dict[str, Value | None]:
    return {name.removeprefix(prefix): value for name, value in values.items() if name.startswith(prefix)}


def _describe(function: object) -> str:
    text = repr(function)
    return text if " at 0x" not in text else getattr(function, "__qualname__", type(function).__qualname__)
