"""Variables read together equal those read one by one, in any order: the shell has one path for consecutive references,
and another for more than 16 at once."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

import pytest
from fmu_driver import ERROR, OK, Fmu, fmu_path

KINDS = ("real", "integer", "boolean")


@pytest.fixture(scope="module", params=[2, 3], ids=["fmi2", "fmi3"])
def controller(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Fmu:
    """Hundreds of variables with gaps between their references."""
    return Fmu(fmu_path("controller", request.param), request.param, tmp_path_factory.mktemp("controller"))


@pytest.fixture
def fmu(controller: Fmu) -> Iterator[Fmu]:
    one = controller.twin()
    assert one.instantiate()
    assert one.setup() == OK
    yield one
    one.free()


def references(fmu: Fmu, kind: str, *causalities: str) -> list[int]:
    chosen = (v for name, v in fmu.variables.items() if fmu.kind(name) == kind and name != "time")
    return sorted(v.valueReference for v in chosen if not causalities or v.causality in causalities)


def orders(found: Sequence[int]) -> Iterator[list[int]]:
    """Of references in the order of the table: up, down, every second and third one, each twice, at random."""
    yield list(found)
    yield list(found)[::-1]
    for stride in (2, 3):
        for first in range(stride):
            yield list(found)[first::stride]
    for start in range(0, len(found), 5):
        for count in (1, 2, 15, 16, 17, 18):
            yield list(found)[start : start + count]
    half = list(found)[: len(found) // 2]
    yield [reference for reference in half for _ in range(2)]
    dice = random.Random(1)
    for _ in range(20):
        yield dice.sample(list(found), dice.randint(1, len(found)))


@pytest.mark.parametrize("kind", KINDS)
def test_reading_together_is_reading_one_by_one(fmu: Fmu, kind: str) -> None:
    found = references(fmu, kind)
    assert len(found) > 3
    alone = {}
    for reference in found:
        status, (value,) = fmu.get_references(kind, [reference])
        assert status == OK
        alone[reference] = str(value)  # NaN is itself, too
    assert kind == "boolean" or len(set(alone.values())) > 2
    for order in orders(found):
        status, values = fmu.get_references(kind, order)
        assert status == OK, fmu.last_message
        assert [str(value) for value in values] == [alone[reference] for reference in order]


def distinct(fmu: Fmu) -> dict[int, float]:
    """Values of real variables that can be set, no two alike: the start value, or where that is 0 a small number."""
    values: dict[int, float] = {}
    for number, reference in enumerate(references(fmu, "real", "parameter", "input")):
        value = fmu.get_references("real", [reference])[1][0] * (1.0 - 1e-4 * number) or 1e-3 * (number + 1)
        if fmu.set_references("real", [reference], [value]) == OK:
            values[reference] = value
    assert len(set(values.values())) == len(values) > 50
    return values


def test_writing_together_is_writing_one_by_one(fmu: Fmu) -> None:
    values = distinct(fmu)
    for turn, order in enumerate(orders(list(values))):
        chosen = list(dict.fromkeys(order))
        wanted = {reference: values[reference] * (1.0 - 1e-6 * (turn + 1)) for reference in chosen}
        assert fmu.set_references("real", chosen, list(wanted.values())) == OK, fmu.last_message
        values |= wanted
        for reference, value in values.items():
            assert fmu.get_references("real", [reference])[1] == [value]
        assert fmu.get_references("real", order) == (OK, [values[reference] for reference in order])


@pytest.mark.parametrize("kind", KINDS)
def test_a_reference_between_others_that_is_none_is_refused(fmu: Fmu, kind: str) -> None:
    """Also right after one that is there, where the next of the table would be near."""
    found = references(fmu, kind)
    known = {variable.valueReference for variable in fmu.variables.values()}
    gaps = [reference for reference in found if reference + 1 not in known]
    assert gaps
    for before in gaps:
        assert fmu.get_references(kind, [before, before + 1])[0] == ERROR
        assert f"no variable with value reference {before + 1}" in fmu.last_message


def test_a_neighbour_of_another_type_is_refused(fmu: Fmu) -> None:
    kinds = {variable.valueReference: fmu.kind(name) for name, variable in fmu.variables.items() if name != "time"}
    pairs = [(r, kinds[r]) for r in kinds if kinds.get(r + 1, kinds[r]) != kinds[r]]
    assert len(pairs) > 3
    for before, kind in pairs:
        assert fmu.get_references(kind, [before, before + 1])[0] == ERROR
        assert f"is {kinds[before + 1]}, not {kind}" in fmu.last_message
