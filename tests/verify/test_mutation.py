"""Mutants: made alike everywhere, known after lines moved, judged by real builds, and the list of survivors true."""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.context import Context
from verify.failure import RungFailed
from verify.mutation import survivors
from verify.mutation.killers import Fate, Killers
from verify.mutation.mutants import Key, Mutant, every, mutants_of, shuffled

ROOT = Path(__file__).parents[2]

SOURCE = """\
#define LIMIT ((gw_real_t)2.5) /* not 1.0 */
static const uint32_t rows[2] = {0U, 7U};
/* a < b in a comment */
gw_status_t gw_thing_step(gw_thing_t *thing, gw_real_t x)
{
    gw_status_t status = GW_STATUS_OK;
    if ((thing == NULL) || (x > LIMIT)) {
        status = GW_STATUS_INPUT_INVALID;
    } else {
        thing->y = (x < -LIMIT) ? (gw_real_t)-1.0 : thing->y;
        gw_reset(thing);
    }
    return status;
}
"""


def mutants(folder: Path, text: str = SOURCE) -> list[Mutant]:
    path = folder / "gw_thing.c"
    path.write_text(text)
    return mutants_of(path)


def test_every_kind_of_fault_is_planted_where_it_makes_sense(tmp_path: Path) -> None:
    found = {(mutant.number, mutant.key.change) for mutant in mutants(tmp_path)}
    assert found == {
        (1, "2.5 -> (1.01 * 2.5)"),
        (1, "2.5 -> (-2.5)"),
        (2, "0U -> 1U"),
        (2, "7U -> 6U"),
        (2, "7U -> 8U"),
        (6, "GW_STATUS_OK -> GW_STATUS_NULL_POINTER"),
        (7, "condition negated"),
        (7, "== -> !="),
        (7, "|| -> &&"),
        (7, "> -> >="),
        (7, "> -> <="),
        (8, "GW_STATUS_INPUT_INVALID -> GW_STATUS_OK"),
        (8, "statement left out"),
        (10, "< -> <="),
        (10, "< -> >="),
        (10, "- -> nothing"),
        (10, "1.0 -> (1.01 * 1.0)"),
        (10, "statement left out"),
        (11, "statement left out"),
        (13, "result negated"),
    }


def test_a_mutant_differs_from_its_source_in_one_place(tmp_path: Path) -> None:
    for mutant in mutants(tmp_path):
        changed = mutant.applied(SOURCE)
        assert changed != SOURCE
        assert changed.startswith(SOURCE[: mutant.start])
        assert changed.endswith(SOURCE[mutant.end :])


def test_a_key_survives_that_lines_move_and_tells_twins_apart(tmp_path: Path) -> None:
    before = [mutant.key for mutant in mutants(tmp_path)]
    after = [mutant.key for mutant in mutants(tmp_path, "\n/* new */\n" + SOURCE)]
    assert before == after
    twice = [mutant.key for mutant in mutants(tmp_path, SOURCE.replace("gw_reset(thing);", "a++; a++;"))]
    assert len(set(twice)) == len(twice)
    assert {key.nth for key in twice if key.change == "++ -> --"} == {1, 2}


def test_the_same_seed_draws_the_same_mutants(tmp_path: Path) -> None:
    some = mutants(tmp_path)
    drawn = [mutant.key for mutant in shuffled(some, 1)]
    assert drawn == [mutant.key for mutant in shuffled(list(reversed(some)), 1)]
    assert drawn != [mutant.key for mutant in shuffled(some, 2)]
    # Fixed here, so that a change of the draw is noticed on every machine.
    assert [key.change for key in drawn[:2]] == ["7U -> 6U", "> -> <="]


@pytest.mark.deep
def test_real_mutants_meet_their_fates(tmp_path: Path) -> None:
    killers = Killers(Context(ROOT, tmp_path))
    source, other = (ROOT / "c_core" / "src" / name for name in ("gw_sum.c", "gw_detector.c"))
    header = ROOT / "c_core" / "include" / "giveway" / "gw_sum.h"
    texts = {path: path.read_text() for path in (source, other, header)}

    def fate(path: Path, healthy: str, sick: str) -> Fate:
        assert texts[path].count(healthy) == 1
        start = texts[path].index(healthy)
        key = Key(path.name, "", healthy, sick, 1)
        return killers.fate(Mutant(key, path, 0, start, start + len(healthy), sick))

    # An inline function's mutant is in every source that includes it.
    assert fate(header, "increment - sum.excess", "increment + sum.excess") is Fate.UNIT
    assert fate(source, "+= TURN_REMAINDER", "+= no_such_name") is Fate.NOT_COMPILED
    listed = survivors.read(ROOT)
    survivor = next(mutant for mutant in mutants_of(other) if mutant.key in listed)
    assert killers.fate(survivor) is Fate.SURVIVED
    assert fate(source, "result.value >= GW_PI", "result.value >= (GW_PI)") is Fate.SAME_OBJECT
    for endless in ("for (;;) { }", 'for (;;) { extern int puts(const char *); (void)puts("x"); }'):
        assert fate(source, "result.excess += TURN_REMAINDER;", endless) is Fate.UNIT
    assert texts == {path: path.read_text() for path in texts}


@pytest.mark.parametrize(
    ("text", "evidence"),
    [
        ('[[reason]]\nwhy = " "\nmutants = []\n', "without a reason"),
        ('[[reason]]\nwhy = "so"\nmutants = [{ file = "a.c" }]\n', "has exactly"),
        (
            '[[reason]]\nwhy = "so"\nmutants = [\n'
            + 2 * '    { file = "a.c", function = "f", line = "x;", change = "y", nth = 1 },\n'
            + "]\n",
            "listed twice",
        ),
    ],
)
def test_a_bad_list_is_refused(tmp_path: Path, text: str, evidence: str) -> None:
    path = tmp_path / survivors.LIST
    path.parent.mkdir(parents=True)
    path.write_text(text)
    with pytest.raises(RungFailed, match=evidence):
        survivors.read(tmp_path)


def test_what_is_printed_can_be_read_back_and_is_judged(tmp_path: Path) -> None:
    first, second, *others = mutants(tmp_path)
    path = tmp_path / survivors.LIST
    path.parent.mkdir(parents=True)
    entries = "\n".join(survivors.entries([first.key, second.key]))
    path.write_text(f'[[reason]]\nwhy = "no test can"\nmutants = [\n{entries}\n]\n')
    reasons = survivors.read(tmp_path)
    assert set(reasons) == {first.key, second.key}
    everything = [first, second, *others]
    assert survivors.wrong(reasons, everything, others, [first, second]) == []
    assert "survived, and not listed" in survivors.wrong({}, everything, others, [first])[0]
    assert "but killed" in survivors.wrong(reasons, everything, [first], [second])[0]
    assert "no such mutant" in survivors.wrong(reasons, [first, *others], others, [first])[0]
    assert survivors.wrong(reasons, everything, [], []) == []  # nothing is said of what was not tried


def test_every_listed_survivor_is_still_a_mutant_of_c_core() -> None:
    assert survivors.wrong(survivors.read(ROOT), every(ROOT), [], []) == []
