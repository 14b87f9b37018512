import ctypes

import plant_probe
import pytest


@pytest.fixture(scope="session")
def library() -> ctypes.CDLL:
    return plant_probe.load()
