"""`python -m giveway_modelica COMMAND`: makes the files of modelica/ that are generated, and checks it."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from giveway_modelica import agreement, reference_results
from giveway_modelica.bench import ROBOT
from giveway_modelica.compiler import PACKAGE, Compiler
from giveway_modelica.lint import findings
from giveway_modelica.robot_record import record
from giveway_modelica.standard_library import standard_library

RECORD = PACKAGE / "Parameters" / "Trikey.mo"


def main() -> int:
    parser = argparse.ArgumentParser(prog="giveway_modelica", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("record", help="the robot's numbers: GiveWay/Parameters/Trikey.mo")
    commands.add_parser("results", help="reference results of every example: ReferenceResults/")
    commands.add_parser("lint", help="does the package keep the conventions?")
    commands.add_parser("agreement", help="prints how far every example is from the FMUs")
    command = parser.parse_args().command
    if command == "record":
        RECORD.write_text(record(ROBOT))
    elif command in ("results", "agreement"):
        with tempfile.TemporaryDirectory() as folder:
            compiler = Compiler(standard_library(Path(folder) / "library"), Path(folder) / "variants")
            if command == "agreement":
                print(agreement.table(compiler), end="")
                return 0
            for path, text in reference_results.texts(compiler):
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
    else:
        found = list(findings())
        print("\n".join(found) or "no finding")
        return 1 if found else 0
    return 0


if __name__ == "__main__":
    sys.exit(main())
