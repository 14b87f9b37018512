"""Links of the READMEs lead to files and headings that are there; those of the site's pages are checked by Sphinx."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
LINK = re.compile(r"\]\((?!https?:)([^)#\s]*)(?:#([^)\s]*))?\)")


def anchors(text: str) -> set[str]:
    """As forges make them of headings."""
    titles = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def broken(name: str, text: str) -> Iterator[str]:
    """Links of the file ``name`` that lead nowhere."""
    for link in LINK.finditer(text):
        target = (ROOT / name).parent / link[1] if link[1] else ROOT / name
        if not target.exists() or (link[2] and link[2] not in anchors(target.read_text(encoding="utf-8"))):
            yield f"{name}: {link[0]}"


def test_links_of_readmes_lead_somewhere() -> None:
    listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    names = [name for name in listed.splitlines() if not name.startswith("docs/site/")]
    found = [one for name in names for one in broken(name, (ROOT / name).read_text(encoding="utf-8"))]
    assert found == []


def test_a_link_to_nowhere_is_found() -> None:
    assert list(broken("README.md", "[a](nowhere.md) [b](README.md#nothing) [c](#where-things-are) [d](cosim)")) == [
        "README.md: ](nowhere.md)", "README.md: ](README.md#nothing)",
    ]  # fmt: skip
