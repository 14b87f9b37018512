"""Packages that are not installed with giveway, but with one of its extras: `pip install 'giveway[optimise]'`."""

from __future__ import annotations

import importlib
from types import ModuleType

from giveway.base.errors import GivewayError

__all__ = ["MissingExtraError", "extra"]


class MissingExtraError(GivewayError):
    """A package of an extra is not installed."""

    def __init__(self, module: str, name: str) -> None:
        super().__init__(module, "not installed", f"pip install 'giveway[{name}]'")

    def __str__(self) -> str:
        return f"{self.field} is {self.value}; `{self.allowed}` installs it"


def extra(module: str, name: str) -> ModuleType:
    """The package ``module``, which the extra ``name`` brings; MissingExtraError if it is not there."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if error.name is not None and error.name.partition(".")[0] != module.partition(".")[0]:
            raise  # it is there and lacks something itself
        raise MissingExtraError(module.partition(".")[0], name) from None
