"""The C library and the batch library, from their headers: the header is the manual, and these pages are the header.

The headers are formatted (`make lint`), so a declaration begins in the first column, and a comment that stands directly
above it is about it, and about those that follow without an empty line.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from docs.markdown import escaped, paragraphs, table

__all__ = ["Declaration", "pages", "parsed"]

FOLDER = "c_core/include/giveway"
BATCH = "fmu/batch/giveway_batch.h"
_FUNCTION = re.compile(
    r"^(?:static inline |GW_SMALL |GWB_API )*(?P<head>[\w\s*]+?\b(?P<name>\w+)\(.*?\))\s*[;{]", re.DOTALL
)
_MACRO = re.compile(r"#define (?P<name>\w+)(?P<arguments>\([^)]*\))?")
_TYPE = re.compile(r"^typedef (?:struct|enum|union)?.*?\b(?P<name>\w+);$", re.DOTALL)


@dataclass
class Declaration:
    """Something that a header declares: `kind` is "function", "macro" or "type"."""

    kind: str
    name: str
    code: str
    comment: str = ""
    with_it: list[Declaration] = field(default_factory=list)


def pages(root: Path) -> dict[str, str]:
    """A page per header that declares something, and the list of them."""
    found, rows = {}, []
    for path in [*sorted((root / FOLDER).glob("*.h")), root / BATCH]:
        head, declarations = parsed(path.read_text(encoding="utf-8"))
        if declarations:
            found[f"reference/c/{path.stem}.md"] = _page(path.name, head, declarations)
            rows.append((f"[`{path.name}`]({path.stem}.md)", paragraphs(_sentence(head))))
    names = "\n".join(Path(name).stem for name in found)
    found["reference/c/index.md"] = (
        f"{INDEX}\n{table(('header', ''), rows)}\n```{{toctree}}\n:hidden:\n\n{names}\n```\n"
    )
    return found


INDEX = """# C headers

The header is the manual: these pages are made from the headers' declarations and comments. `giveway/giveway.h`
includes all of the controller's; most programs call {c:func}`gw_controller_config_trikey`,
{c:func}`gw_controller_init` and {c:func}`gw_controller_step` only.
"""


def parsed(text: str) -> tuple[str, list[Declaration]]:
    """The comment at the top of a header, and its declarations in their order."""
    blocks = list(_blocks(text))
    head = _words(blocks[0]) if blocks and blocks[0].startswith("/*") else ""
    found: list[Declaration] = []
    comment, last = "", None
    for block in blocks[1:]:
        if not block:
            comment, last = "", None
        elif block.startswith("/*"):
            comment, last = ("", last) if "clang-format" in block or "cppcheck" in block else (_words(block), None)
        elif one := _declaration(block, comment):
            same = next((other for other in found if other.name == one.name), None)
            if same is not None:  # the other branch of a condition
                same.code += f"\n{one.code}"
            elif last is not None and one.kind == last.kind == "function":
                last.with_it.append(one)
            else:
                found.append(one)
                last = one
            comment = ""
    return head, found


def _blocks(text: str) -> Iterator[str]:
    """Comments, preprocessor lines and declarations; an empty text for an empty line."""
    lines = iter(text.splitlines())
    for line in lines:
        block = line.rstrip()
        if block.startswith("/*"):
            while "*/" not in block:
                block += "\n" + next(lines)
        elif block.startswith("#"):
            while block.endswith("\\"):
                block += "\n" + next(lines).rstrip()
        elif block and not block.startswith(("extern", "}")):
            while not _complete(block):
                block += "\n" + next(lines).rstrip()
        yield block


def _complete(block: str) -> bool:
    code = re.sub(r"/\*.*?\*/", "", block, flags=re.DOTALL)
    if "/*" in code or code.count("(") != code.count(")"):
        return False
    depth = code.count("{") - code.count("}")
    ended = code.rstrip().endswith(";") or ("{" in code and not code.startswith("typedef"))
    return depth == 0 and ended


def _declaration(block: str, comment: str) -> Declaration | None:
    if block.startswith("#"):
        macro = _MACRO.match(block)
        if macro is None or macro["name"].endswith("_H") or not macro.string[macro.end() :].strip():
            return None
        words = re.search(r"/\*(.*?)\*/", block, re.DOTALL)
        code = " ".join(re.sub(r"/\*.*?\*/", "", block, flags=re.DOTALL).split()) if "\\" not in block else block
        return Declaration("macro", macro["name"], code, comment or (_words(words[0]) if words else ""))
    if block.startswith("typedef"):
        name = _TYPE.match(re.sub(r"/\*.*?\*/", "", block, flags=re.DOTALL).strip())
        return Declaration("type", name["name"], block, comment) if name else None
    function = _FUNCTION.match(block)
    if function is None:
        return None
    return Declaration("function", function["name"], " ".join(function["head"].split()), comment)


def _words(comment: str) -> str:
    """A comment without its marks."""
    inside = comment.strip().removeprefix("/*").removesuffix("*/")
    return "\n".join(re.sub(r"^\s*\* ?", "", line).rstrip() for line in inside.splitlines()).strip()


def _sentence(text: str) -> str:
    return " ".join(text.split("\n\n")[0].split()).partition(". ")[0].rstrip(".:") + "."


def _page(name: str, head: str, declarations: list[Declaration]) -> str:
    text = f"# {escaped(name)}\n\n{paragraphs(head)}\n"
    for kind, title in (("function", "Functions"), ("type", "Types"), ("macro", "Macros")):
        chosen = [one for one in declarations if one.kind == kind]
        if chosen:
            text += f"\n## {title}\n\n" + "\n".join(_shown(one) for one in chosen)
    return text


def _shown(one: Declaration) -> str:
    name, body = one.code, paragraphs(one.comment)
    if one.kind != "function":
        macro = _MACRO.match(one.code)
        name = one.name + ((macro["arguments"] or "") if macro else "")
        body += f"\n\n```c\n{one.code}\n```"
    text = f"````{{c:{one.kind}}} {name}\n\n{body}\n````\n"
    return text + "".join(f"```{{c:function}} {other.code}\n```\n" for other in one.with_it)
