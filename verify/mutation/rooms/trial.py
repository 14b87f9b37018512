"""A trial of the mutants drawn from the rooms outside c_core: the score per room, and a check of the list."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from verify.context import Context
from verify.mutation import survivors
from verify.mutation.mutants import Mutant
from verify.mutation.rooms.planted import Planted
from verify.mutation.rooms.room import ROOMS, Room
from verify.mutation.rooms.tests import Fate, RoomTests
from verify.mutation.trial import require, too_few

__all__ = ["LIST", "RoomsTrial", "judge", "try_all"]

LIST = "verify/mutation/rooms/survivors.toml"


@dataclass(frozen=True)
class RoomsTrial:
    planted: Planted
    fates: dict[Mutant, Fate]

    def of(self, *fates: Fate) -> list[Mutant]:
        return [mutant for mutant, fate in self.fates.items() if fate in fates]

    @property
    def killed(self) -> int:
        return len(self.of(Fate.KILLED))

    @property
    def text(self) -> str:
        return (
            f"{self.killed} of {len(self.fates)} mutants killed ({self.killed / len(self.fates):.1%}); "
            f"{len(self.of(Fate.SURVIVED, Fate.UNREACHED))} survivors, each with a reason, "
            f"{len(self.of(Fate.UNREACHED))} of them reached by no test; "
            f"not counted: {self.planted.not_compiled} that do not compile"
        )


def try_all(tests: RoomTests, rooms: Iterable[Room] = ROOMS, say: Callable[[str], None] = print) -> RoomsTrial:
    """All rooms together, so that no room waits for another's survivors; prints the score and the survivors of each.

    A listed mutant is run on the quick tests only, since it is known to survive all tests.
    """
    listed = survivors.read(tests.context.root, LIST)
    of_rooms = {room: tests.planted.of(room) for room in rooms}
    fates: dict[Mutant, Fate] = {}
    met = tests.by_quick([mutant for mutants in of_rooms.values() for mutant in mutants])
    for room, mutants in of_rooms.items():
        fates |= itertools.islice(met, len(mutants))
        say(f"{room.folder}: {_killed(fates, mutants)} of {len(mutants)} killed by the quick tests")
    left = [mutant for mutant, fate in fates.items() if fate is not Fate.KILLED and mutant.key not in listed]
    fates |= {mutant: fate for mutant, fate in tests.by_slow(left) if fate is not Fate.UNREACHED}
    for room, mutants in of_rooms.items():
        say(f"{room.folder}: {_killed(fates, mutants)} of {len(mutants)} killed by all tests")
        for mutant in mutants:
            if fates[mutant] is not Fate.KILLED:
                say(f"  {fates[mutant].value}: {mutant}")
    return RoomsTrial(tests.planted, fates)


def _killed(fates: Mapping[Mutant, Fate], mutants: Iterable[Mutant]) -> int:
    return sum(fates[mutant] is Fate.KILLED for mutant in mutants)


def judge(context: Context, trial: RoomsTrial) -> None:
    """`RungFailed` unless enough were killed and every survivor is listed; prints entries in the form of the list."""
    reasons = survivors.read(context.root, LIST)
    survived = trial.of(Fate.SURVIVED, Fate.UNREACHED)
    evidence = survivors.wrong(reasons, trial.planted.everything, trial.of(Fate.KILLED), survived)
    require([*evidence, *too_few(trial.killed, len(trial.fates))])
