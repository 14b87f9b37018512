"""The tests of c_core see nine of ten small faults in it; for each of the others the reason is listed."""

from __future__ import annotations

from dataclasses import replace

from verify.context import Context
from verify.mutation.killers import UNIT, Killers
from verify.mutation.mutants import SEED, every, shuffled
from verify.mutation.trial import judge, of_all, of_some
from verify.rung import Figure, Rung, planted
from verify.targets import GCC

MUTANTS = 500
WITHOUT_TESTS = 20  # mutants of a module whose tests are removed


def check(context: Context) -> Figure:
    killers = Killers(context)
    trial = of_some(killers, MUTANTS)
    judge(killers, trial)
    _check_planted(context)
    return Figure(
        f"{trial.text}; seed {SEED}; 1 planted fault seen",
        {
            "mutants": len(trial.fates),
            "counted": trial.counted,
            "killed": trial.killed,
            "score": round(trial.score, 4),
            "seed": SEED,
            "planted_faults": 1,
        },
    )


def _check_planted(context: Context) -> None:
    """Without the tests of the servo some of its mutants survive: the golden bits alone do not see all."""
    apart = replace(context, work=context.work / "without_tests")
    apart.work.mkdir()
    stub = apart.work / "no_servo_test.c"
    stub.write_text('#include "unit.h"\nvoid suite_servo(void)\n{\n}\n')
    tests = [path for path in sorted((context.root / UNIT).glob("*.c")) if path.name != "servo_test.c"]
    killers = Killers(apart, [*tests, stub])
    mutants = [mutant for mutant in shuffled(every(context.root), SEED) if mutant.key.file == "gw_servo.c"]
    with planted("the servo's tests taken away", shows=r"\d+ survived, and not listed"):
        judge(killers, of_all(killers, mutants[:WITHOUT_TESTS]))


RUNG = Rung(f"{MUTANTS} mutants of c_core", (GCC,), check)
