"""What the pages of the site say happens when they are followed: every command and every piece of code is run."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from page_blocks import SHOWN, SITE, blocks, run_page

# These take minutes, as they would a reader.
LONG = {f"tutorials/{name}.md" for name in ("choose_a_bumper", "own_robots_firmware")} | {"index.md"}
# A page that goes on with what another one wrote.
AFTER = {"tutorials/own_robots_firmware.md": "tutorials/own_robot.md"}
NAMES = sorted(str(path.relative_to(SITE)) for path in SITE.rglob("*.md"))
WITH_CODE = [name for name in NAMES if any(one.language not in SHOWN for one in blocks((SITE / name).read_text()))]


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.deep] * (name in LONG)) for name in WITH_CODE])
def test_a_page_does_what_it_says(name: str, tmp_path: Path) -> None:
    if name in AFTER:
        run_page(AFTER[name], tmp_path)
    run_page(name, tmp_path, whole=name in LONG)


def test_what_is_not_run_has_a_reason_and_what_takes_long_is_run_by_a_long_page() -> None:
    for name in NAMES:
        text = (SITE / name).read_text(encoding="utf-8")
        assert not re.search(r"^% (not run|takes long|needs):?\s*$", text, re.MULTILINE), name
        if "\n% takes long: " in text:
            assert name in LONG or name in {AFTER.get(page) for page in LONG}, name
