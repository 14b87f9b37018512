"""The command `giveway firmware`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from giveway.base import native
from giveway.base.terminal import print_written
from giveway.robot.presets import DEFAULT

__all__ = ["firmware"]


def firmware(
    robot: Annotated[str, typer.Argument(metavar="ROBOT", help="Robot file (TOML), or the name of a shipped robot.")],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder to write; new or empty.")],
    preset: Annotated[
        str, typer.Option("--preset", help="The controller's reflex: default, or paper for that of the paper.")
    ] = DEFAULT,
    assignments: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="controller.NAME=VALUE", help="Set a parameter of the controller."),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace files of the same names if DIR is not empty.")
    ] = False,
) -> None:
    """Write C sources for a microcontroller: the C library, your robot's configuration, a main step and a self-test."""
    from giveway.base.errors import GivewayError
    from giveway.firmware.config_source import Scaling
    from giveway.firmware.folder import check_folder, firmware_files, write_files
    from giveway.firmware.recording import record
    from giveway.firmware.settings import Settings
    from giveway.robot.variables import parse_assignments

    file = native.robot_file("ROBOT", robot)
    overrides = parse_assignments(assignments or [])
    if overrides["testbed"]:
        name = next(iter(overrides["testbed"]))
        raise GivewayError("--set", f"testbed.{name}", "controller.NAME=VALUE: firmware has no testbed")
    settings = Settings.of(file, preset, overrides["controller"])
    check_folder(out, force)
    recording = record(settings)
    write_files(out, firmware_files(settings, recording), force)
    if Scaling.of(settings).assumed:
        typer.echo(
            f"{file.name} states no resolution of the torque signal: a count is assumed as 16 bits of its range."
        )
    felt = "which the controller notices" if recording.hits else "which the controller does NOT notice"
    typer.echo(f"Recorded: {len(recording.counter)} ticks of a collision at {recording.speed_mps:g} m/s, {felt}.")
    print_written(out, then=f"build and test it with: make -C {out} test")
