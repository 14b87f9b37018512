"""`python -m docs`: the site as HTML pages that work from files, without a network; `make docs` prepares what it needs.

Every warning is an error: a link that leads nowhere, a page that no list names, a reference to what does not exist.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path

from docs.sources import gather

ROOT = Path(__file__).parents[1]


def main() -> int:
    """Build the site; the exit code is that of Sphinx."""
    parser = argparse.ArgumentParser(prog="docs", description="Build the documentation site.")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "docs", help="folder of the pages")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "docs", help="folder of what they are made from")
    options = parser.parse_args()
    from sphinx.cmd.build import build_main

    source = options.work / "source"
    gather(source)
    shutil.rmtree(options.out, ignore_errors=True)
    told = ["--quiet", "--nitpicky", "--fail-on-warning", "--keep-going", "--fresh-env", "--jobs", "auto"]
    code = int(build_main([*told, "-d", str(options.work / "doctrees"), str(source), str(options.out)]))
    if code == 0:
        print(f"Written: {options.out / 'index.html'}")
    return code


if __name__ == "__main__":
    sys.exit(main())
