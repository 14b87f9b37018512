"""What the pages of the site say happens when they are followed: every command and every piece of code is run."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from page_blocks import SHOWN, SITE, blocks, run_page

# These take minutes, as they would a reader.
LONG = {f"tutorials/{name}.md" for name in ("choose_a_bumper", "own_robot")} | {"index.md"}
NAMES = sorted(str(path.relative_to(SITE)) for path in SITE.rglob("*.md"))
WITH_CODE = [name for name in NAMES if any(one.language not in SHOWN for one in blocks((SITE / name).read_text()))]


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.deep] * (name in LONG)) for name in WITH_CODE])
def test_a_page_does_what_it_says(name: str, tmp_path: Path) -> None:
    run_page(name, tmp_path)


def test_what_is_not_run_has_a_reason() -> None:
    for name in NAMES:
        text = (SITE / name).read_text(encoding="utf-8")
        assert not re.search(r"^% not run:\s*$", text, re.MULTILINE), name
