"""Every recipe of CONTRIBUTING.md names the files that its example stands in: all of them, and no others."""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
# Product files are what is neither a test, a check, documentation nor generated.
OTHER = re.compile(r"(tests|verify|docs)/|.*\.(md|png|csv|json)$|modelica/GiveWay/Parameters/Trikey\.mo$")
ITEM = re.compile(r"^\d\. `([^`]+)`: ([^(]*?) \(`(.*)`\)$", re.MULTILINE)
COMMAND = re.compile(r"(?:^    |&& )(\S+)(.*?)(?= &&|$)", re.MULTILINE)


@dataclass(frozen=True)
class Recipe:
    name: str
    text: str

    @property
    def files(self) -> dict[str, str]:
        """Path of each file to what stands in it for the example; NAME is the example's."""
        example = re.search(r"^Example: `([^`]+)`", self.text, re.MULTILINE)
        items = ITEM.findall(re.sub(r"\n   (?=\S)", " ", self.text))
        return {path.replace("NAME", example[1] if example else "NAME"): word for path, _, word in items}


def recipes() -> list[Recipe]:
    parts = re.split(r"^### (.+)\n", TEXT, flags=re.MULTILINE)[1:]
    found = [Recipe(name, text) for name, text in zip(parts[::2], parts[1::2], strict=True)]
    return [recipe for recipe in found if "\n1. " in recipe.text]


def product_files() -> dict[str, str]:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    paths = [path for path in listed.splitlines() if not OTHER.match(path) and (ROOT / path).is_file()]
    return {path: (ROOT / path).read_text(encoding="utf-8", errors="ignore") for path in paths}


def has(text: str, word: str) -> bool:
    return re.search(rf"(?<!\w){re.escape(word)}(?!\w)", text) is not None


RECIPES = {recipe.name: recipe for recipe in recipes()}
# What other parts of the product may say, too: names that users choose by.
SHARED_WORDS = {"An experiment", "A robot", "A bumper law"}


def test_the_recipes_are_these() -> None:
    assert list(RECIPES) == [
        "A plant parameter", "A bumper law", "A metric", "A detector", "A detector's threshold", "A controller output",
        "A variable of an FMU", "An experiment", "A sampler", "A robot",
    ]  # fmt: skip


@pytest.mark.parametrize("name", RECIPES)
def test_the_example_stands_in_each_file(name: str) -> None:
    recipe = RECIPES[name]
    assert len(recipe.files) == len(re.findall(r"^\d\. ", recipe.text, re.MULTILINE)), "an item that is not understood"
    for path, word in recipe.files.items():
        assert (ROOT / path).is_file(), path
        assert word in (ROOT / path).read_text(encoding="utf-8"), f"{path} does not say {word}"


@pytest.mark.parametrize("name", sorted(set(RECIPES) - SHARED_WORDS))
def test_the_example_stands_in_no_other_product_file(name: str) -> None:
    recipe = RECIPES[name]
    words = set(recipe.files.values())
    found = {path for path, text in product_files().items() if any(has(text, word) for word in words)}
    users = set(re.findall(r"`([\w/.]+\.\w+)`", recipe.text.partition("\n1. ")[0]))  # named before the list
    assert found == set(recipe.files) | users


def test_commands_are_there() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for program, rest in COMMAND.findall("".join(recipe.text for recipe in RECIPES.values())):
        if program == "make":
            assert re.search(rf"^{rest.split()[0]}:", makefile, re.MULTILINE), rest
        else:
            assert program in (".venv/bin/pytest", ".venv/bin/ctest", ".venv/bin/giveway", ".venv/bin/python"), program
        for path in re.findall(r"\btests/[\w/.]+", rest):
            assert (ROOT / path).exists(), path


def test_links_lead_somewhere() -> None:
    for target in re.findall(r"\]\(([^)#]+)", TEXT):
        assert (ROOT / target).exists(), target
