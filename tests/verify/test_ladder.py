"""The ladder of `make verify`: what its rungs say is written down, and nothing red passes for green."""

import json
import os
import sys
import threading
from pathlib import Path

import pytest

from verify import ladder
from verify.context import Context, Tool
from verify.deep import passed
from verify.rung import Figure, Rung, RungFailed, all_rungs, planted
from verify.sources import core_hash, subject_hash

PYTHON = Tool("python3")


def tree(folder: Path) -> Path:
    (folder / "c_core" / "src").mkdir(parents=True)
    (folder / "c_core" / "include").mkdir()
    (folder / "c_core" / "src" / "a.c").write_text("int a;\n")
    return folder


def context(folder: Path) -> Context:
    return Context(folder, folder, str(Path(sys.executable).parent) + ":/usr/bin:/bin")


def climb(folder: Path, **rungs: Rung) -> list[ladder.Outcome]:
    return ladder.climb(folder, rungs, context(folder).path)


def good(_: Context) -> Figure:
    return Figure("3 of 3", {"found": 3})


def bad(_: Context) -> Figure:
    raise RungFailed("it is red\nbecause")


def broken(_: Context) -> Figure:
    raise KeyError("a mistake in the rung")


def test_every_rung_file_is_found_with_its_tools() -> None:
    rungs = all_rungs()
    assert "misra" in rungs
    assert all(rung.tools and rung.summary for rung in rungs.values())


def test_green_rungs_are_written_with_the_hash_of_the_sources(tmp_path: Path) -> None:
    root = tree(tmp_path)
    rungs = {"first": Rung("", (PYTHON,), good), "second": Rung("", (PYTHON,), good, subject=("other.txt",))}
    (root / "other.txt").write_text("not of c_core")
    outcomes = climb(root, **rungs)
    summary = json.loads(ladder.write_summary(root, outcomes, 12.34).read_text())
    assert summary["seconds"] == 12.3
    assert [rung["name"] for rung in summary["rungs"]] == ["first", "second"]
    assert all(rung["passed"] and rung["tools"]["python3"].startswith("Python 3") for rung in summary["rungs"])
    document = json.loads(ladder.verified(root, outcomes, rungs, ladder.hashes(root, rungs)).read_text())
    assert document["c_core_sha256"] == document["rungs"]["first"]["sources_sha256"] == core_hash(root)
    sources = subject_hash(root, ("other.txt",))
    assert document["rungs"]["second"] == {"figure": "3 of 3", "values": {"found": 3}, "sources_sha256": sources}
    assert sources != core_hash(root)


def test_what_varies_is_said_but_not_verified(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    root, written = tree(tmp_path), set()
    for inputs in (1000, 1001):
        rung = Rung("", (PYTHON,), lambda _, inputs=inputs: Figure("none bad", {"found": 3}, f"{inputs} inputs"))
        rungs = {"fuzz": rung}
        outcomes = climb(root, **rungs)
        assert f"none bad ({inputs} inputs)" in capsys.readouterr().out
        written.add(ladder.verified(root, outcomes, rungs, ladder.hashes(root, rungs)).read_bytes())
    assert len(written) == 1


@pytest.mark.parametrize(("check", "evidence"), [(bad, "it is red"), (broken, "a mistake in the rung")])
def test_a_red_rung_is_reported_and_does_not_hide_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], check: object, evidence: str
) -> None:
    outcomes = climb(tree(tmp_path), red=Rung("", (), check), green=Rung("", (), good))  # type: ignore[arg-type]
    assert [outcome.figure is None for outcome in outcomes] == [True, False]
    printed = capsys.readouterr().out
    assert evidence in printed
    assert "FAILED red" in printed
    assert "3 of 3" in printed


def test_a_red_rung_says_why_while_the_others_climb(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    said = threading.Event()

    def hear(text: str, **_: object) -> None:
        if "it is red\nbecause" in text:
            said.set()

    def waits_for_it(_: Context) -> Figure:
        if not said.wait(10.0):
            raise RungFailed("nothing was said")
        return Figure("heard")

    monkeypatch.setattr(ladder, "print", hear, raising=False)
    outcomes = climb(tree(tmp_path), red=Rung("", (), bad), patient=Rung("", (), waits_for_it))
    assert [outcome.evidence for outcome in outcomes] == ["it is red\nbecause", ""]


def test_a_missing_tool_is_a_failure(tmp_path: Path) -> None:
    (outcome,) = climb(tree(tmp_path), lacking=Rung("", (Tool("no-such-prover", package="frama-c"),), good))
    assert outcome.figure is None
    assert "missing tool: no-such-prover (package frama-c)" in outcome.evidence


def test_sources_that_changed_meanwhile_are_not_verified(tmp_path: Path) -> None:
    root = tree(tmp_path)
    rungs = {"first": Rung("", (PYTHON,), good)}
    before = ladder.hashes(root, rungs)
    outcomes = climb(root, **rungs)
    (root / "c_core" / "src" / "a.c").write_text("int b;\n")
    with pytest.raises(RungFailed, match=r"changed while.*: first"):
        ladder.verified(root, outcomes, rungs, before)
    assert not (root / "c_core" / "VERIFIED.json").exists()


def test_a_result_stands_until_what_it_is_about_changes(tmp_path: Path) -> None:
    root = tree(tmp_path)
    (root / "other.txt").write_text("first")
    checked = {"of_core": Rung("", (PYTHON,), good), "of_other": Rung("", (PYTHON,), good, subject=("other.txt",))}

    def climbed(*names: str, **others: Rung) -> list[str]:
        """What VERIFIED.json has after a climb of these."""
        rungs = checked | others
        before = ladder.hashes(root, rungs)
        outcomes = climb(root, **{name: rungs[name] for name in names})
        return list(json.loads(ladder.verified(root, outcomes, rungs, before).read_text())["rungs"])

    assert climbed("of_other") == ["of_other"]
    assert climbed("of_core") == ["of_core", "of_other"]
    assert climbed("of_core", of_core=Rung("", (), bad)) == ["of_other"]
    assert climbed("of_core") == ["of_core", "of_other"]
    (root / "other.txt").write_text("second")
    assert ladder.standing(root, checked) == ["of_core"]
    assert climbed() == ["of_core"]
    assert climbed("of_other") == ["of_core", "of_other"]
    (root / "c_core" / "src" / "a.c").write_text("int b;\n")
    assert climbed() == ["of_other"]


def test_a_planted_fault_has_to_be_seen_for_its_own_reason() -> None:
    with planted("seen", shows="because"):
        raise RungFailed("red, because")
    with pytest.raises(RungFailed, match="went unseen"), planted("overlooked", shows="x"):
        pass
    with pytest.raises(RungFailed, match="for another reason"), planted("other", shows="goto"):
        raise RungFailed("missing tool")


def test_tools_run_within_limits_of_memory_and_time(tmp_path: Path) -> None:
    here = context(tmp_path)
    with pytest.raises(RungFailed, match="MemoryError"):
        here.run(sys.executable, "-c", "bytearray(2 * 2**30)", memory_gib=1.0)
    with pytest.raises(RungFailed, match="not finished after"):
        here.run("sleep", "60", timeout_s=0.2)
    with pytest.raises(RungFailed, match="exit code 3"):
        here.run("bash", "-c", "exit 3")
    assert here.run("bash", "-c", "exit 3", expect=3).returncode == 3


def test_deep_tests_are_run_by_the_interpreter_that_has_the_project(tmp_path: Path) -> None:
    """Another pytest in front on the PATH, as that of the tools is, is not asked."""
    other = tmp_path / "bin" / "pytest"
    other.parent.mkdir()
    other.write_text("#!/bin/sh\nexit 1\n", encoding="utf-8")
    other.chmod(0o755)
    test = tmp_path / "test_one.py"
    test.write_text("import giveway, pytest\n\n\n@pytest.mark.deep\ndef test_one():\n    pass\n", encoding="utf-8")
    path = f"{other.parent}{os.pathsep}{os.environ['PATH']}"
    assert passed(Context(Path(__file__).parents[2], tmp_path, path), str(test)) == 1
