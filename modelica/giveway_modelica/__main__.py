"""`python -m giveway_modelica COMMAND`: makes the files of modelica/ that are generated."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from giveway_modelica.robot_record import record

ROOT = Path(__file__).parents[2]
RECORD = ROOT / "modelica" / "GiveWay" / "Parameters" / "Trikey.mo"


def main() -> int:
    parser = argparse.ArgumentParser(prog="giveway_modelica", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("record", help=f"the robot's numbers: {RECORD.relative_to(ROOT)}")
    parser.parse_args()
    RECORD.write_text(record(ROOT / "robots" / "trikey.toml"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
