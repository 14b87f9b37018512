"""Nothing half-written is ever seen under a result's name."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path
from typing import Any

import pytest
from cosim_helpers import folder_content
from giveway.base.errors import FileError, WriteError
from giveway.base.files import check_output, replace_file, replace_folder, scratch_folder, write_text


def write_result(folder: Path, text: str) -> None:
    with replace_folder(folder) as temporary:
        (temporary / "manifest.json").write_text(text)


def fail_halfway(folder: Path, failure: type[BaseException]) -> None:
    with replace_folder(folder) as temporary:
        (temporary / "manifest.json").write_text("{")
        raise failure


def test_a_folder_appears_only_when_complete(tmp_path: Path) -> None:
    target = tmp_path / "deep" / "out"
    with replace_folder(target) as temporary:
        (temporary / "manifest.json").write_text("{}")
        assert not target.exists()
    assert folder_content(target) == ["manifest.json"]
    assert folder_content(tmp_path) == ["deep", "deep/out", "deep/out/manifest.json"]


@pytest.mark.parametrize("failure", [RuntimeError, KeyboardInterrupt])
def test_a_failure_leaves_nothing(tmp_path: Path, failure: type[BaseException]) -> None:
    with pytest.raises(failure):
        fail_halfway(tmp_path / "deep" / "out", failure)
    assert folder_content(tmp_path) == []


def test_a_failure_keeps_the_old_result(tmp_path: Path) -> None:
    target = tmp_path / "out"
    write_result(target, "old")
    with pytest.raises(RuntimeError):
        fail_halfway(target, RuntimeError)
    assert (target / "manifest.json").read_text() == "old"
    write_result(target, "new")
    assert (target / "manifest.json").read_text() == "new"
    assert folder_content(tmp_path) == ["out", "out/manifest.json"]


def test_other_peoples_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(FileError, match="not empty"):
        check_output(tmp_path)
    with pytest.raises(FileError, match="is a file"):
        check_output(tmp_path / "notes.txt")


def test_text_is_replaced_in_one_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "report.html"
    write_text(path, "old")

    def full_disk(*_arguments: object) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr("giveway.base.files.Path.replace", full_disk)
    with pytest.raises(WriteError, match="no space"):
        write_text(path, "new")
    assert path.read_text() == "old"
    assert folder_content(tmp_path) == ["report.html"]


def interrupt_the_next_removal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C arrives while `shutil.rmtree` closes its descriptor, which it then closes again."""
    close, remove = os.close, shutil.rmtree

    def closed_and_interrupted(descriptor: int) -> None:
        close(descriptor)
        monkeypatch.setattr(os, "close", close)
        raise KeyboardInterrupt

    def remove_interrupted(*arguments: Any, **options: Any) -> None:
        monkeypatch.setattr(shutil, "rmtree", remove)
        monkeypatch.setattr(os, "close", closed_and_interrupted)
        remove(*arguments, **options)

    monkeypatch.setattr(shutil, "rmtree", remove_interrupted)


def test_ctrl_c_while_a_temporary_folder_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It stays Ctrl-C; the file is there, and nothing else."""
    interrupt_the_next_removal(monkeypatch)
    with pytest.raises(KeyboardInterrupt), replace_file(tmp_path / "out.json") as temporary:
        temporary.write_text("{}")
    assert folder_content(tmp_path) == ["out.json"]


def test_ctrl_c_while_a_scratch_folder_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It stays Ctrl-C, and nothing is left."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    interrupt_the_next_removal(monkeypatch)
    with pytest.raises(KeyboardInterrupt), scratch_folder("giveway-test-") as folder:
        (folder / "file").write_text("x")
    assert folder_content(tmp_path) == []


def test_a_scratch_folder_that_cannot_be_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "none"))
    with pytest.raises(FileError, match="none"), scratch_folder("giveway-test-"):
        pass


def test_ctrl_c_while_the_old_result_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It stays Ctrl-C; the new result is there, and nothing else."""
    write_result(tmp_path / "out", "old")
    interrupt_the_next_removal(monkeypatch)
    with pytest.raises(KeyboardInterrupt):
        write_result(tmp_path / "out", "new")
    assert (tmp_path / "out" / "manifest.json").read_text() == "new"
    assert folder_content(tmp_path) == ["out", "out/manifest.json"]
