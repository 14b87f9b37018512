"""Where the native parts are: FMUs, the batch library, variable tables and the robot file.

They are in one folder: ``giveway/native`` of the installed package, or else the folder in the environment variable
    ``GIVEWAY_NATIVE_DIR``.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from giveway.base.errors import NativeMissingError, UnknownNameError

__all__ = ["COMPONENTS", "MODELS", "batch_library", "file", "fmu", "robot", "robot_file", "robots", "variables"]

ENVIRONMENT_VARIABLE = "GIVEWAY_NATIVE_DIR"
MODELS = ("controller", "testbed")  # the models of an experiment
COMPONENTS = ("drivetrain", "bumper")  # components for a user's own robot
DEFAULT_ROBOT = "trikey.toml"
TABLE_ENDING = ".variables.toml"
INSTALLED = Path(__file__).resolve().parents[1] / "native"
BATCH_LIBRARY = "giveway_batch" + {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def file(name: str) -> Path:
    """Path of the native file ``name``; NativeMissingError names both places that were searched."""
    if (INSTALLED / name).is_file():
        return INSTALLED / name
    folder = os.environ.get(ENVIRONMENT_VARIABLE)
    if folder and (Path(folder) / name).is_file():
        return (Path(folder) / name).resolve()
    searched = f"{ENVIRONMENT_VARIABLE}={folder}" if folder else f"{ENVIRONMENT_VARIABLE}, which is not set"
    raise NativeMissingError(name, INSTALLED, searched)


def fmu(model: str, fmi_version: int) -> Path:
    """Path of the FMU of ``model``, one of MODELS or COMPONENTS, for FMI 2 or 3."""
    return file(f"giveway_{model}_fmi{fmi_version}.fmu")


def batch_library() -> Path:
    """Path of the batch library."""
    return file(BATCH_LIBRARY)


def variables(model: str) -> Path:
    """Path of the variable table of ``model``."""
    return file(f"{model}{TABLE_ENDING}")


def robot() -> Path:
    """Path of the robot file that the FMUs were built with."""
    return file(DEFAULT_ROBOT)


def robots() -> dict[str, Path]:
    """The robot files that are shipped, by name: trikey, the robot that the FMUs were built with, and the others."""
    files = sorted(robot().parent.glob("*.toml"))
    return {path.stem: path for path in files if not path.name.endswith(TABLE_ENDING)}


def robot_file(field: str, text: str, folder: Path = Path()) -> Path:
    """The robot file that a user names: ``delivery`` is a shipped one; with an ending or a slash it is a path.

    ``folder`` is where a relative path begins. UnknownNameError, which names ``field``, if there is no such robot.
    """
    if text.endswith(".toml") or "/" in text or os.sep in text or (folder / text).exists():
        return folder / text
    known = robots()
    if text not in known:
        raise UnknownNameError(field, text, [*known, "the path of a robot file (TOML)"])
    return known[text]
