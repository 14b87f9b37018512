"""The version of this package."""

import importlib.metadata

__all__ = ["VERSION"]

try:
    VERSION = importlib.metadata.version("giveway")
except importlib.metadata.PackageNotFoundError:  # used from a source tree
    VERSION = "0+source"
