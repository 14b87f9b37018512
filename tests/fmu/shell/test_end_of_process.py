"""The shipped libraries in processes that load, run and unload them twice and end, as importers do: exit code 0."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import fmpy
import pytest
from fmu_driver import BUILD, MODELS, ROOT, fmu_path

from fmu.platforms.plan import Plan, read_outputs
from fmu.platforms.runs import all_runs

HEADERS = Path(fmpy.__file__).parent / "c-code"
LAUNCHED = """
import sys
import fmpy
for path in 2 * sys.argv[1:]:
    result = fmpy.simulate_fmu(path, fmi_type="CoSimulation", stop_time=0.02, step_size=0.001, output_interval=0.001)
    assert len(result) == 21
"""
# A library that registers a function for the end of the process, and has no start files that would run it before.
LATE = """
int __cxa_atexit(void (*)(void *), void *, void *);
static void late(void *argument) {}
__attribute__((constructor)) static void start(void) { __cxa_atexit(late, 0, 0); }
"""


@pytest.fixture(scope="module")
def runner(tmp_path_factory: pytest.TempPathFactory) -> Path:
    program = tmp_path_factory.mktemp("runner") / "run_fmus"
    source = ROOT / "fmu" / "platforms" / "run_fmus.c"
    subprocess.run(["gcc", "-std=c11", f"-I{HEADERS}", source, "-o", program, "-ldl"], check=True)
    return program


def run(plan: Plan, runner: Path, folder: Path, others: tuple[str, ...] = ()) -> subprocess.CompletedProcess[str]:
    """The runner loads each library, runs the plan, unloads, looks whether the library is gone, and does it again."""
    libraries = [str(fmu.library("x86_64-linux", folder)) for fmu in plan.fmus]
    plan.write(folder / "plan", libraries, others)
    return subprocess.run([runner, folder / "plan"], capture_output=True, text=True, check=False, timeout=60)


@pytest.mark.parametrize("name", ["collision", "drivetrain", "bumper"])
def test_a_program_in_c_ends_well(name: str, runner: Path, tmp_path: Path) -> None:
    plan = all_runs(BUILD / "fmus")[name]
    done = run(plan, runner, tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    outputs = read_outputs(done.stdout, plan)  # both runs, with the same bits
    assert any(column[0] != column[-1] for column in outputs.values())


def test_code_that_runs_when_the_library_is_gone_is_seen(runner: Path, tmp_path: Path) -> None:
    (tmp_path / "late.c").write_text(LATE)
    command = ["gcc", "-shared", "-fPIC", "-nostartfiles", tmp_path / "late.c", "-o", tmp_path / "late.so"]
    subprocess.run(command, check=True)
    done = run(all_runs(BUILD / "fmus")["bumper"], runner, tmp_path, (str(tmp_path / "late.so"),))
    assert done.returncode < 0  # a signal


@pytest.mark.parametrize("model", MODELS)
def test_a_python_process_with_fmpy_ends_well(model: str) -> None:
    paths = [fmu_path(model, version) for version in (2, 3)]
    done = subprocess.run([sys.executable, "-c", LAUNCHED, *paths], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, ""), done.stderr
