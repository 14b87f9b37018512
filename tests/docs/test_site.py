"""`make docs`: the site is built without a warning, so every link, reference and formula leads somewhere."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.deep
def test_the_site_is_built_without_a_warning_and_needs_no_network(tmp_path: Path) -> None:
    out = tmp_path / "site"
    command = [sys.executable, "-m", "docs", "--out", out, "--work", tmp_path / "work"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    page = (out / "tutorials" / "feel_a_push.html").read_text(encoding="utf-8")
    fetched = re.findall(r"<(?:script|img|link)[^>]+(?:src|href)=\"(https?:[^\"]+)", page)
    assert fetched == []
    assert "<math" in (out / "explanation" / "theory.html").read_text(encoding="utf-8")
