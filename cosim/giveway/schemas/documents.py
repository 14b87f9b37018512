"""The schemas by kind, each from the shapes by which the files are read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from giveway.base.errors import UnknownNameError

if TYPE_CHECKING:
    from collections.abc import Callable

    from giveway.base.shapes import Table

__all__ = ["KINDS", "document", "file_name"]

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def _scenario() -> Table:
    from giveway.scenario.scenario_shape import scenario_shape

    return scenario_shape()


def _study() -> Table:
    from giveway.study.study_file import study_shape

    return study_shape()


def _robot() -> Table:
    from giveway.robot.robot_file import robot_shape

    return robot_shape()


def _summary() -> Table:
    from giveway.simulation.summary import SUMMARY

    return SUMMARY


def _variables() -> Table:
    from giveway.schemas.variable_table import variable_table_shape

    return variable_table_shape()


KINDS: dict[str, Callable[[], Table]] = {
    "scenario": _scenario,
    "study": _study,
    "robot": _robot,
    "variables": _variables,
    "summary": _summary,
}


def file_name(kind: str) -> str:
    """What the file is called, which the line ``#:schema`` of others names."""
    return f"{kind}.schema.json"


def document(kind: str) -> dict[str, Any]:
    """The JSON Schema of files of ``kind``."""
    if kind not in KINDS:
        raise UnknownNameError("KIND", kind, KINDS)
    return {"$schema": DIALECT, "title": f"giveway {kind}", **KINDS[kind]().schema()}
