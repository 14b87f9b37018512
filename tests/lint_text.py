"""Part of `make lint`: lines of at most 120 columns, and comments that cite only files of the repository.

    python tests/lint_text.py      prints FILE:LINE of each fault; exit code 1 if there is any

Exempt from the length are tables, code blocks, headings and links in Markdown, code lines of TOML, CMake and make
(strings and lists that cannot be broken), generated files and data. clang-format and ruff format the code itself.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COLUMNS = 120
WHOLE = {".py", ".c", ".h", ".cpp", ".hpp", ".inc", ".mo", ".rs"}  # every line counts
COMMENTS = {".js", ".toml", ".cmake", ".sh", ".in", ".mk"}  # only lines that are comments count
GENERATED = ("modelica/GiveWay/Parameters/Trikey.mo",)
# A cited file: a name with an ending of ours. Names in capitals (NAME.cpp, STUDY.toml) stand for any file.
CITED = re.compile(r"(?<![\w./<{*$-])((?:[\w.-]+/)*[a-z][a-z0-9_-]*\.(?:md|py|toml|cpp|hpp|cmake|mo))(?![\w/(*])")
COMMENT = {
    ".py": re.compile(r"(?:^|\s)#(?P<text>.*)"),
    **dict.fromkeys((".c", ".h", ".cpp", ".hpp", ".js"), re.compile(r"(?://|/\*|^\s*\*\s)(?P<text>.*)")),
    **dict.fromkeys((".toml", ".cmake", ".sh", ".txt"), re.compile(r"^\s*#(?P<text>.*)")),
}
PRAGMA = re.compile(r"  # (?:type: ignore|noqa|fmt: skip).*$")
# Generated files, and names of users' files in examples.
OTHERS = {"plant_parameters.hpp", "part.cpp", "mine.toml", "case.toml", "robot.toml", "porter.toml", "tuned.toml"}
OWN_TEST = "tests/test_lint_text.py"


def tracked() -> list[str]:
    """Every file of the repository."""
    answer = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    return [name for name in answer.stdout.splitlines() if (ROOT / name).is_file()]


def prose(text: str) -> Iterator[tuple[int, str]]:
    """Number and text of the lines of a Markdown file, without code blocks, tables, headings and images."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced and not line.startswith(("    ", "|", "#", "![", "<")):
            yield number, line


def too_long(name: str, text: str) -> Iterator[str]:
    """The lines of ``name`` that are too long."""
    path = Path(name)
    if path.suffix == ".md":
        lines = prose(text)
    elif path.suffix in WHOLE and name not in GENERATED:
        lines = enumerate(text.splitlines(), 1)
    elif path.suffix in COMMENTS or path.name in ("Makefile", "CMakeLists.txt"):
        lines = ((number, line) for number, line in enumerate(text.splitlines(), 1) if line.lstrip().startswith("#"))
    else:
        return
    for number, line in lines:
        if len(PRAGMA.sub("", line)) > COLUMNS and not re.fullmatch(r"\S+|`[^`]*`\S*", line.strip()):
            yield f"{name}:{number}: {len(line)} columns, at most {COLUMNS}"


def cited(name: str, text: str) -> Iterator[tuple[int, str]]:
    """Line and name of each file that a comment or Markdown prose cites."""
    path = Path(name)
    if path.suffix == ".md":
        for number, line in prose(text):
            yield from ((number, found) for found in CITED.findall(re.sub(r"https?://\S+", "", line)))
        return
    pattern = COMMENT.get(path.suffix)
    for number, line in enumerate(text.splitlines() if pattern else [], 1):
        comment = pattern.search(line) if pattern else None
        if comment:
            yield from ((number, found) for found in CITED.findall(comment["text"]))


def findings(files: dict[str, str]) -> Iterator[str]:
    """Faults of ``files``, text by name."""
    names = {Path(name).name for name in files}
    for name, text in files.items():
        yield from too_long(name, text)
        for number, one in cited(name, text) if name != OWN_TEST else ():
            if Path(one).name not in names | OTHERS:
                yield f"{name}:{number}: cites {one}, which is not in the repository"


def main() -> int:
    """Print the faults of the repository; 1 if there are any."""
    files = {}
    for name in tracked():
        try:
            files[name] = (ROOT / name).read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
    faults = list(findings(files))
    print("\n".join(faults), end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
