"""A virtual environment away from the repository and without compilers, in which a wheel is installed and tried."""

from __future__ import annotations

import email
import importlib.metadata
import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name


class Bare:
    """Below ``folder``: bare/, the environment of the interpreter ``python``, and demo/, which the trial writes.

    PATH holds nothing but the environment; of this process' settings, only those of pip and of certificates are kept.
    """

    def __init__(self, folder: Path, python: Path | str) -> None:
        self.folder, self.programs = folder, folder / "bare" / "bin"
        self.environment = {"PATH": str(self.programs), "HOME": str(folder)}
        kept = ("PIP_", "SSL_", "REQUESTS_")
        self.environment |= {name: value for name, value in os.environ.items() if name.startswith(kept)}
        self.call(python, "-m", "venv", folder / "bare")

    def call(self, *command: object) -> str:
        """Standard output of a command that succeeds."""
        answer = subprocess.run(
            [str(one) for one in command],
            cwd=self.folder, env=self.environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert answer.returncode == 0, answer.stdout + answer.stderr
        return answer.stdout

    def link_needed(self, wheel: Path) -> None:
        """What the wheel needs and nothing else, from the packages of this process instead of from the network."""
        here = Path(sysconfig.get_path("purelib"))
        there = self.programs.parent / here.relative_to(sys.prefix)
        for distribution in needed(wheel):
            for top in {file.parts[0] for file in distribution.files or []} - {"..", "__pycache__"}:
                if not (there / top).exists():  # which several may share
                    (there / top).symlink_to(here / top)

    def install(self, wheel: Path, *options: str) -> None:
        """By the environment's own pip; nothing is compiled, not even to bytecode."""
        self.call(
            self.programs / "pip", "install", "--quiet", "--no-compile", "--only-binary", ":all:", *options, wheel
        )

    def demonstrate(self) -> None:
        """`giveway demo`, and a line of Python."""
        assert "detection time" in self.call(self.programs / "giveway", "demo", "--out", "demo")
        assert (self.folder / "demo" / "report.html").is_file()
        line = "import giveway; print(giveway.__file__, giveway.__version__, giveway.load('demo/magnetic').manifest)"
        origin, version, _ = self.call(self.programs / "python", "-c", line).split(maxsplit=2)
        assert Path(origin).is_relative_to(self.programs.parent)
        assert version == importlib.metadata.version("giveway")

    def consult(self) -> None:
        """`giveway doctor`: what is there, and one golden run."""
        doctor = self.call(self.programs / "giveway", "doctor")
        assert "extra fmu" in doctor
        assert "has the bits that it should have" in doctor

    def remove(self) -> None:
        """Half a gigabyte, which pytest would keep."""
        shutil.rmtree(self.folder / "bare")


def needed(wheel: Path) -> list[importlib.metadata.Distribution]:
    """What the wheel's METADATA asks for, and what that asks for in turn, among the packages of this process."""
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (one for one in archive.namelist() if one.endswith(".dist-info/METADATA"))
        asked = [(one, "") for one in email.message_from_bytes(archive.read(name)).get_all("Requires-Dist", [])]
    found: dict[tuple[str, str], importlib.metadata.Distribution] = {}
    while asked:
        text, extra = asked.pop()
        requirement = Requirement(text)
        if requirement.marker and not requirement.marker.evaluate({"extra": extra}):
            continue
        for wanted in ("", *requirement.extras):
            key = (canonicalize_name(requirement.name), wanted)
            if key not in found:
                found[key] = importlib.metadata.distribution(requirement.name)
                asked += [(one, wanted) for one in found[key].requires or []]
    return list(found.values())
