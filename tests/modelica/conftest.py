"""The Modelica package through rumoca, and the FMUs beside it."""

from pathlib import Path

import pytest
from giveway_modelica.compiler import Compiler
from giveway_modelica.standard_library import standard_library


@pytest.fixture(scope="session")
def modelica_library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return standard_library(tmp_path_factory.mktemp("standard_library"))


@pytest.fixture(scope="session")
def compiler(modelica_library: Path, tmp_path_factory: pytest.TempPathFactory) -> Compiler:
    return Compiler(modelica_library, tmp_path_factory.mktemp("variants"))
