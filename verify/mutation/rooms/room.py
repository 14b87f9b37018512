"""The rooms outside c_core, and the tests that have to see faults in each."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "CPP",
    "LEFT_OUT",
    "PLAIN_PROGRAMS",
    "PROGRAMS",
    "PYTHON",
    "PYTHON_PATH",
    "ROOMS",
    "SLOW_TESTS",
    "TARGETS",
    "TESTS",
    "Room",
]


@dataclass(frozen=True)
class Room:
    """``sample``: how many of its mutants `make mutate` tries; `make verify` tries the first ``few`` of them."""

    folder: str
    sample: int
    few: int = 5


CPP = (
    Room("fmu/math", 25),
    Room("fmu/plant", 40),
    Room("fmu/models", 35),
    Room("fmu/solver", 25),
    Room("fmu/batch", 35),
    Room("fmu/shell", 35),
)
PYTHON = (Room("cosim/giveway", 115, few=10),)  # fmu/codegen runs in the build: its mutants would need one each
ROOMS = (*CPP, *PYTHON)
PYTHON_PATH = ("cosim",)
# Figures: people have to judge how they look.
LEFT_OUT = (
    *("cosim/giveway/report", "cosim/giveway/experiments/figures", "cosim/giveway/experiments/reproduction/page.py"),
    *("cosim/giveway/drivetrain/pictures.py", "cosim/giveway/identification/figures.py"),
    *("cosim/giveway/study/figures.py", "cosim/giveway/study/gallery.py"),
)

# GoogleTest programs, and other targets that the Python tests use.
PROGRAMS = (
    *("tests/fmu/math/math_test", "tests/fmu/scalar/strict_scalar_test", "tests/fmu/scalar/jacobian_test"),
    *("tests/fmu/scalar/lanes_test", "tests/fmu/solver/solver_test", "tests/fmu/testbed/testbed_test"),
    *("tests/fmu/controller/test_controller_fmu", "tests/fmu/instances/instances_controller_test"),
    *("tests/fmu/instances/instances_testbed_test", "tests/fmu/instances/instances_drivetrain_test"),
    "tests/fmu/instances/instances_bumper_test",
)
PLAIN_PROGRAMS = ("tests/fmu/batch/batch_test",)  # one test each
LIBRARIES = ("c_master", "fmus", "giveway_batch", "giveway_plant_probe", "fmu_lag")
TARGETS = (*(program.rsplit("/", 1)[1] for program in (*PROGRAMS, *PLAIN_PROGRAMS)), *LIBRARIES)
TESTS = ("tests/fmu", "tests/cosim")
# Whole experiments, compilers, other processes: run only on mutants that the other tests do not see.
SLOW_TESTS = (
    *("test_bench_solvers.py", "test_c_master.py", "test_experiment_circle.py", "test_experiment_clamping.py"),
    *("test_experiment_impulse_share.py", "test_experiment_roller_calibration.py", "test_experiment_scenes.py"),
    *("test_experiment_static_pushes.py", "test_failures.py", "test_fitting.py", "test_fmu_hostile.py"),
    *("test_fmu_run.py", "test_interrupt.py", "test_progress.py", "test_readme.py", "test_report.py"),
    *("test_reproduction.py", "test_source_fmu.py", "test_ssp.py", "test_study_command.py", "test_study_gallery.py"),
    *("test_study_runs.py", "test_frequency_response.py", "test_wrong_input.py"),
)
