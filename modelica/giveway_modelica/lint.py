"""Does the package keep the conventions of the Modelica Standard Library? No tool at hand tells."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from html.parser import HTMLParser
from pathlib import Path

from giveway_modelica.compiler import CLASS, PACKAGE, ModelicaClass, classes
from giveway_modelica.statements import STRING, body, cut, declarations

INFO = re.compile(r'Documentation\(info="((?:[^"\\]|\\.)*)"', re.DOTALL)
EXPERIMENT = re.compile(r"experiment\(StopTime=[\d.e-]+, Tolerance=[\d.e-]+, Interval=[\d.e-]+\)")
# Turns vectors of any unit: what goes in comes out.
ANY_UNIT = ("GiveWay.Functions.rotate",)
NEVER_CLOSED = ("br", "hr", "img")


def findings(package: Path = PACKAGE) -> Iterator[str]:
    """Everything that is against the conventions, as "file: what"."""
    every = {found.name: found for found in classes(package)}
    for found in every.values():
        faults = (
            *_layout(found, package),
            *_documentation(found),
            *_icon(found),
            *_declarations(found),
            *_diagram(found, every),
        )
        for fault in faults:
            yield f"{found.path.relative_to(package)}: {fault}"
    for folder in sorted(path.parent for path in package.rglob("package.mo")):
        yield from _order(folder, package)


def _layout(found: ModelicaClass, package: Path) -> Iterator[str]:
    parent, _, name = found.name.rpartition(".")
    within, _, rest = found.text.partition("\n")
    if within != (f"within {parent};" if parent else "within ;"):
        yield f"the first line is not `within {parent};`"
    heads = [head[3] for head in CLASS.finditer(STRING.sub('""', rest))]
    if heads != [name]:
        yield f"has the classes {heads}, not {name} alone"
    short = re.search(rf"\b{name} = ", rest)
    if not short and not rest.rstrip().endswith(f"end {name};"):
        yield f"does not end with `end {name};`"
    if not parent:
        for wanted in (r'(?<!\()version="[\d.]+"', r'uses\(Modelica\(version="[\d.]+"\)\)'):
            if not re.search(wanted, found.text):
                yield f"the root has no annotation like {wanted}"


def _order(folder: Path, package: Path) -> Iterator[str]:
    there = {path.stem for path in folder.glob("*.mo")} - {"package"}
    there |= {path.name for path in folder.iterdir() if (path / "package.mo").exists()}
    order = (folder / "package.order").read_text().split()
    if sorted(order) != sorted(there):
        wrong = sorted(set(order) ^ there) or "a name twice"
        yield f"{(folder / 'package.order').relative_to(package)}: does not list what is there: {wrong}"


class _Tags(HTMLParser):
    """Are all elements closed in turn?"""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.wrong = ""
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in NEVER_CLOSED:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.wrong = self.wrong or tag

    def handle_data(self, data: str) -> None:
        self.text += data


def _documentation(found: ModelicaClass) -> Iterator[str]:
    name = found.name.rsplit(".", 1)[-1]
    short = re.search(rf'\b{name} = [\w. ]+ "[^"]+"', found.text)
    if not short and not re.search(rf'\b{name} "[^"]+"', found.text):
        yield "the class has no description"
    info = INFO.search(found.text)
    if info is None:
        yield "no documentation"
        return
    tags = _Tags()
    tags.feed(info[1].replace('\\"', '"'))
    if tags.wrong or tags.open:
        yield f"HTML: <{tags.wrong or tags.open[-1]}> is not closed in turn"
    if not info[1].strip().startswith("<html>") or len(tags.text.split()) < 2:
        yield "the documentation says nothing"


def _icon(found: ModelicaClass) -> Iterator[str]:
    own = "Icon(" in found.text and "%name" in found.text
    if not own and "extends Modelica.Icons." not in found.text:
        yield "no icon with %name, nor one of Modelica.Icons"
    runs = found.name.startswith(("GiveWay.Examples.", "GiveWay.Tests."))
    if runs and "extends Modelica.Icons.Example;" not in found.text:
        yield "does not extend Modelica.Icons.Example"
    if runs and not EXPERIMENT.search(found.text):
        yield "no experiment annotation with StopTime, Tolerance and Interval"


def _declarations(found: ModelicaClass) -> Iterator[str]:
    for one in declarations(found.text, found.name.rsplit(".", 1)[-1]):
        if not one.description:
            yield f"{one.name} has no description"
        if one.type == "Real" and not re.search(r'\bunit="[^"]+"', one.rest) and found.name not in ANY_UNIT:
            yield f"{one.name} is a Real without a unit"


def _diagram(found: ModelicaClass, every: Mapping[str, ModelicaClass]) -> Iterator[str]:
    """Without places and lines Dymola and OpenModelica show an empty diagram, and no connectors at the icon."""
    if found.kind not in ("model", "block"):
        return
    name = found.name.rsplit(".", 1)[-1]
    for one in declarations(found.text, name):
        kind = re.search(rf"replaceable model {one.type} = ([\w.]+)", found.text)
        shown = _resolved(kind[1] if kind else one.type, found.name, every)
        if (
            shown in every
            and every[shown].kind in ("model", "block", "connector")
            and "Placement(" not in one.annotation
        ):
            yield f"{one.name} has no Placement"
    for statement in cut(body(found.text, name)):
        tied = re.search(r"\bconnect\([^)]*\)", statement)
        if tied and "annotation (Line(" not in statement:
            yield f"{tied[0]} has no Line"


def _resolved(type_name: str, inside: str, every: Mapping[str, ModelicaClass]) -> str:
    """Full name of a class of the package that is named ``type_name`` in class ``inside``; "" for others."""
    scope = inside.rpartition(".")[0]
    while scope:
        if f"{scope}.{type_name}" in every:
            return f"{scope}.{type_name}"
        scope = scope.rpartition(".")[0]
    return ""
