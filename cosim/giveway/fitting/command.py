"""The command `giveway fit`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from giveway.base.options import RobotOption
from giveway.base.terminal import print_columns, print_written, progress_bars

__all__ = ["fit"]


def fit(
    out: Annotated[Path, typer.Option("--out", metavar="FILE.toml", help="Robot file to write; may be the one read.")],
    robot: RobotOption = None,
    samples: Annotated[int, typer.Option("--samples", help="Points of the box to start from, 1 to 65536.")] = 1024,
) -> None:
    """Fit the robot's open parameters to the paper's results; writes the robot file and its residuals beside it."""
    import json

    from giveway.base import native
    from giveway.base.files import check_file, replace_files
    from giveway.fitting import record
    from giveway.fitting.quantities import Bench
    from giveway.fitting.search import STAGES, search

    residuals = out.with_suffix(".fit.json")
    for path in (out, residuals):
        check_file(path)
    before = native.robot() if robot is None else robot
    bench = Bench(before)
    try:
        with progress_bars(STAGES) as progress:
            found = search(bench, progress, samples)
    except KeyboardInterrupt:
        raise typer.Abort from None  # Typer itself would end without a word
    text = record.robot_text(before, found, residuals.name)
    command = " ".join(
        ("giveway fit", *([f"--robot {robot}"] if robot else []), f"--out {out}", f"--samples {samples}")
    )
    with replace_files(out, residuals) as (new_robot, new_residuals):
        new_robot.write_text(text, encoding="utf-8")
        new_residuals.write_text(json.dumps(record.record(found, command), indent=2) + "\n", encoding="utf-8")
    print_columns("Targets; residuals in tolerances", record.TARGET_HEADER, record.target_rows(found))
    print_columns("Parameters; deviations in factors", record.PARAMETER_HEADER, record.parameter_rows(found))
    typer.echo(f"Singular values: {', '.join(f'{value:.2f}' for value in found.singular_values)}")
    print_written(out, residuals)
