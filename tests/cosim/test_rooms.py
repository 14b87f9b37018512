"""The rooms of the package: every import goes down, and the map on its page names them from the ground up."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import giveway
import pytest

PACKAGE = Path(giveway.__file__).parent
PAGE = PACKAGE.parents[1] / "docs" / "site" / "explanation" / "rooms.md"
FOLDERS = sorted(path.parent for path in PACKAGE.rglob("__init__.py"))


def rooms_in_order() -> list[str]:
    """As the page has them; "" is the package itself, which the command line imports."""
    text = PAGE.read_text(encoding="utf-8")
    named = re.findall(r"^- `(\w+)(?:/|\.py)`", text, re.MULTILINE)
    return [*named[:-1], "", named[-1], "__main__"]


def room(name: str) -> str:
    """The folder or file that the module "giveway.x.y" is in; "" for what the package itself has."""
    first = name.removeprefix("giveway").lstrip(".").partition(".")[0]
    return first if first in rooms_in_order() else ""


def imports(path: Path) -> Iterator[str]:
    """Full names of what a file imports from the package, inside functions and for type checkers, too."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name.split(".")[0] == "giveway")
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, path
            if node.module == "giveway":
                yield from (f"giveway.{alias.name}" for alias in node.names)
            elif node.module and node.module.startswith("giveway."):
                yield node.module


def arrows() -> set[tuple[str, str]]:
    found = set()
    for path in sorted(PACKAGE.rglob("*.py")):
        name = ".".join(("giveway", *path.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")
        found |= {(room(name), room(other)) for other in imports(path)}
    return {(above, below) for above, below in found if above != below}


def test_the_map_names_every_room() -> None:
    there = {path.parent.name for path in PACKAGE.glob("*/__init__.py")} | {path.stem for path in PACKAGE.glob("*.py")}
    assert sorted(rooms_in_order()) == sorted((there - {"__init__"}) | {""})


def test_no_import_runs_back_up() -> None:
    order = {name: floor for floor, name in enumerate(rooms_in_order())}
    found = arrows()
    assert ("experiments", "base") in found
    assert [(above, below) for above, below in sorted(found) if order[above] < order[below]] == []


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_a_room_says_what_it_is(folder: Path) -> None:
    assert ast.get_docstring(ast.parse((folder / "__init__.py").read_text(encoding="utf-8")))
