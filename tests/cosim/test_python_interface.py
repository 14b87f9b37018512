"""The Python interface as an editor and a type checker see it, and what it says to a first wrong guess."""

from __future__ import annotations

import inspect
import shutil
import subprocess
import sys
from pathlib import Path

import giveway
import numpy as np
import pytest
from giveway.base.errors import GivewayError
from giveway.study import Study, parts, search_plan, study_file, sure_plan, variations
from giveway.study.designs import OPTIONS

USER_FILE = """
from pathlib import Path

import giveway

result = giveway.run(giveway.experiment("motionless").scenario("magnetic"))
peak: float | None = result.metric("peak force of the run").value
study = giveway.Study("latch", duration=0.6, bumper="magnetic", robot=Path("robot.toml"), testbed={"base.mass": 20.0})
study.collision("front", speed=0.5, mass=9.08, edge=0, offset=0.01)
study.vary("testbed.bumper.spring_rate", low=0.4, high=3.0, unit="N/mm", levels=5)
study.vary("testbed.bumper.latch_force", values=[0.0, 40.0]).tolerance("temperature", absolute=30.0)
study.designs("sobol", count=64).tolerances(samples=4, kind="corners").report(metrics=["contact speed"], chosen=2)
study.objective("detection time", goal="minimise", weight=2.0).constraint("contact speed", maximum=0.6)
study.parts("spring", Path("springs.csv"), count=2, sets={"testbed.bumper.spring_rate": "rate * count"}, only=["a"])
answers: giveway.Answers = study.run("out/latch", threads=2, progress=False)
best: giveway.Answers = study.optimise("out/best", designs=200, reference=[90.0])
for one in answers.sensitivities():
    print(one.goal, one.quantity, one.main)
table = giveway.batch.run(giveway.read_scenario("case.toml")).traces
again = giveway.run(giveway.read_scenario("case.toml"), engine="native")
"""
WRONG_LINES = {
    'study.collision("front", sped=0.5)': "sped",
    'study.vary("bumper", low="a")': "low",
    'giveway.Study("latch", bumper="rubber", duration=1.0)': "bumper",
    'study.designs("sobool")': "designs",
    'giveway.run(giveway.read_scenario("case.toml"), engine="fast")': "engine",
    'study.objective("detection time", goal="smaller")': "goal",
    'study.parts("spring", "springs.csv", set={})': "set",
    'study.optimise("out/best", design=200)': "design",
}


def mypy(folder: Path, text: str) -> tuple[int, str]:
    (folder / "user.py").write_text(text)
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(folder / "cache"), "user.py"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600, check=False)
    return done.returncode, done.stdout + done.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With mypy's cache, so that the second question is cheap; after `make lint`, whose cache it has, the first."""
    made = tmp_path_factory.mktemp("user")
    linted = Path(__file__).parents[2] / "build" / "mypy"
    if linted.is_dir():
        shutil.copytree(linted, made / "cache")
    return made


def test_a_user_s_file_passes_the_strict_type_checker(folder: Path) -> None:
    code, said = mypy(folder, USER_FILE)
    assert code == 0, said


def test_wrong_keywords_do_not(folder: Path) -> None:
    code, said = mypy(folder, USER_FILE + "\n".join(WRONG_LINES))
    assert code == 1
    first = USER_FILE.count("\n") + 1
    for number, word in enumerate(WRONG_LINES.values(), first):
        assert any(line.startswith(f"user.py:{number}: error") and word in line for line in said.splitlines()), said


def keywords(method: object) -> set[str]:
    assert callable(method)
    return set(inspect.signature(method).parameters) - {"self"}


def test_the_keywords_are_all_keys_of_a_study_file() -> None:
    top = study_file.study_shape().keys
    assert keywords(Study.collision) == set(top["collision"].row.keys)
    assert keywords(Study.vary) == set(variations.VARY.keys)
    assert keywords(Study.parts) == set(parts.PARTS.keys)
    assert keywords(Study.optimise) == {*search_plan.OPTIMISE.keys, *keywords(Study.run)}
    assert keywords(Study.tolerance) == set(variations.TOLERANCE.keys)
    assert keywords(Study.sure) == set(sure_plan.SURE.keys)
    assert keywords(Study.designs) == {"kind", *(option for options in OPTIONS.values() for option in options)}
    goal = set(study_file._GOAL)
    assert keywords(Study.objective) == goal | {"goal", "weight"}
    assert keywords(Study.constraint) == goal | {"minimum", "maximum", "unit"}
    tables = {
        "scenario",
        "collision",
        "designs",
        "vary",
        "parts",
        "tolerances",
        "tolerance",
        "sure",
        "drivetrain",
        "objective",
        "constraint",
        "optimise",
        "report",
    }
    of_the_top = set(top) - tables - {"schema_version"}
    assert keywords(Study) == of_the_top | set(top["scenario"].keys) | {"noise_seed"}


def test_values_may_be_an_array() -> None:
    study = Study("arrays", duration=0.2, bumper="magnetic").collision("front", speed=0.5, mass=9.08, edge=0, time=0.12)
    study.vary("testbed.bumper.latch_force", values=np.linspace(0.0, 60.0, 4))  # type: ignore[arg-type]
    assert study.setup().varied[0].levels == (0.0, 20.0, 40.0, 60.0)


def test_noise_and_samplers_have_a_seed_each() -> None:
    study = Study("seeds", duration=0.2, seed=3, noise_seed=8)
    assert study.document["seed"] == 3
    assert study.setup().cases[0].scenario.seed == 8


def test_the_package_lists_what_is_meant_for_users() -> None:
    names = dir(giveway)
    for name in ("Answers", "GivewayError", "Result", "Scenario", "Study", "batch", "experiment", "load", "run"):
        assert name in names
        assert getattr(giveway, name) is not None
    for name in ("Any", "Path", "TYPE_CHECKING", "annotations", "importlib", "logging"):
        assert name not in names
    with pytest.raises(AttributeError, match="no attribute 'Studdy'"):
        giveway.Studdy  # noqa: B018


def test_importing_the_package_stays_light() -> None:
    text = "import giveway, sys; print(sorted({'numpy', 'xarray', 'matplotlib', 'scipy'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout == "[]\n"


def test_a_name_is_no_scenario_and_the_error_says_what_is() -> None:
    with pytest.raises(GivewayError) as caught:
        giveway.run("motionless")  # type: ignore[arg-type]
    message = str(caught.value)
    assert message.startswith("scenario: 'motionless' is not allowed")
    assert 'giveway.experiment("motionless").scenario("magnetic")' in message
