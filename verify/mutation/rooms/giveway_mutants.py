"""What mutmut's trampolines call in a build with mutants: the same choice as mutant.hpp makes in C++.

GIVEWAY_MUTANT chooses a mutant; GIVEWAY_MUTANTS_REACHED names a file with one byte per mutant, set when the mutant is
reached.
"""

from __future__ import annotations

import functools
import mmap
import os
from collections.abc import Callable
from typing import Any

from giveway_mutant_numbers import NUMBERS  # written beside this file: number of "module.function of the mutant"

__all__ = ["MutantDict", "trampoline"]

MutantDict = dict[str, Callable[..., Any]]
ORIGINAL = "_mutmut_orig"
CHOSEN = int(os.environ.get("GIVEWAY_MUTANT", "0"))


def _reached() -> mmap.mmap | None:
    path = os.environ.get("GIVEWAY_MUTANTS_REACHED")
    if path is None:
        return None
    with open(path, "r+b") as file:
        return mmap.mmap(file.fileno(), 0)


REACHED = _reached()


def trampoline(mutants: MutantDict, is_classmethod: bool = False) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """A decorator: calls go to the chosen mutant of the function, else to the original."""

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        @functools.wraps(function)
        def call(*arguments: Any, **options: Any) -> Any:
            numbers = {NUMBERS[f"{function.__module__}.{name}"]: name for name in mutants if name != ORIGINAL}
            if REACHED is not None:
                for number in numbers:
                    REACHED[number] = 1
            called = mutants[numbers.get(CHOSEN, ORIGINAL)]
            if is_classmethod:
                return getattr(arguments[0], called.__name__)(*arguments[1:], **options)
            return called(*arguments, **options)

        return call

    return decorate
