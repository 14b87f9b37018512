"""Test modules of different rooms have different names: pytest imports them by these."""

from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parent


def test_no_two_test_modules_have_one_name() -> None:
    names = Counter(path.name for path in ROOT.rglob("*.py") if path.name not in ("conftest.py", "__init__.py"))
    assert len(names) > 100
    assert [name for name, count in names.items() if count > 1] == []
