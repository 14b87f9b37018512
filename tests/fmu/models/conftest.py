import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # the helpers beside the tests
sys.path.insert(0, str(Path(__file__).parents[1] / "shell"))  # fmu_driver
sys.path.insert(0, str(Path(__file__).parents[1] / "plant"))  # bumper_law_reference
