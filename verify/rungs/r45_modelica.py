"""The equations of modelica/GiveWay, translated to C by a second Modelica tool, equal fmu/plant at random states."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from verify.context import Context, Tool
from verify.rung import Figure, Rung, RungFailed, planted

PYTHON = Tool("modelica-python", package="python 3.12")
CC, CXX = Tool("gcc"), Tool("g++")
MODELS = ("Drivetrain", "Bumper", "Contact")
# Relative to the largest term: about ten operations in double precision, and tanh within a few ulp.
LARGEST = 1e-12
FAULTS = {
    "Drivetrain": ("coulomb*direction", "coulomb*direction*1.00000000001"),
    "Bumper": ("(1 + e_stop*u)", "(1 - e_stop*u)"),
    "Contact": ("p_y*(f_normal*n_x - f", "p_y*(f_normal*n_x + f"),
}


def check(context: Context) -> Figure:
    models = context.root / "verify" / "modelica"
    found = _compared(context, models)
    for model, (healthy, sick) in FAULTS.items():
        folder = context.work / f"fault_{model}"
        shutil.copytree(models, folder)
        text = (folder / f"{model}.mo").read_text()
        if healthy not in text:
            raise RungFailed(f"{model}.mo has no {healthy!r} to plant a fault in")
        (folder / f"{model}.mo").write_text(text.replace(healthy, sick))
        with planted(f"{sick} in {model}.mo", shows=f"{model.lower()} "):
            _compared(context, folder)
    states = int(found.pop("states"))
    return Figure(
        f"{len(found)} right-hand sides equal at {states} states each, to {max(found.values()):.0e} of {LARGEST:.0e}; "
        f"{len(FAULTS)} planted faults seen",
        {"right_hand_sides": len(found), "states": states, "faults": len(FAULTS)},
    )


def _compared(context: Context, models: Path) -> dict[str, float]:
    """Largest difference per right-hand side, and the number of states; `RungFailed` if one is too large."""
    out = context.work / f"out_{models.name}"
    out.mkdir()
    sources = [models / f"{model}.mo" for model in MODELS]
    context.run(context.which(PYTHON), models / "emit.py", out, *sources, memory_gib=None)
    for model in MODELS:
        context.run(context.which(CC), "-O2", "-ffp-contract=off", "-c", out / f"{model}.c", "-o", out / f"{model}.o")
    program = out / "compare"
    plant = context.root / "fmu" / "plant"
    objects = [out / f"{model}.o" for model in MODELS]
    generated = context.root / "build" / "fmu" / "plant" / "generated"  # by `make build`
    folders = (plant, plant.parent / "math", generated, out)
    options = ("-std=c++20", "-O2", "-ffp-contract=off", *(f"-I{folder}" for folder in folders))
    context.run(context.which(CXX), *options, models / "compare.cpp", *objects, "-lm", "-o", program)
    answer = context.run(program).stdout
    found = {name: float(value) for name, value in re.findall(r"(\w+) (\S+)", answer)}
    wrong = {name: value for name, value in found.items() if name != "states" and not value <= LARGEST}
    if wrong or len(found) != len(MODELS) + 1:
        lines = [f"{name} differs by {value:.3e}, allowed {LARGEST:.0e}" for name, value in wrong.items()]
        raise RungFailed("\n".join(lines or [answer]))
    return found


RUNG = Rung(
    "the Modelica equations are the plant's",
    (PYTHON, CC, CXX),
    check,
    subject=("fmu/plant/**/*.[ch]pp", "fmu/math/**/*.hpp", "verify/modelica/*.*"),
)
