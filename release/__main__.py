"""`python -m release wheels | sdist | all`: what `make wheels` and `make release` write to dist/.

wheels: one for each platform, from build trees that are there (`make wheels` compiles them).
sdist: the source archive, with the SUNDIALS sources and the bundled pages inside.
all: both, their checks, the bills of materials of the FMUs, and what a person would have to upload.
"""

from __future__ import annotations

import sys
from pathlib import Path

from release import check, outside, sdist, wheel
from release.materials import write_fmus
from release.parts import ROOT
from release.platforms import PLATFORMS

DIST = ROOT / "dist"


def wheels(folder: Path) -> list[Path]:
    """Of all platforms."""
    common = wheel.gather()
    written = [wheel.write(common, platform, folder) for platform in PLATFORMS]
    for path in written:
        print(f"{path.name}: {path.stat().st_size:,} bytes")
    return written


def say_what_is_left(written: list[Path]) -> None:
    """For a person, who alone may publish."""
    tag = f"v{wheel.version()}"
    packages = " ".join(f"dist/{path.name}" for path in written if path.suffix in (".whl", ".gz"))
    rest = " ".join(f"dist/{path.name}" for path in written if path.suffix in (".fmu", ".json"))
    print(f"""
Nothing was uploaded. A person would:
  git tag {tag} && git push origin {tag}
  twine upload {packages}
  attach to the release {tag}: {rest}""")


def main(arguments: list[str]) -> int:
    if arguments not in (["wheels"], ["sdist"], ["all"]):
        found = " ".join(arguments) or "nothing"
        print(f"release: {found} is not allowed; allowed: wheels, sdist, all", file=sys.stderr)
        return 2
    (what,) = arguments
    written = wheels(DIST) if what in ("wheels", "all") else []
    if what in ("sdist", "all"):
        written.append(sdist.write(DIST))
        print(f"{written[-1].name}: {written[-1].stat().st_size:,} bytes")
    faults = [f"{path.name}: {fault}" for path in written for fault in check.faults(path)]
    if what == "all":
        written += write_fmus(DIST)
        faults += [*check.repository_faults(), *outside.faults(written)]
    for fault in faults:
        print(f"release: {fault}", file=sys.stderr)
    if faults:
        return 1
    if what == "all":
        say_what_is_left(written)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
