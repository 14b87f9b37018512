"""Frama-C Eva: from any valid configuration and any state within the invariant, with any finite input, nothing
overflows, divides by zero, leaves an array or reads what was never written, and the invariant holds again."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from verify.context import Context, Tool
from verify.rung import Figure, Rung, RungFailed, planted
from verify.targets import PORTABLE, core_sources

FRAMA_C = Tool("frama-c", ("-version",), package="frama-c-base")
# The bounds of these functions are in eva/math_contracts.h; rung `contracts` checks them on the code.
CONTRACTS = ("gw_sqrt", "gw_exp", "gw_expm1", "gw_tanh", "gw_sincos", "gw_atan2", "gw_wrap_angle", "gw_fraction")
ONLY_CALLED_BY_THOSE = {
    "atan_of_fraction",
    "atan_series",
    "cos_series",
    "exact_residual",
    "exp_series",
    "falling_expm1",
    "falling_power_of_two",
    "less_quarter_turns",
    "nearest_integer",
    "on",
    "reduced_expm1",
    "rising_power_of_two",
    "root_of",
    "short_expm1",
    "sin_series",
}
OWN = re.compile(r"(draw|hold|disturb|demand|any|part|lowest|highest|step_sums|main)(_\w+)?(_\d+)?")


@dataclass(frozen=True)
class Mutant:
    """A mutant that a driver has to refuse: a line of c_core without its guard."""

    file: str
    healthy: str
    sick: str


@dataclass(frozen=True)
class Driver:
    mutant: Mutant
    split_returns: str = ""  # calls whose outcomes are analysed separately
    states: int = 200  # states analysed separately at one point (-eva-slevel)
    finite: bool = True


DRIVERS = {
    "controller": Driver(
        Mutant(
            "gw_controller.c",
            "valid = gw_plan_limited(plan);\n    if (controller->on_plan) {",
            "valid = *plan;\n    if (controller->on_plan) {",
        ),
        "gw_controller_init:0,next_undisturbed:full",
    ),
    "bad_sensors": Driver(
        Mutant(
            "gw_supervisor.c",
            "if (!events->sensors_good) {\n                next = GW_MODE_FAULT;",
            "if (!events->sensors_good) {\n                next = GW_MODE_STOPPED;",
        ),
        "gw_sensor_check_step:full,step:full,gw_controller_step:full",
        states=300,
    ),
    "estimator": Driver(
        Mutant("gw_estimator.c", "torque_nm = gw_torques_limited(&input->torque_nm);", "torque_nm = input->torque_nm;")
    ),
    "motor": Driver(
        Mutant("gw_motor.c", "gw_limited(corrected_radps, RATE_MAX_RADPS)", "corrected_radps"),
    ),
    "filters": Driver(
        Mutant("../include/giveway/gw_rate_filter.h", "gw_limited(derivative, GW_RATE_DERIVATIVE_MAX)", "derivative")
    ),
    "follower": Driver(Mutant("gw_follower.c", "variance_n2 = gw_max(variance_n2, least_n2);", "")),
    "imu": Driver(
        Mutant(
            "gw_imu.c",
            "gw_limited(from.x + (share * (to.x - from.x)), GW_TWO * GW_IMU_SHOWN_MAX)",
            "from.x + (share * (to.x - from.x))",
        )
    ),
    "kinematics": Driver(
        Mutant("gw_kinematics.c", "GW_ONE / config->wheel_radius_m", "GW_ONE / (config->wheel_radius_m - GW_HALF)")
    ),
    "contact": Driver(
        Mutant(
            "gw_contact.c",
            "gw_fraction_inline(-start_side_m, end_side_m - start_side_m)",
            "-start_side_m / (end_side_m - start_side_m)",
        ),
        "gw_contact_init:0",
    ),
    "detector": Driver(Mutant("gw_detector.c", "output->mean_wrench = gw_wrench_limited(output->mean_wrench);", "")),
    "channels": Driver(
        Mutant("../include/giveway/gw_math.h", "return gw_limited(moved, limit);", "return moved;"),
    ),
    "admittance": Driver(
        Mutant("gw_admittance.c", "output->velocity_mps = limit_components(output->velocity_mps, SPEED_MAX);", "")
    ),
    "reference": Driver(
        Mutant(
            "gw_reference.c",
            "gw_sum_limit(gw_sum_add(reference->x_m, reference->displacement.x_m), REFERENCE_MAX)",
            "gw_sum_add(reference->x_m, reference->displacement.x_m)",
        ),
        "gw_reference_init:0",
    ),
    "joint": Driver(Mutant("gw_joint.c", "gw_wrap_angle(angle_rad->wheel[i])", "angle_rad->wheel[i]")),
    "sensor_check": Driver(
        Mutant("gw_sensor_check.c", "check->age_ticks < check->config.stale_ticks_max", "check->age_ticks < UINT32_MAX")
    ),
    "nonfinite": Driver(
        Mutant("gw_sensor_check.c", "status = GW_STATUS_SENSOR_NONFINITE;", "status = GW_STATUS_OK;"), finite=False
    ),
    "supervisor": Driver(
        Mutant("gw_supervisor.c", "(supervisor->path_ticks + 1U) & GW_TICK_MASK", "(supervisor->path_ticks + 1U)"),
        "next_undisturbed:full",
    ),
    "servo": Driver(Mutant("gw_servo.c", "gw_clamp(wanted, -limit, limit)", "wanted")),
    "math": Driver(Mutant("gw_math.c", "if (length > limit) {", "if (length >= GW_ZERO) {")),
}


def check(context: Context) -> Figure:
    reached: dict[str, float] = {}
    functions: set[str] = set()
    for name, driver in DRIVERS.items():
        log = _proved(context, name, driver, context.core)
        functions |= set(_defined(log))
        for function, share in _shares(log):
            reached[function] = max(reached.get(function, 0.0), share)
    functions -= {*CONTRACTS, *ONLY_CALLED_BY_THOSE}
    missed = sorted(f"{name}: {reached.get(name, 0.0):.1%}" for name in functions if reached.get(name, 0.0) < 1.0)
    if missed:
        raise RungFailed("\n".join(["statements that no driver reaches, of", *missed]))
    for name, driver in DRIVERS.items():
        _check_mutant(context, name, driver)
    return Figure(
        f"0 alarms in {len(DRIVERS)} proofs, every statement of {len(functions)} functions reached; "
        f"{len(DRIVERS)} mutants raise alarms",
        {"proofs": len(DRIVERS), "functions": len(functions), "alarms": 0, "mutants": len(DRIVERS)},
    )


def _proved(context: Context, name: str, driver: Driver, core: Path) -> str:
    """Eva's output; `RungFailed` with all alarms if there are any."""
    folder = context.root / "verify" / "eva"
    answer = context.run(
        context.which(FRAMA_C),
        "-machdep",
        "gcc_x86_64",
        f"-cpp-extra-args=-I{core / 'include'} -I{folder} {PORTABLE}{'' if driver.finite else ' -DNONFINITE_INPUTS'}",
        folder / f"{name}.c",
        *core_sources(core),
        "-eva",
        "-eva-precision",
        "2",
        "-eva-domains",
        "cvalue",
        "-eva-slevel",
        str(driver.states),
        "-eva-plevel",
        "2000",  # the average's 1024 samples
        "-eva-print-callstacks",
        "-eva-use-spec",
        ",".join(CONTRACTS),
        "-warn-special-float",
        "non-finite" if driver.finite else "none",
        *(("-eva-split-return-function", driver.split_returns) if driver.split_returns else ()),
        "-metrics",
        "-metrics-eva-cover",
        memory_gib=8.0,
    )
    log = answer.stdout + answer.stderr
    alarms = re.findall(r"\[eva:alarm\].*?(?=\n\[|\Z)", log, re.DOTALL)
    if alarms or "Statements analyzed by Eva" not in log or "ANALYSIS SUMMARY" not in log:
        raise RungFailed("\n".join([f"{name}: {len(alarms)} alarms", *alarms]) if alarms else answer.evidence)
    return log


def _defined(log: str) -> Iterator[str]:
    """The functions of c_core."""
    listed = re.search(r"Defined functions \(\d+\)\n +=+\n(.*?)\n *\n", log, re.DOTALL)
    if listed is None:
        raise RungFailed(f"no list of functions:\n{log}")
    for name in re.findall(r"(\w+) \((?:\d+ calls?|address taken)", listed[1]):
        if not OWN.fullmatch(name):
            yield _everywhere(name)


def _everywhere(name: str) -> str:
    """An inline function of a header; Eva gives it a new number for every file that includes it."""
    return re.sub(r"_\d+$", "", name)


def _shares(log: str) -> Iterator[tuple[str, float]]:
    for name, reached, statements in re.findall(r"^ +(\w+): (\d+) stmts out of (\d+)", log, re.MULTILINE):
        yield _everywhere(name), int(reached) / int(statements)


def _check_mutant(context: Context, name: str, driver: Driver) -> None:
    core = context.work / f"mutant_{name}"
    shutil.copytree(context.core, core)
    source = core / "src" / driver.mutant.file
    text = source.read_text()
    if text.count(driver.mutant.healthy) != 1:
        raise RungFailed(f"mutant of {name}: not once in {driver.mutant.file}: {driver.mutant.healthy}")
    source.write_text(text.replace(driver.mutant.healthy, driver.mutant.sick))
    with planted(f"{driver.mutant.file} without {driver.mutant.healthy}", shows=rf"{name}: \d+ alarms"):
        _proved(context, name, driver, core)


RUNG = Rung("Frama-C Eva over every module", (FRAMA_C,), check)
