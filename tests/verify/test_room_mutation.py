"""Mutants in one build: one is activated when the program starts, and those that a run reaches are recorded."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from verify.mutation.mutants import Key, Mutant, shuffled
from verify.mutation.rooms.kept import KeptFates, digest, files_below, read_if_of, write_of
from verify.mutation.rooms.schemata import with_all

ROOT = Path(__file__).parents[2]
ROOMS = ROOT / "verify" / "mutation" / "rooms"

PROGRAM = """\
#include <cstdio>
int count = 0;
template <class T> T twice(T x) { return x * 2; }
int main() {
    count = 7;
    std::printf("%d", twice(count + 1) + count);
    if (count == 0) {
        std::printf("never");
    }
}
"""
FAULTS = [("count = 7", "void()"), ("7", "8"), ("twice(count + 1) + count", "twice(count + 1) - count"), ("1", "2")]
FAULTS += [("x * 2", "x / 2"), ("7", "6"), ('std::printf("never")', "void()")]
PRINTED = ["23", "2never", "26", "9", "25", "11", "20", "23"]  # of the original, then of each


def mutants(path: Path) -> dict[Mutant, int]:
    """Nested ones, and two in one place; of the second ``count + 1`` the literal alone."""
    found = {}
    for number, (healthy, sick) in enumerate(FAULTS, 1):
        start = PROGRAM.index("count + 1") + len("count + ") if healthy == "1" else PROGRAM.index(healthy)
        key = Key(path.name, "", healthy, sick, 1)
        found[Mutant(key, path, 0, start, start + len(healthy), sick)] = number
    return found


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("schemata")
    source = folder / "program.cpp"
    source.write_bytes(with_all(PROGRAM.encode(), mutants(source)))
    words = ("g++", "-std=c++20", "-include", ROOMS / "mutant.hpp", source, "-o", folder / "program")
    subprocess.run(words, check=True)
    return folder / "program"


@pytest.mark.parametrize(("number", "printed"), list(enumerate(PRINTED)))
def test_a_mutant_of_c_plus_plus_is_chosen_when_the_program_starts(program: Path, number: int, printed: str) -> None:
    environment = {**os.environ, "GIVEWAY_MUTANT": str(number)}
    assert subprocess.run([program], env=environment, capture_output=True, text=True, check=True).stdout == printed


def test_a_program_marks_the_mutants_that_it_comes_by(program: Path, tmp_path: Path) -> None:
    marks = tmp_path / "marks"
    marks.write_bytes(bytes(len(PRINTED)))
    environment = {**os.environ, "GIVEWAY_MUTANTS_REACHED": str(marks)}
    answer = subprocess.run([program], env=environment, capture_output=True, text=True, check=True)
    assert answer.stdout == PRINTED[0]
    assert list(marks.read_bytes()) == [0, 1, 1, 1, 1, 1, 1, 0]


def test_lines_keep_their_numbers() -> None:
    text = "a = f(b +\n  c);\n"
    mutant = Mutant(Key("", "", "", "", 1), Path(), 1, 4, len(text) - 2, "f(b -\n  c)")
    assert with_all(text.encode(), {mutant: 3}) == b"a = (giveway_mutant(3) ? (f(b - c)) : (f(b +\n  c)));\n"


MODULE = """\
from giveway_mutants import MutantDict, trampoline
mutants_x_f: MutantDict = {}
@trampoline(mutants_x_f)
def f(a): pass
def x_f_orig(a): return a + 1
def x_f_1(a): return a - 1
mutants_x_f["_mutmut_orig"] = x_f_orig
mutants_x_f["x_f_1"] = x_f_1
"""
TESTS = """\
import pytest
import subject
@pytest.fixture(scope="module")
def value():
    return subject.f(1)
def test_with_fixture(value): assert value == 2
def test_with_fixture_again(value): assert value == 2
def test_without(): pass
"""


@pytest.mark.parametrize(("number", "code"), [(0, 0), (5, 1)])
def test_a_mutant_of_python_is_chosen_and_each_test_that_comes_by_it_is_known(
    tmp_path: Path, number: int, code: int
) -> None:
    (tmp_path / "giveway_mutants.py").write_text((ROOMS / "giveway_mutants.py").read_text())
    (tmp_path / "giveway_mutant_numbers.py").write_text('NUMBERS = {"subject.x_f_1": 5}\n')
    (tmp_path / "subject.py").write_text(MODULE)
    (tmp_path / "test_subject.py").write_text(TESTS)
    marks, report = tmp_path / "marks", tmp_path / "report"
    marks.write_bytes(bytes(6))
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join((str(tmp_path), str(ROOT))),
        "GIVEWAY_MUTANT": str(number),
        "GIVEWAY_MUTANTS_REACHED": str(marks),
        "GIVEWAY_REACH_REPORT": str(report),
    }
    command = [sys.executable, "-m", "pytest", "-q", "-p", "verify.mutation.rooms.reach", "test_subject.py"]
    answer = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert answer.returncode == code, answer.stdout
    found = {entry["test"]: entry for entry in map(json.loads, report.read_text().splitlines())}
    assert [name.split("::")[1] for name, entry in found.items() if entry["reached"] == [5]] == [
        "test_with_fixture",
        "test_with_fixture_again",
    ]
    assert not found["test_subject.py::test_without"]["reached"]
    assert any(entry["failed"] for entry in found.values()) == (code == 1)


def test_the_draw_stays_when_files_are_renamed() -> None:
    def drawn(files: list[str]) -> list[str]:
        mutants = [Mutant(Key(file, f"f{i}", "", "", 1), Path(), 1, 0, 1, "") for i, file in enumerate(files)]
        return [mutant.key.function for mutant in shuffled(mutants, 1, by_file=False)]

    assert drawn([f"cosim/{i}.py" for i in range(9)]) == drawn([f"cosim/moved/{8 - i}.py" for i in range(9)])


def test_a_trial_goes_on_with_the_fates_of_the_same_tests(tmp_path: Path) -> None:
    killed, survived, other = (Key("file", function, "", "", 1) for function in ("killed", "survived", "other"))
    first = KeptFates(tmp_path / "fates", "tests", trust_killed=False)
    first.add(killed, "quick", "killed")
    first.add(survived, "quick", "survived")
    again = KeptFates(tmp_path / "fates", "tests", trust_killed=False)
    assert [again.get(key, "quick") for key in (killed, survived, other)] == ["killed", "survived", None]
    assert again.get(survived, "slow") is None
    changed = KeptFates(tmp_path / "fates", "changed tests", trust_killed=False)
    assert [changed.get(key, "quick") for key in (killed, survived)] == [None, None]
    trusting = KeptFates(tmp_path / "fates", "changed tests", trust_killed=True)
    assert [trusting.get(key, "quick") for key in (killed, survived)] == ["killed", None]


def test_what_was_found_counts_for_the_same_files_only(tmp_path: Path) -> None:
    sources, kept = tmp_path / "sources", tmp_path / "kept"
    (sources / "__pycache__").mkdir(parents=True)
    (sources / "a.py").write_text("a = 1\n")
    before = digest("words", *files_below(sources))
    write_of(kept, before, {"drawn": [1]})
    (sources / "__pycache__" / "a.pyc").write_text("")
    assert digest("words", *files_below(sources)) == before
    assert read_if_of(kept, before) == {"drawn": [1]}
    for change in ({"a.py": "a = 2\n"}, {"a.py": "a = 1\n", "b.py": ""}):
        for name, text in change.items():
            (sources / name).write_text(text)
        assert read_if_of(kept, digest("words", *files_below(sources))) is None
    assert read_if_of(tmp_path / "none", before) is None
