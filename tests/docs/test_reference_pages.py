"""The pages that are made from sources: nothing is left out, and every formula can be drawn."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from giveway.library.batch_library import native_metrics
from giveway.schemas.documents import document
from giveway.study.metrics import DRIVETRAIN

from docs import c_reference, command_reference, file_reference, metric_reference, proofs, sources, variable_reference

ROOT = Path(__file__).parents[2]
HEADERS = sorted((ROOT / "c_core" / "include" / "giveway").glob("*.h"))


@pytest.mark.parametrize("path", HEADERS, ids=lambda path: path.stem)
def test_every_declaration_of_a_header_is_there(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    without_comments = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    functions = set(re.findall(r"^(?:[A-Za-z_][\w ]*[ *])(gw_\w+)\(", without_comments, re.MULTILINE))
    types = set(re.findall(r"^\} (gw_\w+);", without_comments, re.MULTILINE))
    _, found = c_reference.parsed(text)
    named = {one.name for head in found for one in (head, *head.with_it)}
    assert functions | types <= named


def test_a_comment_belongs_to_what_stands_below_it() -> None:
    head, found = c_reference.parsed(
        "/* What it is.\n *\n * More. */\n#ifndef GW_X_H\n#define GW_X_H\n#include <stdint.h>\n\n"
        "#define GW_LIMIT 3U /* at most */\n\n"
        "typedef struct {\n    int a; /* m; positive */\n} gw_x_t;\n\n"
        "/* Pointers not NULL\n * in these two. */\nvoid gw_x_clear(gw_x_t *x);\nGW_SMALL int gw_x_step(gw_x_t *x,\n"
        "                       int y);\n\n"
        "static inline int gw_x_of(const gw_x_t *x)\n{\n    return (x->a + 1);\n}\n#endif\n"
    )
    assert head == "What it is.\n\nMore."
    assert [(one.kind, one.name, one.comment) for one in found] == [
        ("macro", "GW_LIMIT", "at most"),
        ("type", "gw_x_t", ""),
        ("function", "gw_x_clear", "Pointers not NULL\nin these two."),
        ("function", "gw_x_of", ""),
    ]
    assert [one.code for one in found[2].with_it] == ["int gw_x_step(gw_x_t *x, int y)"]
    assert found[3].code == "int gw_x_of(const gw_x_t *x)"


def test_every_command_and_option_is_there() -> None:
    page = command_reference.pages(ROOT)["reference/command_line.md"]
    for name in ("giveway run", "giveway study export", "giveway fmu check", "giveway crowd endurance"):
        assert f"## `{name}`" in page
    assert "`--bumper`" in page
    assert "EXPERIMENT|FILE" in page.replace("\\", "")


def test_every_variable_is_there() -> None:
    pages = variable_reference.pages(ROOT)
    for model in variable_reference.MODELS:
        listed = re.findall(r"^\| `([^`]+)` \|", pages[f"reference/variables/{model}.md"], re.MULTILINE)
        assert listed == [
            v.name for kind in variable_reference.KINDS for v in variable_reference.variable_table(model).select(kind)
        ]


def test_formulas_are_of_metrics_and_every_metric_is_there() -> None:
    names = [metric.name for metric in native_metrics()] + list(DRIVETRAIN)
    assert set(metric_reference.formulas()) <= set(names)
    assert set(DRIVETRAIN) <= set(metric_reference.formulas()), "their definition is the formula"
    page = metric_reference.pages(ROOT)["reference/metrics.md"]
    assert re.findall(r"^`([^`]+)`, \S+\n: ", page, re.MULTILINE) == names


@pytest.mark.parametrize("kind", ["scenario", "study", "robot", "variables"])
def test_every_key_of_a_file_is_there(kind: str) -> None:
    page = file_reference.pages(ROOT)[f"reference/files/{kind}.md"]
    properties = document(kind)["properties"]
    assert set(properties) <= set(re.findall(r"^\| `([^`]+)` \| ", page, re.MULTILINE))
    assert "|  |  |" not in page.partition("## `")[0], "a key says neither what is allowed nor what it means"


def test_keys_that_go_with_a_word_say_so() -> None:
    page = file_reference.pages(ROOT)["reference/files/scenario.md"]
    assert re.search(r"^\| `diameter` \| a number.* \| .*; with `circle` \(needed\) \|$", page, re.MULTILINE)
    assert "|  |  |" not in page


def test_every_rung_has_its_claim() -> None:
    page = proofs.pages(ROOT)["reference/verified.md"]
    rows = re.findall(r"^\| `(\w+)` \| (.+?) \| (.+) \|$", page, re.MULTILINE)
    assert len(rows) == len(list((ROOT / "verify" / "rungs").glob("r[0-9]*.py")))


def test_a_page_is_written_by_hand_or_made_from_sources(tmp_path: Path) -> None:
    made = sources.generated_pages()
    assert not [name for name in made if (ROOT / "docs" / "site" / name).exists()]
    sources.gather(tmp_path / "pages")
    assert (tmp_path / "pages" / "reference" / "c" / "gw_controller.md").is_file()
    assert (tmp_path / "pages" / "pictures" / "overview.png").is_file()
