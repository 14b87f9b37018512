"""`--json` and `--quiet`, which every command has without naming them."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Annotated, Any

import typer

from giveway.base.terminal import want_json, want_quiet

__all__ = ["OUTPUT_OPTIONS", "with_output_options"]

_JSON = typer.Option("--json", help="One JSON document on stdout and nothing else: tables as rows, with units.")
_QUIET = typer.Option("--quiet", "-q", help="No progress and no text, only errors.")
OUTPUT_OPTIONS = {"as_json": (_JSON, want_json), "quiet": (_QUIET, want_quiet)}


def with_output_options(app: typer.Typer) -> None:
    """Give the options to all commands of ``app`` and its groups, and to what stands before them."""
    if app.registered_callback is not None and app.registered_callback.callback is not None:
        app.registered_callback.callback = _with_options(app.registered_callback.callback)
    for command in app.registered_commands:
        if command.callback is not None:
            command.callback = _with_options(command.callback)
    for group in app.registered_groups:
        if group.typer_instance is not None:
            with_output_options(group.typer_instance)


def _with_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """``command`` with the options behind its own, as Typer reads them from its signature."""

    @functools.wraps(command)
    def with_them(*args: Any, **given: Any) -> Any:
        for name, (_, want) in OUTPUT_OPTIONS.items():
            if given.pop(name):
                want()
        return command(*args, **given)

    own = inspect.signature(command, eval_str=True)
    kind = inspect.Parameter.KEYWORD_ONLY
    added = [
        inspect.Parameter(name, kind, default=False, annotation=Annotated[bool, option])
        for name, (option, _) in OUTPUT_OPTIONS.items()
    ]
    parameters = [*own.parameters.values(), *added]
    with_them.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
    with_them.__annotations__ = {one.name: one.annotation for one in parameters}
    return with_them
