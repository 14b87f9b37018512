"""All mutants of a C++ file in one text: each place asks at run time which of its mutants is chosen."""

from __future__ import annotations

from collections.abc import Mapping

from verify.mutation.mutants import Mutant

__all__ = ["with_all"]


def with_all(text: bytes, numbers: Mapping[Mutant, int]) -> bytes:
    """The text of one file; lines keep their numbers. A mutant that encloses others contains their original."""
    places: dict[tuple[int, int], list[Mutant]] = {}
    for mutant in numbers:
        places.setdefault((mutant.start, mutant.end), []).append(mutant)
    outer_first = sorted(places, key=lambda place: (place[0], -place[1]))
    return _rendered(text, 0, len(text), outer_first, places, numbers)


def _rendered(
    text: bytes,
    start: int,
    end: int,
    inside: list[tuple[int, int]],
    places: Mapping[tuple[int, int], list[Mutant]],
    numbers: Mapping[Mutant, int],
) -> bytes:
    parts = []
    at = start
    while inside:
        place, inside = inside[0], inside[1:]
        within = [other for other in inside if other[1] <= place[1]]
        inside = [other for other in inside if other[0] >= place[1]]
        original = _rendered(text, *place, within, places, numbers)
        parts += [text[at : place[0]], _choice(original, places[place], numbers)]
        at = place[1]
    return b"".join([*parts, text[at:end]])


def _choice(original: bytes, mutants: list[Mutant], numbers: Mapping[Mutant, int]) -> bytes:
    if any(mutant.replacement == "void()" for mutant in mutants):  # a statement, whose value is not used
        original = b"void(" + original + b")"
    for mutant in sorted(mutants, key=lambda mutant: numbers[mutant]):
        instead = " ".join(mutant.replacement.split())
        original = f"(giveway_mutant({numbers[mutant]}) ? ({instead}) : (".encode() + original + b"))"
    return original
