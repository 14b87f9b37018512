"""A design exported: as parameters of an FMU (SSV), a scenario file or a list; and the table of all designs."""

from __future__ import annotations

import csv
import io
import math
import os
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np

from giveway.base.errors import GivewayError, UnknownNameError
from giveway.base.files import check_file, replace_file, write_text
from giveway.robot.variables import table as variable_table
from giveway.study.chosen import hit_of, settings_of_run
from giveway.study.influences import INFLUENCES
from giveway.study.observed_motors import following
from giveway.study.parts import part_lines
from giveway.study.runs import COVER

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from giveway.robot.variables import Value
    from giveway.study.answers import Answers

__all__ = ["MODELS", "export_design", "export_table", "powers"]

MODELS = ("testbed", "controller", "bumper")
SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
# Exponents of the SI base units and of rad, as ssc:BaseUnit wants them; the units of the variable tables.
_BASE_UNITS: dict[str, dict[str, int]] = {
    "m": {"m": 1},
    "kg": {"kg": 1},
    "s": {"s": 1},
    "rad": {"rad": 1},
    "Hz": {"s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
}


def export_design(
    answers: Answers, design: int, path: Path, *, collision: str | None = None, model: str = "testbed"
) -> None:
    """Write ``design`` to ``path``, whose ending says how: .ssv, .toml (for `giveway run`) or .csv.

    Args:
        answers: of the study.
        design: its number.
        path: file to write.
        collision: whose scenario, for .toml and .ssv; None: the first.
        model: whose parameters an .ssv holds: every one that is not at the start value of the FMU.

    Raises:
        GivewayError: no such design, collision, model or kind of file.
    """
    answers.check_design(design)
    check_file(path)
    names = [case.name for case in answers.setup.cases]
    if collision is not None and collision not in names:
        raise UnknownNameError("--collision", collision, names)
    case = 0 if collision is None else names.index(collision)
    writers: dict[str, Callable[[Answers, int, int, str], str]] = {
        ".ssv": _ssv,
        ".toml": partial(_toml, folder=path.resolve().parent),
        ".csv": _csv,
    }
    if path.suffix not in writers:
        raise GivewayError("--out", path, "a file that ends in .ssv, .toml or .csv")
    if model not in MODELS:
        raise UnknownNameError("--model", model, MODELS)
    write_text(path, writers[path.suffix](answers, design, case, model))


def export_table(answers: Answers, path: Path) -> None:
    """Write all designs with their goals to the CSV file ``path``."""
    check_file(path)
    if path.suffix != ".csv":
        raise GivewayError("--out", path, "a file that ends in .csv; other kinds need --design")
    import pyarrow
    import pyarrow.csv

    columns: dict[str, Any] = {"design": np.arange(len(answers.designs))}
    for j, one in enumerate(answers.setup.varied):
        quantity, values = one.quantity, answers.shown_designs(j)
        if quantity.kind == "choice":
            columns[quantity.name] = np.array(quantity.choices)[values.astype(np.intp)]
        else:
            columns[_named(quantity.name, one.unit.shown)] = _typed(quantity.kind, values)
    for j in answers.columns:
        columns[_named(answers.goal_name(j), answers.goal_unit(j).shown)] = answers.shown_values(j)
    columns |= {"feasible": answers.feasible, "pareto": answers.pareto, "failed runs": answers.failed}
    columns["warnings"] = [answers.warning_text(design) for design in range(len(answers.designs))]
    reasons = np.full(len(answers.designs), "", dtype=object)
    for design, reason in answers.reason.items():
        reasons[design] = reason
    columns["reason"] = reasons
    with replace_file(path) as temporary, temporary.open("wb") as file:
        arrays = {name: arrow_array(values) for name, values in columns.items()}
        pyarrow.csv.write_csv(pyarrow.table(arrays), file)


def arrow_array(values: Any) -> Any:
    """A pyarrow array of numbers, in which NaN (it did not happen) is nothing, of truths or of texts.

    Made of its buffers: `pyarrow.array` imports pandas, which takes longer than all that is written.
    """
    import pyarrow

    found = np.asarray(values)
    count = len(found)
    if found.dtype.kind == "f":
        there = ~np.isnan(found)
        buffers = [None if there.all() else _bits(there), pyarrow.py_buffer(np.ascontiguousarray(found, np.float64))]
        return pyarrow.Array.from_buffers(pyarrow.float64(), count, buffers)
    if found.dtype.kind == "b":
        return pyarrow.Array.from_buffers(pyarrow.bool_(), count, [None, _bits(found)])
    if found.dtype.kind == "i":
        number = np.ascontiguousarray(found, np.int64)
        return pyarrow.Array.from_buffers(pyarrow.int64(), count, [None, pyarrow.py_buffer(number)])
    texts = [str(text).encode() for text in found.tolist()]
    ends = np.concatenate([[0], np.cumsum([len(text) for text in texts])]).astype(np.int32)
    buffers = [None, pyarrow.py_buffer(ends), pyarrow.py_buffer(b"".join(texts))]
    return pyarrow.Array.from_buffers(pyarrow.string(), count, buffers)


def _bits(truths: NDArray[np.bool_]) -> Any:
    import pyarrow

    return pyarrow.py_buffer(np.packbits(truths, bitorder="little"))


def _named(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit not in ("", "1") else name


def _typed(kind: str, values: NDArray[np.float64]) -> NDArray[Any]:
    return values if kind == "real" else values.astype(np.bool_ if kind == "boolean" else np.int64)


def _truth(value: object) -> str:
    return "true" if value else "false"


def _seen_from(folder: Path, file: Path) -> str:
    """A relative path, so that both may move together; another drive has none."""
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:
        return str(file)


def _settings(answers: Answers, design: int, case: int) -> dict[str, dict[str, Value]]:
    return settings_of_run(answers.runs, design, 0, case)


def _csv(answers: Answers, design: int, _case: int, _model: str) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["quantity", "value", "unit"])
    for one, value in zip(answers.setup.varied, answers.designs[design], strict=True):
        writer.writerow([one.quantity.name, one.text(value), one.unit.name])
    return text.getvalue()


def _toml(answers: Answers, design: int, case: int, _model: str, folder: Path) -> str:
    """The scenario file of one run at nominal values: what the study's own file says, and the design's values."""
    import tomlkit

    study, table = answers.setup.cases[case], answers.runs
    document: dict[str, Any] = {**study.document, "name": f"{answers.setup.name}, design {design}"[:80]}
    settings, hit = settings_of_run(table, design, 0, case), hit_of(table, design, 0, case)
    quantities = [quantity for one in answers.setup.varied for quantity in one.sets]
    if study.hit is not None:
        document["collision"] = _collision(study.document["collision"], hit, settings, {one.name for one in quantities})
    changed = {table.columns.names[column] for one in answers.setup.varied for column in one.columns}
    if "body_region" in document and COVER in changed:  # the design states the stiffness of cover and body together
        document["judge_as"] = document.pop("body_region")
        document["collision"]["mass"] = settings["testbed"]["slider.mass"]
    bumper = document.get("bumper")
    numbers: dict[str, Value] = {}
    if isinstance(bumper, dict):  # what it states are parameters here, beside those of the design
        from giveway.scenario.stated_bumper import stated_bumper

        bumper, numbers = stated_bumper(bumper, answers.setup.folder)
    if any(one.name == "bumper" for one in quantities):
        from giveway.scenario.scenario import BUMPERS

        bumper = list(BUMPERS)[int(settings["testbed"]["bumper.kind"])]
    if bumper is not None:
        document["bumper"] = bumper
    if "robot" in document:
        document["robot"] = _seen_from(folder, (answers.folder / "robot.toml").resolve())
    for one in quantities:
        if one.name in INFLUENCES:
            changed |= INFLUENCES[one.name].factors.keys()
    changed |= set(following({one.name for one in quantities}))
    text = tomlkit.document()
    text.add(tomlkit.comment(f"Design {design} of the study {answers.setup.name!r}. Run it with `giveway run`."))
    for line in part_lines(answers.setup.varied, answers.designs[design]):
        text.add(tomlkit.comment(line))
    for key, value in document.items():
        if key not in ("testbed", "controller"):
            text[key] = value
    for model in ("testbed", "controller"):
        values = _flat(document.get(model, {})) | (numbers if model == "testbed" else {})
        for name in sorted(changed):
            owner, _, variable = name.partition(".")
            if owner == model and variable not in ("bumper.kind", "slider.mass", "contact.height", "electronics.seed"):
                values[variable] = settings[model][variable]
        if "testbed.electronics.seed" in changed and model == "testbed":
            text["seed"] = int(settings["testbed"]["electronics.seed"])
        if values:
            text[model] = _nested(values)
    return tomlkit.dumps(text)


def _collision(
    given: dict[str, Any], hit: dict[str, float], settings: dict[str, dict[str, Value]], varied: set[str]
) -> dict[str, Any]:
    """``[collision]`` of a design; what does not vary stays as it was written."""
    found = dict(given)
    for name in ("speed", "time", "offset", "direction"):
        if f"collision.{name}" in varied:
            found[name] = hit[name]
    for name, variable in (("mass", "slider.mass"), ("height", "contact.height")):
        if f"collision.{name}" in varied:
            found[name] = float(settings["testbed"][variable])
    if "collision.around" in varied or "collision.angle" in varied:
        found["direction"] = math.degrees(float(settings["testbed"]["slider.direction"]))
    if "collision.around" in varied:
        for name in ("edge", "offset"):
            found.pop(name, None)
        found["point"] = [hit["point_x"], hit["point_y"]]
    return found


def _flat(values: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    from giveway.scenario.scenario_file import scalars

    return dict(scalars(values, prefix))


def _nested(values: dict[str, Any]) -> dict[str, Any]:
    """``slider.friction`` as a table of tables; ``x[0]`` to ``x[n]`` as a list."""
    found: dict[str, Any] = {}
    for name, value in values.items():
        *tables, key = name.split(".")
        at = found
        for part in tables:
            at = at.setdefault(part, {})
        base, bracket, index = key.partition("[")
        if bracket:
            entries = at.setdefault(base, [])
            if len(entries) != int(index.rstrip("]")):
                raise GivewayError(name, value, "all values of the list before it")
            entries.append(value)
        else:
            at[key] = value
    return found


def _ssv(answers: Answers, design: int, case: int, model: str) -> str:
    """The parameters of one FMU as a System Structure Parameter Values 1.0 document."""
    settings = _settings(answers, design, case)
    variables = variable_table(model)
    values = settings["testbed" if model == "bumper" else model]
    kept = {name: value for name, value in values.items() if name in variables}
    kept = {name: value for name, value in kept.items() if variables[name].causality == "parameter"}
    if not kept:
        raise GivewayError("--model", model, "a model of which the study sets some parameter")
    ElementTree.register_namespace("ssv", SSV)
    ElementTree.register_namespace("ssc", SSC)
    name = f"{answers.setup.name}, design {design}"
    told = part_lines(answers.setup.varied, answers.designs[design])
    about = {"version": "1.0", "name": name} | ({"description": "; ".join(told)} if told else {})
    root = ElementTree.Element(f"{{{SSV}}}ParameterSet", about)
    parameters = ElementTree.SubElement(root, f"{{{SSV}}}Parameters")
    units: set[str] = set()
    for variable, value in kept.items():
        entry = ElementTree.SubElement(parameters, f"{{{SSV}}}Parameter", {"name": variable})
        if isinstance(value, bool):
            ElementTree.SubElement(entry, f"{{{SSV}}}Boolean", {"value": _truth(value)})
        elif isinstance(value, int):
            ElementTree.SubElement(entry, f"{{{SSV}}}Integer", {"value": str(value)})
        else:
            unit = variables[variable].unit
            attributes = {"value": repr(float(value))} | ({"unit": unit} if unit != "1" else {})
            units |= {unit} - {"1"}
            ElementTree.SubElement(entry, f"{{{SSV}}}Real", attributes)
    if units:
        listed = ElementTree.SubElement(root, f"{{{SSV}}}Units")
        for unit in sorted(units):
            entry = ElementTree.SubElement(listed, f"{{{SSC}}}Unit", {"name": unit})
            exponents = {key: str(power) for key, power in powers(unit).items() if power}
            ElementTree.SubElement(entry, f"{{{SSC}}}BaseUnit", exponents)
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def powers(unit: str) -> dict[str, int]:
    """Exponents of the base units in ``N.m.s/rad``."""
    found: dict[str, int] = {}
    above, _, below = unit.partition("/")
    for part, sign in ((above, 1), (below, -1)):
        for word in part.split(".") if part and part != "1" else ():
            name, power = (word[:-1], int(word[-1])) if word[-1].isdigit() else (word, 1)
            for base, exponent in _BASE_UNITS[name].items():
                found[base] = found.get(base, 0) + sign * power * exponent
    return found
