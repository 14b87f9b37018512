"""What `giveway doctor` looks at, each as one finding."""

from __future__ import annotations

import importlib.metadata
import platform
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.base.version import VERSION
from giveway.base.words import counted

__all__ = ["WRONG", "Finding", "examine"]

FINE, MISSING, WRONG = "fine", "not installed", "wrong"


@dataclass(frozen=True)
class Finding:
    """One line of the answer.

    Attributes:
        about: "giveway", "native files" ...
        state: "fine", "not installed" (of an extra: nothing that has to be there) or "wrong".
        found: what is there.
        advice: what to do; "" if nothing.
    """

    about: str
    state: str
    found: str
    advice: str = ""


def examine() -> Iterator[Finding]:
    """Every finding, the slower ones last."""
    system = f"{platform.system()} {platform.machine()}, Python {platform.python_version()} ({sys.executable})"
    yield Finding("giveway", FINE, f"{VERSION}, {system}")
    yield from _extras()
    natives = list(_native_files())
    yield from natives
    if any(one.state == WRONG for one in natives):
        return
    yield _lanes()
    yield _golden("golden run, batch library", "native", 3)
    for version in (3, 2):
        yield _golden(f"golden run, FMUs of FMI {version}", "fmu", version)


def _extras() -> Iterator[Finding]:
    """What can be installed besides, by the package's own list."""
    try:
        requires = importlib.metadata.requires("giveway") or []
    except importlib.metadata.PackageNotFoundError:
        yield Finding("extras", MISSING, "giveway is used from a source tree: its extras are not known")
        return
    for line in requires:
        match = re.fullmatch(r"([\w.-]+).*extra == ['\"]([\w-]+)['\"].*", line)
        if match is None:
            continue
        package, extra = match.groups()
        try:
            yield Finding(f"extra {extra}", FINE, f"{package} {importlib.metadata.version(package)}")
        except importlib.metadata.PackageNotFoundError:
            yield Finding(f"extra {extra}", MISSING, f"{package} is not there", f"pip install 'giveway[{extra}]'")


def _native_files() -> Iterator[Finding]:
    names = [
        f"giveway_{model}_fmi{version}.fmu" for model in (*native.MODELS, *native.COMPONENTS) for version in (3, 2)
    ]
    names += [f"{model}.variables.toml" for model in (*native.MODELS, *native.COMPONENTS)]
    names += [native.BATCH_LIBRARY, "giveway_batch.wasm", native.DEFAULT_ROBOT]
    if missing := [name for name in names if not _is_there(name)]:
        words = f"{', '.join(missing)} not found"
        yield Finding("native files", WRONG, words, f"install giveway again, or set {native.ENVIRONMENT_VARIABLE}")
    else:
        folder = native.file(native.DEFAULT_ROBOT).parent
        yield Finding("native files", FINE, f"{counted(len(names), 'file')} in {folder}")


def _is_there(name: str) -> bool:
    try:
        native.file(name)
    except GivewayError:
        return False
    return True


def _lanes() -> Finding:
    from giveway.library.batch_library import widest_lanes

    lanes = widest_lanes()
    uses = {1: "no vector instructions", 4: "AVX2", 8: "AVX-512"}[lanes]
    return Finding("processor", FINE, f"{counted(lanes, 'design')} side by side with fixed steps ({uses})")


def _golden(about: str, engine: str, fmi_version: int) -> Finding:
    from giveway.doctor.golden import DIGEST, digest, golden_scenario
    from giveway.simulation import runner

    try:
        found = digest(runner.run(golden_scenario(fmi_version), None, engine))  # type: ignore[arg-type]
    except GivewayError as error:
        return Finding(about, WRONG, str(error), "install giveway again")
    if found == DIGEST:
        return Finding(about, FINE, f"has the bits that it should have ({DIGEST[:8]})")
    return Finding(about, WRONG, f"has other bits ({found[:8]} instead of {DIGEST[:8]})", "report it with this table")
