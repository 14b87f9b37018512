"""The folder that `giveway firmware` writes: every file by its name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from giveway.base.errors import FileError
from giveway.base.files import check_file, replace_files, replace_folder
from giveway.firmware.config_source import config_header, config_source
from giveway.firmware.core import core_files
from giveway.firmware.recording import Recording
from giveway.firmware.settings import Settings
from giveway.firmware.words_source import words_header, words_source

__all__ = ["check_folder", "firmware_files", "program_files", "write_files"]

PROGRAMS = Path(__file__).parent / "c"


def program_files(settings: Settings) -> dict[str, bytes]:
    """Path below the folder to content: what a program needs that replays no recording."""
    fixed = {path.relative_to(PROGRAMS).as_posix(): path.read_bytes() for path in PROGRAMS.rglob("*") if path.is_file()}
    written = {
        "robot_config.h": config_header(settings),
        "robot_config.c": config_source(settings),
        "controller_words.h": words_header(),
        "controller_words.c": words_source(),
    }
    return core_files() | fixed | {name: text.encode() for name, text in written.items()}


def firmware_files(settings: Settings, recording: Recording) -> dict[str, bytes]:
    """The same and the recording."""
    recorded = {"recorded_collision.h": recording.header(), "recorded_collision.c": recording.source()}
    return program_files(settings) | {name: text.encode() for name, text in recorded.items()}


def check_folder(folder: Path, force: bool) -> None:
    """Refuse, before any work, a folder with files in it, unless ``force``, and one that cannot be written."""
    check_file(folder / "Makefile")
    if folder.exists() and not folder.is_dir():
        raise FileError(folder, "is a file", "give a folder to write to")
    if folder.exists() and any(folder.iterdir()) and not force:
        hint = "give a new or an empty folder, or --force to replace the files of the same names"
        raise FileError(folder, "is not empty", hint)


def write_files(folder: Path, files: Mapping[str, bytes], force: bool) -> None:
    """Write all of ``files`` or none; other files in ``folder`` stay."""
    check_folder(folder, force)
    if not folder.exists() or not any(folder.iterdir()):
        with replace_folder(folder) as new:
            for name, content in files.items():
                (new / name).parent.mkdir(parents=True, exist_ok=True)
                (new / name).write_bytes(content)
        return
    with replace_files(*(folder / name for name in files)) as places:
        for place, content in zip(places, files.values(), strict=True):
            place.write_bytes(content)
