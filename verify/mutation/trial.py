"""A trial of mutants: their fates, the score, and whether the list of survivors is true."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from verify.failure import RungFailed
from verify.mutation import survivors
from verify.mutation.killers import Fate, Killers
from verify.mutation.mutants import SEED, Mutant, every, shuffled

__all__ = ["Trial", "judge", "of_all", "of_some", "require", "too_few"]

LEAST_SCORE = 0.9


@dataclass(frozen=True)
class Trial:
    fates: dict[Mutant, Fate]

    def number(self, *fates: Fate) -> int:
        counts = Counter(self.fates.values())
        return sum(counts[fate] for fate in fates)

    @property
    def counted(self) -> int:
        return sum(fate.counts for fate in self.fates.values())

    @property
    def killed(self) -> int:
        return self.counted - self.number(Fate.SURVIVED)

    @property
    def score(self) -> float:
        return self.killed / self.counted

    @property
    def text(self) -> str:
        return (
            f"{self.killed} of {self.counted} mutants killed ({self.score:.1%}), {self.number(Fate.UNIT)} by the unit "
            f"tests, {self.number(Fate.BITS)} more by the golden bits, {self.number(Fate.TRAPS)} by traps; "
            f"{self.number(Fate.SURVIVED)} survivors, each with a reason; not counted: "
            f"{self.number(Fate.NOT_COMPILED)} that do not compile, {self.number(Fate.SAME_OBJECT)} of the same object "
            "code"
        )


def of_some(killers: Killers, number: int, seed: int = SEED) -> Trial:
    """Tries mutants in the order of the seed until ``number`` of them count."""
    waiting = shuffled(every(killers.context.root), seed)
    fates: dict[Mutant, Fate] = {}
    while waiting and (lacking := number - Trial(fates).counted) > 0:
        now, waiting = waiting[:lacking], waiting[lacking:]
        fates |= dict(zip(now, killers.fates(now), strict=True))
    return Trial(fates)


def of_all(killers: Killers, mutants: Sequence[Mutant]) -> Trial:
    return Trial(dict(zip(mutants, killers.fates(mutants), strict=True)))


def judge(killers: Killers, trial: Trial) -> None:
    """`RungFailed` unless enough were killed and every survivor is listed; prints entries in the form of the list."""
    survived = [mutant for mutant, fate in trial.fates.items() if fate is Fate.SURVIVED]
    others = [mutant for mutant, fate in trial.fates.items() if fate is not Fate.SURVIVED]
    root = killers.context.root
    evidence = survivors.wrong(survivors.read(root), every(root), others, survived)
    require([*evidence, *too_few(trial.killed, trial.counted)])


def too_few(killed: int, counted: int) -> list[str]:
    """What is wrong with the score."""
    if killed >= LEAST_SCORE * counted:
        return []
    return [f"{killed} of {counted} killed: {killed / counted:.1%}, at least {LEAST_SCORE:.0%} is asked"]


def require(evidence: Sequence[str]) -> None:
    """`RungFailed` if there is anything wrong."""
    if evidence:
        raise RungFailed("\n".join(evidence))
