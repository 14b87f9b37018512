"""The studio's data: every parameter of testbed and controller, the shipped robots, the body regions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from giveway.base import native
from giveway.base.version import VERSION
from giveway.report.page import page
from giveway.robot.robot_file import read_robot
from giveway.robot.table_files import read_table_file
from giveway.robot.variables import Variable, table
from giveway.scenario.body_regions import NOTICE, body_regions
from giveway.study.export import powers

__all__ = ["studio_data", "studio_page"]

TITLE = "giveway studio"


def studio_page() -> str:
    """The text of the whole page."""
    return page("studio", TITLE, studio_data(), body=_BODY, engine=True)


def studio_data() -> dict[str, Any]:
    """What the page is filled with; names are full ("testbed.slider.mass")."""
    variables = [(model, variable) for model in native.MODELS for variable in table(model)]
    parameters = [_parameter(model, v) for model, v in variables if v.causality == "parameter" and v.start is not None]
    units = sorted({entry["unit"] for entry in parameters} - {"", "1"})
    return {
        "version": VERSION,
        "variables": parameters,
        "robots": dict(_robots()),
        "regions": [
            {"name": region.name, "transient_n": region.peak_limit_n, "lasting_n": region.lasting_limit_n}
            for region in body_regions().values()
        ],
        "notice": NOTICE,
        "units": {unit: {base: power for base, power in powers(unit).items() if power} for unit in units},
        "traces": {f"{model}.{v.name}": v.unit for model, v in variables if v.causality != "parameter"},
    }


def _parameter(model: str, variable: Variable) -> dict[str, Any]:
    boolean = variable.type == "boolean"
    return {
        "name": f"{model}.{variable.name}",
        "type": variable.type,
        "unit": variable.unit,
        "minimum": 0.0 if boolean else variable.minimum,
        "maximum": 1.0 if boolean else variable.maximum,
        "start": variable.start,
        "paper": variable.paper,
        "description": variable.description,
        "choices": _choices(model).get(variable.name),
    }


def _choices(model: str) -> dict[str, list[str]]:
    """Words for the values of whole numbers, from 0 on, where the table has them."""
    entries = read_table_file(native.variables(model))["variable"]
    return {entry["name"]: entry["choices"] for entry in entries if "choices" in entry}


def _robots() -> Iterator[tuple[str, dict[str, Any]]]:
    """The shipped robot files, the default robot's first."""
    for path in sorted(native.robots().values(), key=lambda path: (path != native.robot(), path.name)):
        robot = read_robot(path)
        stated = {model: table(model).robot_values(robot) for model in native.MODELS}
        values = {f"{model}.{name}": value for model in native.MODELS for name, value in stated[model].items()}
        yield path.stem, {"title": robot.name, "values": values}


_BODY = """
<header>
<h1>giveway studio</h1>
<p class="lead">A slider hits a resting robot, which feels it in its wheels and gives way. Every change is computed at
once, on this page.</p>
</header>
<p id="faults" class="warning" role="alert" hidden></p>
<div class="bench">
<section class="card hits" aria-label="collision">
<div class="buttons">
<button type="button" id="design-A" aria-pressed="true">Design A</button>
<button type="button" id="design-B" aria-pressed="false" hidden>Design B</button>
<button type="button" id="second">Compare with a second design</button>
<button type="button" id="undo">Undo</button>
<button type="button" id="redo">Redo</button>
</div>
<div class="choices">
<label>robot <select id="robot"></select></label>
<label>bumper <select id="bumper"></select></label>
<label>reflex <select id="preset"></select></label>
<label>judged as <select id="region"></select></label>
<label>duration, s <input id="duration" type="text" inputmode="decimal" autocomplete="off"></label>
</div>
<div id="scene"></div>
<p class="note"><span class="key"></span>true force <span class="key estimate"></span>estimate
<span class="key detected"></span>at the moment of notice. Drag on the picture to move the hit.</p>
<div id="hit" class="hit"></div>
</section>
<div class="seen">
<section class="card" aria-label="curves">
<h2>Curves</h2>
<div id="curves"></div>
<p class="note">Drag across a curve to zoom all of them; a double click shows everything again.</p>
</section>
<section class="card" aria-label="numbers">
<h2>Numbers</h2>
<div class="scroll" tabindex="0" role="region" aria-label="numbers of the collision"><table id="numbers"></table></div>
</section>
<section class="card" aria-label="take away">
<h2>Take it away</h2>
<div class="buttons">
<button type="button" id="toml">Scenario (TOML)</button>
<button type="button" id="ssv">Parameter set (SSV)</button>
<button type="button" id="csv">Curves (CSV)</button>
<button type="button" id="again">Start again</button>
</div>
<p class="note">The address of this page holds the designs: send it as a link. <code>giveway run</code> runs the
scenario with the same bits.</p>
</section>
</div>
<section class="card sets" aria-label="parameters">
<h2>Parameters</h2>
<div id="parameters"></div>
</section>
</div>
"""
