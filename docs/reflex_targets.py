"""`python -m docs.reflex_targets`: what is asked of the reflex and what it does, as `giveway crowd` finds it.

Runs the commands below on the judging draw and puts their figures into docs/site/reference/reflex_targets.md, with the
hash of the c_core that they are of. Goes on where it stopped: what was computed for this version is kept in OUT.
"""

from __future__ import annotations

import argparse
import json
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from giveway.base.files import write_text

from docs.markdown import replaced, table
from verify.sources import core_hash

__all__ = ["BEGIN", "COMMANDS", "END", "FALSE_PER_HOUR", "HASH_DIGITS", "tables"]

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/site/reference/reflex_targets.md"
BEGIN, END = "<!-- tables: make targets -->", "<!-- end of tables -->"
AS_DRAWN, CALIBRATED, QUIET = "as-drawn", "calibrated", "without-contact"
COMMANDS: Mapping[str, tuple[str, ...]] = {
    AS_DRAWN: ("crowd", "--draw", "judging"),
    CALIBRATED: ("crowd", "--draw", "judging", "--no-imu", "--calibrated", "--robots", "100"),
    QUIET: ("crowd", "endurance", "--draw", "judging"),
}
"""Of `giveway`, each with a folder of its own."""
FALSE_PER_HOUR = 0.01  # the upper bound is to be below
HASH_DIGITS = 12

Document = Mapping[str, Any]


def main() -> int:
    parser = argparse.ArgumentParser(prog="docs.reflex_targets", description="Compute what the reflex does.")
    parser.add_argument("--out", type=Path, default=ROOT / "out/targets", help="folder of the runs and their tables")
    parser.add_argument("--threads", help="of each command; without it: all processors")
    options = parser.parse_args()
    threads = [] if options.threads is None else ["--threads", options.threads]
    sources = core_hash(ROOT)
    for folder, words in COMMANDS.items():
        code = _run([*words, "--out", str(options.out / folder), *threads])
        if code:
            return code
    documents = {
        folder: json.loads((options.out / folder / "table.json").read_text(encoding="utf-8")) for folder in COMMANDS
    }
    if core_hash(ROOT) != sources:
        print("c_core has changed meanwhile: the page is left as it was", file=sys.stderr)
        return 1
    page = PAGE.read_text(encoding="utf-8")
    write_text(PAGE, replaced(page, BEGIN, END, tables(documents, sources)))
    print(f"Written: {PAGE}")
    return 0


def _run(words: Sequence[str]) -> int:
    """Exit code of this command of `giveway`, which ends by itself at Ctrl-C and keeps what it has."""
    with subprocess.Popen([str(Path(sys.executable).parent / "giveway"), *words]) as child:
        # Else it would go on alone, in a folder that the next run cannot use meanwhile.
        before = signal.signal(signal.SIGTERM, lambda *_: child.terminate())
        try:
            return abs(child.wait())
        except KeyboardInterrupt:
            return child.wait()
        finally:
            signal.signal(signal.SIGTERM, before)


def tables(documents: Mapping[str, Document], sources: str) -> str:
    """The tables and their marks from the commands' documents, by folder; ``sources``: hash of the c_core of them."""
    found, calibrated = (documents[folder]["targets"] for folder in (AS_DRAWN, CALIBRATED))
    return "\n".join(
        [
            f"{BEGIN}\nOf the `c_core` whose sources have the hash `{sources[:HASH_DIGITS]}`.\n",
            "## Without an IMU\n",
            _side_by_side(
                {
                    "planar": found["planar"],
                    "planar, calibrated": calibrated["planar"],
                    "tipping": found["tipping"],
                    "tipping, calibrated": calibrated["tipping"],
                }
            ),
            "## With an accelerometer and a gyro\n",
            _side_by_side({"planar": found["planar, IMU"], "tipping": found["tipping, IMU"]}),
            "## Motion without contact\n",
            _quiet(documents[QUIET]["groups"]) + END,
        ]
    )


def _side_by_side(columns: Mapping[str, Sequence[Sequence[str]]]) -> str:
    """What is asked, and a column per kind of robot; some are asked for more."""
    most = {(row, what): at_most for lines in columns.values() for row, what, at_most, *_ in lines}
    found = {name: {(row, what): _said(*said) for row, what, _, *said in lines} for name, lines in columns.items()}
    return table(
        ("hits", "figure", "at most", *columns),
        ((*names, at_most, *(found[name].get(names, "-") for name in columns)) for names, at_most in most.items()),
    )


def _said(value: str, interval: str, verdict: str) -> str:
    return value if interval == "-" else f"{value} ({interval}), {verdict}"


def _quiet(groups: Mapping[str, Mapping[str, Any]]) -> str:
    rows = []
    for group, one in groups.items():
        bound = one["per hour, upper 95 % bound"]
        verdict = "met" if bound < FALSE_PER_HOUR else "missed"
        hours, alarms, rate = f"{one['hours']:g}", str(one["false alarms"]), f"{one['per hour']:.3g}"
        rows.append((group, hours, alarms, rate, f"{bound:.2g}, {verdict}"))
    return table(("robots", "hours", "alarms", "per hour", f"upper 95 % bound, below {FALSE_PER_HOUR:g}"), rows)


if __name__ == "__main__":
    sys.exit(main())
