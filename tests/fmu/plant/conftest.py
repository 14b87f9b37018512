import ctypes

import pytest

import plant_probe


@pytest.fixture(scope="session")
def library() -> ctypes.CDLL:
    return plant_probe.load()
