"""The platforms that wheels are made for."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["PLATFORMS", "Platform"]


@dataclass(frozen=True)
class Platform:
    """One wheel.

    Attributes:
        name: FMI 3's platform tuple, and the build tree below build/platforms.
        tag: of the wheel; the oldest systems are those that cmake/Platform.cmake compiles for.
        ending: of its shared libraries.
        fmi2: the folders of its libraries in an FMU of FMI 2; macOS has one for both processors.
    """

    name: str
    tag: str
    ending: str
    fmi2: tuple[str, ...]

    @property
    def library(self) -> str:
        """File name of the batch library."""
        return f"giveway_batch{self.ending}"


PLATFORMS = (
    Platform("x86_64-linux", "manylinux_2_17_x86_64", ".so", ("linux64",)),
    Platform("aarch64-linux", "manylinux_2_17_aarch64", ".so", ("aarch64-linux",)),
    Platform("x86_64-windows", "win_amd64", ".dll", ("win64",)),
    Platform("x86_64-darwin", "macosx_11_0_x86_64", ".dylib", ("darwin64",)),
    Platform("aarch64-darwin", "macosx_11_0_arm64", ".dylib", ("darwin64", "aarch64-darwin")),
)
