import ctypes
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # the helpers beside the tests


@pytest.fixture(scope="session")
def library() -> ctypes.CDLL:
    import plant_probe

    return plant_probe.load()
