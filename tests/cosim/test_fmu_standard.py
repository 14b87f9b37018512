"""What the FMI 3.0 standard allows and its project's own examples use: no false fault, and an honest answer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from giveway.base.errors import FileError, GivewayError
from giveway.cli import _main
from giveway.fmu_tools.check import Severity, check_fmu
from giveway.fmu_tools.run import run_fmu
from stub_fmus import CO_SIMULATION, STRUCTURE_3, VARIABLES_3, description_3, files, pack

MANIFEST = "extra/org.example.results/fmi-ls-manifest.xml"
ATTRIBUTES = 'fmi-ls:fmi-ls-name="org.example.results" fmi-ls:fmi-ls-version="1.0" fmi-ls:fmi-ls-description="Results"'


def manifest(attributes: str = ATTRIBUTES) -> bytes:
    """With a root element and content of its own, as a layered standard is free to have."""
    space = 'xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest"'
    return f'<results {space} {attributes}><Result source="out.csv" role="reference"/></results>'.encode()


def test_a_layered_standard_has_its_own_root_element(tmp_path: Path) -> None:
    path = pack(tmp_path / "layered.fmu", files() | {MANIFEST: manifest()})
    assert [str(f) for f in check_fmu(path)] == []


def test_an_attribute_of_the_manifest_that_is_missing_is_a_note(tmp_path: Path) -> None:
    attributes = ATTRIBUTES.replace('fmi-ls:fmi-ls-description="Results"', "")
    path = pack(tmp_path / "layered.fmu", files() | {MANIFEST: manifest(attributes)})
    assert [str(f) for f in check_fmu(path)] == [
        f"note [layered standards] {MANIFEST} has no fmi-ls-description, which tools that do not know that standard "
        "would show"
    ]


def test_a_manifest_that_is_no_xml_is_a_fault(tmp_path: Path) -> None:
    path = pack(tmp_path / "layered.fmu", files() | {MANIFEST: b"<results"})
    assert [f.check for f in check_fmu(path) if f.fault] == ["XML"]


# Two clocks, an output that changes with one of them, a clock that comes out, and an output without a clock.
CLOCKED = """
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Clock name="tick" valueReference="1" causality="input" intervalVariability="constant" intervalDecimal="0.1"/>
    <Clock name="tock" valueReference="2" causality="output" intervalVariability="triggered"/>
    <Int32 name="ticks" valueReference="3" causality="output" clocks="1"/>
    <Int32 name="total" valueReference="4" causality="output"/>"""
OUTPUTS = "".join(f'<Output valueReference="{n}" dependencies="1"/>' for n in (2, 3, 4))
SCHEDULED = '<ScheduledExecution modelIdentifier="stub"/>'


def initial(*references: int) -> str:
    return OUTPUTS + "".join(f'<InitialUnknown valueReference="{n}"/>' for n in references)


@pytest.mark.parametrize("listed", [(4,), (3, 4), (2, 3, 4)])
def test_clocked_variables_may_be_initial_unknowns(listed: tuple[int, ...], tmp_path: Path) -> None:
    """FMI 3.0: all unclocked outputs with a calculated start, and clocked variables as the FMU wishes."""
    text = description_3(SCHEDULED, variables=CLOCKED, structure=initial(*listed))
    path = pack(tmp_path / "clocked.fmu", files(description=text))
    faults = [str(f) for f in check_fmu(path) if f.severity is Severity.FAULT]
    assert faults == []


def test_an_unclocked_output_has_to_be_an_initial_unknown(tmp_path: Path) -> None:
    text = description_3(SCHEDULED, variables=CLOCKED, structure=initial(3))
    path = pack(tmp_path / "clocked.fmu", files(description=text))
    faults = [str(f) for f in check_fmu(path) if f.fault]
    assert faults == ["fault [model structure] total is not among the initial unknowns"]


def test_scheduled_execution_alone_is_answered_honestly(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = description_3(SCHEDULED, variables=CLOCKED, structure=initial(4))
    path = pack(tmp_path / "clocked.fmu", files(description=text))
    assert _main(["fmu", "info", str(path)]) == 0
    assert "Scheduled Execution" in capsys.readouterr().out
    for options in ([], ["--interface", "cs"]):
        assert _main(["fmu", "run", str(path), *options, "--out", str(tmp_path / "x.csv")]) == 2
        said = capsys.readouterr().err
        assert "has Scheduled Execution alone: a scheduler of the importer activates its parts by clocks" in said


def with_experiment(tmp_path: Path, experiment: str, interface: str = CO_SIMULATION) -> Path:
    return pack(tmp_path / "long.fmu", files(description=description_3(interface, experiment)))


def test_a_long_default_experiment_is_run_in_long_steps(tmp_path: Path) -> None:
    run = run_fmu(with_experiment(tmp_path, 'startTime="0" stopTime="1e8"'))
    assert (len(run.traces), run.traces["time"][-1], run.step_s, run.note) == (501, 1e8, 2e5, "")


def test_too_many_default_steps_become_fewer_and_it_is_said(tmp_path: Path) -> None:
    run = run_fmu(with_experiment(tmp_path, 'stopTime="1e8" stepSize="1.0"'), most_steps=1000)
    # Doubled 17 times: 1e8 / 2**17 = 763 steps; the last is a shorter one.
    assert run.step_s == 2.0**17
    assert len(run.traces) == 764
    assert run.traces["time"][-1] == 1e8
    assert "steps of 131072 s, not 1 s: those would be more than 1000" in run.note


def test_what_matters_is_the_number_of_steps(tmp_path: Path) -> None:
    path = with_experiment(tmp_path, 'stopTime="1e8" stepSize="1.0"')
    with pytest.raises(GivewayError, match="at least 50 s: no more than 2000000 steps, unless --max-steps allows"):
        run_fmu(path, step_s=1.0)
    assert len(run_fmu(path, step_s=1e6).traces) == 101
    with pytest.raises(GivewayError, match="--max-steps"):
        run_fmu(path, most_steps=0)


def test_the_fixed_internal_step_is_the_default(tmp_path: Path) -> None:
    interface = CO_SIMULATION.replace("canHandleVariable", 'fixedInternalStepSize="0.25" canHandleVariable')
    run = run_fmu(with_experiment(tmp_path, 'stopTime="1.0"', interface))
    np.testing.assert_allclose(run.traces["time"], [0.0, 0.25, 0.5, 0.75, 1.0], rtol=1e-15)


def test_a_default_experiment_that_is_no_number_is_named(tmp_path: Path) -> None:
    with pytest.raises(GivewayError, match=r"stopTime in modelDescription.xml: soon is not allowed"):
        run_fmu(with_experiment(tmp_path, 'stopTime="soon"'))


def test_no_interface_is_said(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="cannot be run: it has no interface"):
        run_fmu(pack(tmp_path / "none.fmu", files(description=description_3(""))))


def test_an_alias_is_a_name(tmp_path: Path) -> None:
    variables = VARIABLES_3.replace(
        'unit="N"/>\n    <Float64 name="z"', 'unit="N"><Alias name="u"/></Float64>\n    <Float64 name="z"'
    )
    assert "Alias" in variables
    path = pack(tmp_path / "alias.fmu", files(description=description_3(variables=variables, structure=STRUCTURE_3)))
    assert "2 variables are called u" in [f.text for f in check_fmu(path) if f.fault]
