"""The pages that Sphinx reads: those of `site/`, and beside them those that are made from the sources."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from docs import (
    c_reference,
    command_reference,
    file_reference,
    metric_reference,
    proofs,
    theory_figures,
    variable_reference,
)

__all__ = ["ROOT", "gather", "generated_pages"]

ROOT = Path(__file__).parents[1]
SITE = Path(__file__).parent / "site"
# Pages of the repository that the site shows as they are.
INCLUDED = {
    "how_to/contribute.md": "CONTRIBUTING.md",
    "reference/changes.md": "CHANGELOG.md",
    "reference/third_party.md": "THIRD_PARTY.md",
}

# Programs and texts of the repository that pages show parts of, by their path below the site.
SHOWN = {
    "programs/mps2_an386/main.c": "examples/firmware_mps2_an386/main.c",
    "texts/c_core.txt": "c_core/README.md",
}


def generated_pages() -> dict[str, str]:
    """Markdown of every page that is made from sources, by its path below the site."""
    pages = {page: _included(name) for page, name in INCLUDED.items()}
    for module in (c_reference, command_reference, file_reference, metric_reference, proofs, variable_reference):
        pages |= module.pages(ROOT)
    return pages


def gather(folder: Path) -> None:
    """Fill ``folder``, which is emptied before, with all pages."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(SITE, folder, ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "pictures").mkdir(exist_ok=True)
    for picture in sorted((ROOT / "docs").glob("*.png")) + sorted((ROOT / "docs").glob("*.webp")):
        shutil.copy(picture, folder / "pictures" / picture.name)
    theory_figures.draw(ROOT, folder / "pictures")
    for name, shown in SHOWN.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / shown, folder / name)
    for name, text in generated_pages().items():
        path = folder / name
        if path.exists():
            raise SystemExit(f"docs: {name} is written by hand and made from sources")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def _included(name: str) -> str:
    """A text of the repository, whose links to other files become those files' names."""
    text = (ROOT / name).read_text(encoding="utf-8")
    return re.sub(r"\[(`?[^\]`]+`?)\]\((?!https?:|#)([^)\s]+)\)", lambda found: f"`{_plain(found[1], found[2])}`", text)


def _plain(words: str, target: str) -> str:
    words = words.strip("`")
    return words if "/" in words or "." in words else target.partition("#")[0]
