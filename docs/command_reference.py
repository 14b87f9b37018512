"""Every command of the command line, from the parser itself."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from giveway.base.terminal import EXIT_CODES

from docs.markdown import paragraphs, table

__all__ = ["pages"]

VALUES = {int: "N", float: "X", Path: "FILE"}
HEAD = """# Command line

`giveway COMMAND --help` says the same at a terminal. `giveway --install-completion` completes commands and options in
bash, zsh and fish.

## Exit codes

"""


def pages(root: Path) -> dict[str, str]:
    """The page of all commands; they come from the package, not from files below ``root``."""
    import typer
    from giveway.cli import app

    group = typer.main.get_command(app)
    codes = table(("code", ""), ((f"`{code}`", paragraphs(meaning)) for code, meaning in EXIT_CODES.items()))
    return {"reference/command_line.md": f"{HEAD}{codes}\n{''.join(_sections('giveway', group))}"}


def _sections(name: str, command: Any) -> Iterator[str]:
    children = getattr(command, "commands", {})
    label = name.replace(" ", "-")
    yield f"({label})=\n## `{name}`\n\n{paragraphs(_plain(command.help))}\n\n"
    arguments = [one for one in command.params if one.param_type_name == "argument"]
    options = [one for one in command.params if one.param_type_name == "option"]
    if not children:
        words = [name, *(_argument(one) for one in arguments), *(["[OPTIONS]"] if options else [])]
        yield f"```text\n{' '.join(words)}\n```\n\n"
    rows = [(f"`{_argument(one)}`", paragraphs(_plain(one.help))) for one in arguments]
    rows += [(_names(one), paragraphs(_help(one))) for one in options if not one.hidden]
    if rows:
        yield table(("", ""), rows) + "\n"
    for child in children:
        yield from _sections(f"{name} {child}", children[child])


def _plain(text: str | None) -> str:
    """A help without the backslashes that keep its brackets at a terminal."""
    return (text or "").replace("\\[", "[")


def _argument(one: Any) -> str:
    name = str(one.metavar or one.name.upper())
    return f"{name}..." if one.nargs == -1 and not name.endswith("...") else name


def _names(option: Any) -> str:
    names = ", ".join(f"`{name}`" for name in (*option.opts, *option.secondary_opts))
    kind = option.type_descriptor.annotation
    metavar = option.metavar or VALUES.get(kind, "TEXT")
    return names if option.is_flag else f"{names} `{metavar}`"


def _help(option: Any) -> str:
    told = [_plain(option.help)]
    if option.required:
        told.append("Required.")
    default = getattr(option, "show_default", True) and not option.is_flag and option.default
    if default not in (None, False, (), []) and not callable(default):
        told.append(f"Default: `{default}`.")
    return " ".join(told)
