"""Why a part does not fit a design: what its catalogue states, against the values that the design gives it.

| a part that sets | and states | does not fit |
|---|---|---|
| `testbed.bumper.spring_rate` | `free length` and `solid length` | if it is solid before the bumper's stop |
| | `max force` | if the preload is above it, or the force at the stop |
| `testbed.bumper.latch_force` | `max temperature` | if it gets hotter |
| | any column that `at_most` or `at_least` names | if the quantity is beyond it |

Lengths and forces are those of one spring: several side by side (`rate * count`) share the force, several behind each
other (`rate / count`) the way. Springs are judged where the plate moves them, and them alone: of bumpers with the law
spring, magnetic or damper. Every run is judged with its own values, so a tolerance counts, too.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import GivewayError
from giveway.base.units import WrittenUnit, factor
from giveway.scenario.scenario import BUMPERS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.study.parts import PartChoice, PartSetting

__all__ = ["RULES", "PartRule", "misfit", "part_rules", "refusals", "rules_in_words"]

SPRING_RATE, LATCH_FORCE = "testbed.bumper.spring_rate", "testbed.bumper.latch_force"
FREE, SOLID, MAX_FORCE, MAX_TEMPERATURE = "free length", "solid length", "max force", "max temperature"
SOLID_FIRST, PRELOAD, AT_STOP = "solid before the stop", "preload above its force", "stop above its force"
TOO_HOT, ABOVE, BELOW = "too hot", "above its limit", "below its limit"
RULES = (PRELOAD, SOLID_FIRST, AT_STOP, TOO_HOT, ABOVE, BELOW)
ROUNDING = 1e-9  # a limit that is met exactly is met, whatever the units do to its last digits
_MISFIT = re.compile(rf"(?P<part>.*?): (?P<rule>{'|'.join(RULES)}): (?P<words>.*)")

Values = Callable[[str], "NDArray[np.float64]"]
"""The values of a quantity, one per run, by its name."""


@dataclass(frozen=True)
class PartRule:
    """One reason not to fit.

    Attributes:
        name: one of `RULES`.
        asks: of the runs' values: what the part is asked for.
        limits: what each part can, by part, in the same unit.
        sense: 1: at most that; -1: at least.
        unit: of both, in which they are shown.
        words: what is asked for.
        concerns: kinds of bumper that the rule is about.
    """

    name: str
    asks: Callable[[Values], NDArray[np.float64]]
    limits: NDArray[np.float64]
    sense: int
    unit: WrittenUnit
    words: str
    concerns: tuple[str, ...] = tuple(BUMPERS)


def part_rules(choice: PartChoice) -> list[PartRule]:
    """The rules that the catalogue's columns give for what the parts set.

    Raises:
        GivewayError: a column is there, but not the one that belongs to it.
    """
    rules: list[PartRule] = []
    for setting in choice.settings:
        if setting.quantity.name == SPRING_RATE:
            rules += _spring(choice, setting)
        if setting.quantity.name == LATCH_FORCE and MAX_TEMPERATURE in choice.catalogue.columns:
            limit, unit = _stated(choice, MAX_TEMPERATURE, "degC")
            rules.append(PartRule(TOO_HOT, _value_of("temperature"), limit, 1, unit, "temperature", ("magnetic",)))
    for limit_ in choice.limits:
        name = limit_.quantity.name
        unit = WrittenUnit(*_written(choice, limit_.column, limit_.quantity.unit))
        rule = ABOVE if limit_.sense > 0 else BELOW
        rules.append(PartRule(rule, _value_of(name), limit_.values, limit_.sense, unit, name))
    return sorted(rules, key=lambda rule: RULES.index(rule.name))


def _value_of(name: str) -> Callable[[Values], NDArray[np.float64]]:
    return lambda of: of(name)


def _written(choice: PartChoice, column: str, unit: str) -> tuple[str, float]:
    """A column's unit, and its factor to ``unit``."""
    name = choice.catalogue.columns[column].unit or "1"
    return name, factor(column, name, unit)


def _stated(choice: PartChoice, column: str, unit: str) -> tuple[NDArray[np.float64], WrittenUnit]:
    return choice.numbers(column, unit), WrittenUnit(*_written(choice, column, unit))


def _spring(choice: PartChoice, setting: PartSetting) -> Iterator[PartRule]:
    """Of compression springs."""
    columns, share = choice.catalogue.columns, setting.share
    force, way = min(share, 1.0), min(1.0 / share, 1.0)  # of one of them
    springs = ("spring", "magnetic", "damper")  # where the plate moves the spring, and that alone
    preload, travel = "testbed.bumper.preload", "testbed.bumper.travel"

    if (FREE in columns) != (SOLID in columns):
        there, missing = (FREE, SOLID) if FREE in columns else (SOLID, FREE)
        raise GivewayError(f"{choice.field}.catalogue", f"{there} without {missing}", "both columns, or none of them")
    if FREE in columns:
        length, unit = _stated(choice, FREE, "m")
        room = length - choice.numbers(SOLID, "m")
        for index, part in enumerate(choice.parts):
            if room[index] <= 0.0:
                raise choice.catalogue.wrong(part, columns[SOLID], f"less than {FREE}, {columns[FREE].cells[part]}")

        def compressed(of: Values) -> NDArray[np.float64]:
            return np.asarray(way * (of(preload) / of(SPRING_RATE) + of(travel)))

        yield PartRule(SOLID_FIRST, compressed, room, 1, unit, "compressed at the stop", springs)
    if MAX_FORCE in columns:
        limit, unit = _stated(choice, MAX_FORCE, "N")

        def at_stop(of: Values) -> NDArray[np.float64]:
            return np.asarray(force * (of(preload) + of(SPRING_RATE) * of(travel)))

        yield PartRule(PRELOAD, lambda of: np.asarray(force * of(preload)), limit, 1, unit, "preload", springs)
        yield PartRule(AT_STOP, at_stop, limit, 1, unit, "force at the stop", springs)


def refusals(
    choice: PartChoice, rules: Sequence[PartRule], part: NDArray[np.intp], of: Values, kind: NDArray[np.float64]
) -> dict[int, str]:
    """Why parts do not fit, by run: ``part`` (n,) is the chosen one, ``kind`` (n,) the bumper's."""
    found: dict[int, str] = {}
    for rule in rules:
        asked, limit = rule.asks(of), rule.limits[part]
        concerned = np.isin(kind, [list(BUMPERS).index(name) for name in rule.concerns])
        beyond = rule.sense * (asked - limit) > ROUNDING * np.abs(limit)
        for run in np.flatnonzero(concerned & beyond).tolist():
            words = f"{rule.words} {_number(rule, asked[run])}, at {'most' if rule.sense > 0 else 'least'} "
            found.setdefault(run, f"{choice.name} {choice.names[part[run]]}: {rule.name}: {words}"
                             f"{_number(rule, limit[run])} {rule.unit.shown}".rstrip())  # fmt: skip
    return found


def _number(rule: PartRule, value: float) -> str:
    return f"{rule.unit.of(value):.4g}"


def rules_in_words(choice: PartChoice) -> str:
    """What the parts of a choice are judged by."""
    names = dict.fromkeys(f"{rule.name} ({rule.words})" for rule in part_rules(choice))
    return f"refused if {', '.join(names)}" if names else "nothing: its catalogue states no limit that is known"


def misfit(message: str) -> tuple[str, str, str] | None:
    """Part, rule and numbers of a run's message; None if it is about something else."""
    found = _MISFIT.fullmatch(message)
    return None if found is None else (found["part"], found["rule"], found["words"])
