"""Finds every mutant, plants those of Python, and lists all in a JSON file.

Runs in the environment of verify/requirements.lock; `verify.mutation.rooms.planted` calls it there.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from verify.mutation.mutants import SEED, Mutant, shuffled
from verify.mutation.rooms.cpp_places import cpp_mutants
from verify.mutation.rooms.python_places import PythonPlaces
from verify.mutation.rooms.room import CPP, LEFT_OUT, PYTHON, PYTHON_PATH


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--root", type=Path, required=True, help="the sources, built in its folder build")
    parser.add_argument("--tree", type=Path, required=True, help="where mutants of Python are planted")
    parser.add_argument("--few", action="store_true", help="only as many as `make verify` tries")
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    with ProcessPoolExecutor(1) as beside:
        cpp = beside.submit(cpp_mutants, given.root, given.root / "build", [room.folder for room in CPP])
        places = PythonPlaces(given.root, [room.folder for room in PYTHON], PYTHON_PATH, LEFT_OUT)
    numbers: dict[Mutant, int] = {}
    for room in PYTHON:
        of_room = [mutant for mutant in places.mutants if mutant.key.file.startswith(room.folder + "/")]
        for mutant in shuffled(of_room, SEED, by_file=False)[: room.few if given.few else room.sample]:
            numbers[mutant] = len(numbers) + 1
    names = places.plant(numbers, given.tree)
    document = {
        "cpp": [_plain(mutant) for mutant in cpp.result()],
        "python": [_plain(mutant) | {"chosen": numbers.get(mutant, 0)} for mutant in places.mutants],
        "names": names,
    }
    given.out.write_text(json.dumps(document), encoding="utf-8")


def _plain(mutant: Mutant) -> dict[str, object]:
    return dataclasses.asdict(mutant) | {"path": str(mutant.path)}


if __name__ == "__main__":
    main()
