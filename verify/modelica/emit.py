"""`python3.12 emit.py FOLDER FILE.mo...`: each model as C by the emitter of the PyPI package modelica, in FOLDER.

NAME.h next to NAME.c has the indices of its states, parameters and rates in the emitter's arrays.
"""

import re
import sys
from pathlib import Path

from modelica.lang import parse
from modelica.sim import causalize, flatten
from modelica.sim.cgen import FUNCTIONS, unit

folder = Path(sys.argv[1])
for name in sys.argv[2:]:
    source = Path(name)
    system = causalize(flatten([parse(source.read_text())], source.stem))
    text = unit(system)
    # All units are linked together.
    for function in FUNCTIONS:
        text = re.sub(rf"\bvoid {function}\(", f"void {source.stem}_{function}(", text)
    (folder / f"{source.stem}.c").write_text(text)
    states = [f"y_{state}" for state in system.states]
    parameters = [f"p_{parameter.name}" for parameter in system.parameters]
    lines = [
        f"namespace {source.stem} {{",
        "enum State { " + ", ".join([*states, "state_count"]) + " };",
        "enum Parameter { " + ", ".join([*parameters, "parameter_count"]) + " };",
        "}",
        f'extern "C" void {source.stem}_rhs(double t, const double *y, const double *p, double *w, double *dy);',
    ]
    (folder / f"{source.stem}.h").write_text("\n".join(lines) + "\n")
