"""`giveway.run` over both engines: the FMUs and the batch library give the same result."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import giveway
import pytest
from cosim_helpers import Cli, short
from giveway.base.errors import UnknownNameError
from giveway.simulation.result import Result
from giveway.simulation.runner import Engine
from giveway.study import engine
from giveway.study.chosen import scenario_of_run, simulate

EXAMPLES = Path(__file__).parents[2] / "examples"


def assert_same(one: Result, other: Result) -> None:
    """Traces bit for bit, and everything that is made of them."""
    assert one.traces.identical(other.traces)  # names, types, labels, times
    for name, trace in one.traces.data_vars.items():
        assert trace.values.tobytes() == other.traces[name].values.tobytes(), name
    assert (one.metrics, one.pushes, one.warnings) == (other.metrics, other.pushes, other.warnings)
    assert one.judgement == other.judgement
    assert one.manifest["parameters"] == other.manifest["parameters"]


@pytest.mark.parametrize("fmi_version", [2, 3])
def test_a_collision(fmi_version: int) -> None:
    scenario = dataclasses.replace(short("magnetic", judge_as="lower leg"), fmi_version=fmi_version)
    fmus, native = giveway.run(scenario), giveway.run(scenario, engine="native")
    assert_same(fmus, native)
    assert (fmus.manifest["scenario"]["fmi_version"], native.manifest["scenario"]["fmi_version"]) == (fmi_version, None)


def test_pushes() -> None:
    scenario = giveway.read_scenario(EXAMPLES / "pushed_on_a_circle.toml")
    scenario = dataclasses.replace(scenario, duration_s=8.0)
    fmus = giveway.run(scenario, engine="fmu")
    assert fmus.pushes
    assert_same(fmus, giveway.run(scenario, engine="native"))


def test_the_traced_design_of_a_study(tmp_path: Path) -> None:
    study = giveway.Study("traced", duration=0.4, bumper="magnetic")
    study.collision("front", speed=0.5, mass=9.08, edge=0, time=0.12)
    study.vary("testbed.bumper.latch_force", values=[0.0, 40.0]).objective("peak force of the run").designs("factorial")
    setup = study.setup()
    table = engine.plan_runs(setup)
    traced = simulate(setup, table, tmp_path, design=1)["front"]
    assert_same(giveway.run(scenario_of_run(setup, table, design=1)), traced)


def test_another_engine_is_refused_naming_both() -> None:
    with pytest.raises(UnknownNameError, match=r"engine.*nativ.*fmu, native|engine.*nativ.*'native'"):
        giveway.run(short(), engine="nativ")  # type: ignore[arg-type]


@pytest.mark.parametrize("chosen", ["fmu", "native"])
def test_progress_ends_with_the_run(chosen: Engine) -> None:
    seen: list[tuple[float, float]] = []
    giveway.run(short(duration_s=0.3), lambda now_s, end_s: seen.append((now_s, end_s)), engine=chosen)
    assert seen[-1] == pytest.approx((0.3, 0.3))


def test_the_command_line_has_both(cli: Cli, tmp_path: Path) -> None:
    for name in ("fmu", "native"):
        cli("run", "motionless", "--duration", "0.3", "--engine", name, "--out", name)
    results = {name: giveway.load(tmp_path / name) for name in ("fmu", "native")}
    assert_same(results["fmu"], results["native"])
    assert results["native"].manifest["fmus"]["testbed"]["file"] == "giveway_batch.so"
    assert results["fmu"].manifest["fmus"]["testbed"]["file"] == "giveway_testbed_fmi3.fmu"


def test_the_command_line_refuses_another(cli: Cli, tmp_path: Path) -> None:
    done = cli("run", "motionless", "--engine", "fast", "--out", "run")
    assert done.returncode == 2
    assert done.stderr == "giveway: --engine: fast is unknown; allowed: fmu, native\n"
    assert not (tmp_path / "run").exists()
