"""The code blocks of a page of the site, run one after the other in one folder, as a reader would.

    ```console      each line after "$ " is a command; the lines below it are what it prints, "..." stands for anything
    ```python       is executed; names stay for the page's next block
    ```{code-block} toml       with a `:caption:`, is written to the file of that name

A block in another language, or one that is indented, shows something and runs nothing; any other is run, or
has a line `% not run: why` above it, `% takes long: why` (only the deep tests run it, and no block that needs it stands
without), or `% needs PROGRAM, PROGRAM` (run where they are).
"""

from __future__ import annotations

import contextlib
import doctest
import io
import math
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from giveway.cli import _main
from giveway.study import command as study_command

ROOT = Path(__file__).parents[2]
SITE = ROOT / "docs" / "site"
SHOWN = {"", "text", "c", "toml", "csv", "json", "modelica"}  # languages of blocks that nobody runs
_FENCE = re.compile(r"^(?P<fence>`{3,})(?P<language>\{?[\w-]*\}?)[ ]*(?P<argument>[^`]*)$")
_FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@dataclass(frozen=True)
class Block:
    """A fenced block: where it begins, what it is, and what stands above and in it."""

    line: int
    language: str
    above: str
    text: str
    caption: str = ""


def blocks(page: str) -> Iterator[Block]:
    """Every fenced block of a page that is no directive but {code-block}."""
    lines = page.splitlines()
    row = 0
    while row < len(lines):
        fence = _FENCE.match(lines[row])
        first, row = row, row + 1
        if fence is None:
            continue
        last = next(at for at in range(row, len(lines)) if lines[at] == fence["fence"])
        body, row = lines[row:last], last + 1
        above = lines[first - 1] if first else ""
        if fence["language"] == "{code-block}":
            caption = next((line.removeprefix(":caption: ") for line in body if line.startswith(":caption: ")), "")
            code = [line for line in body if not re.match(r":\w+:", line)]
            yield Block(first + 1, fence["argument"], above, "\n".join(code).strip() + "\n", caption)
        elif not fence["language"].startswith("{"):
            yield Block(first + 1, fence["language"], above, "\n".join(body) + "\n")


def run_page(name: str, folder: Path, *, whole: bool = True) -> None:
    """Run the blocks of ``name`` in ``folder``; AssertionError with file and line of what went otherwise.

    If not the ``whole`` page, without the blocks that take long.
    """
    names: dict[str, object] = {}
    for block in blocks((SITE / name).read_text(encoding="utf-8")):
        where = f"docs/site/{name}:{block.line}"
        if block.above.startswith("% not run: ") or (block.above.startswith("% takes long: ") and not whole):
            continue
        if block.above.startswith("% needs ") and not all(
            map(shutil.which, block.above.removeprefix("% needs ").split(", "))
        ):
            continue
        if block.caption:
            (folder / block.caption).write_text(block.text, encoding="utf-8")
        elif block.language == "console":
            for command, expected in _commands(block.text, where):
                _check(where, command, expected, *_run(command, folder))
        elif block.language == "python":
            with contextlib.chdir(folder):
                exec(compile("\n" * block.line + block.text, str(SITE / name), "exec"), names)
        else:
            assert block.language in SHOWN, f"{where}: {block.language} is neither run nor known as what is only shown"


def _commands(text: str, where: str) -> Iterator[tuple[str, str]]:
    """Each command and what it should print."""
    parts = re.split(r"^\$ ((?:.*\\\n)*.*)\n", text, flags=re.MULTILINE)
    assert not parts[0], f"{where}: a console begins with a command"
    for command, expected in zip(parts[1::2], parts[2::2], strict=True):
        yield command.replace("\\\n", " "), expected


def _run(command: str, folder: Path) -> tuple[int, str]:
    """Exit code and output. `giveway` runs in this process: its imports are dear."""
    words = shlex.split(command)
    if words[0] != "giveway" or "|" in words or ">" in words:
        path = f"{Path(sys.executable).parent}:/usr/local/bin:/usr/bin:/bin"
        answer = subprocess.run(
            ["bash", "-c", command],
            cwd=folder,
            env={"PATH": path, "HOME": str(folder), "LC_ALL": "C.UTF-8"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        return answer.returncode, answer.stdout
    said = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True)
    # A busy machine says that it is reading the runs.
    quick = mock.patch.object(study_command, "QUICK_S", math.inf)
    with quick, contextlib.chdir(folder), redirect_stdout(said), redirect_stderr(said):
        code = _main(words[1:])
    return code, said.buffer.getvalue().decode()  # type: ignore[attr-defined]


def _check(where: str, command: str, expected: str, code: int, found: str) -> None:
    refused = re.search(r"^giveway: ", expected, re.MULTILINE)
    assert code == (2 if refused else 0), f"{where}: $ {command}\nexit code {code}\n{found}"
    if expected.strip():
        same = doctest.OutputChecker().check_output(_plain(expected), _plain(found), _FLAGS)
        assert same, f"{where}: $ {command}\nexpected\n{expected}\nfound\n{found}"


def _plain(text: str) -> str:
    """Without the lines of tables."""
    return "\n".join(line.strip() for line in text.splitlines() if line.strip(" ─━")) + "\n"
