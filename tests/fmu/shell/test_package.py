"""What is packed with the binary: platforms, icon, page, licences, and the types and units of the descriptions."""

from __future__ import annotations

import struct
import zipfile
from html.parser import HTMLParser
from pathlib import Path

import fmpy
import matplotlib.image
import numpy as np
import pytest
from fmu_driver import INTEGRATED, MODELS, fmu_path
from giveway_codegen.mathml import mathml
from giveway_codegen.package import write_fmu
from giveway_codegen.universal import universal_binary
from lxml import etree

EVERY_FMU = [(model, version) for model in MODELS for version in (2, 3)]
SCHEMAS = Path(fmpy.__file__).parent / "schema"


def member(model: str, version: int, name: str) -> bytes:
    with zipfile.ZipFile(fmu_path(model, version)) as archive:
        return archive.read(name)


def description(model: str, version: int) -> etree._Element:
    return etree.fromstring(member(model, version, "modelDescription.xml"))


def schema_errors(document: etree._Element, version: int, name: str) -> list[str]:
    schema = etree.XMLSchema(etree.parse(SCHEMAS / f"fmi{version}" / f"fmi{version}{name}.xsd"))
    schema.validate(document)
    return [str(error.message) for error in schema.error_log]


@pytest.mark.parametrize(("model", "version"), EVERY_FMU)
def test_descriptions_follow_the_schema(model: str, version: int) -> None:
    document = description(model, version)
    assert schema_errors(document, version, "ModelDescription") == []
    document.find("UnitDefinitions").append(etree.Element("Planted"))
    assert schema_errors(document, version, "ModelDescription")


def variables(model: str, version: int) -> list[dict[str, str]]:
    """Attributes of each variable, those of its type element included."""
    found = []
    for element in description(model, version).find("ModelVariables"):
        inner = element[0] if version == 2 else element
        found.append({**element.attrib, **inner.attrib, "tag": inner.tag})
    return found


def effective(variable: dict[str, str], types: dict[str, dict[str, str]], name: str) -> str:
    """An attribute of a variable: its own, or else that of its type."""
    return variable.get(name) or types.get(variable.get("declaredType", ""), {}).get(name, "")


def type_definitions(model: str, version: int) -> dict[str, dict[str, str]]:
    elements = description(model, version).find("TypeDefinitions")
    return {e.get("name"): {**e.attrib, **(e[0].attrib if version == 2 else {})} for e in elements}


@pytest.mark.parametrize(("model", "version"), EVERY_FMU)
def test_every_variable_has_type_unit_nominal_and_description(model: str, version: int) -> None:
    types = type_definitions(model, version)
    real = {2: "Real", 3: "Float64"}[version]
    for variable in variables(model, version):
        name = variable["name"]
        assert variable["description"], name
        if variable["causality"] == "independent" or name.startswith(("indicator.", "event.")):
            continue
        declared = types[variable["declaredType"]]
        # The variable takes unit and nominal from its type and does not repeat them.
        assert not {"unit", "displayUnit"} & set(variable), name
        assert "nominal" not in variable or variable["nominal"] != declared.get("nominal"), name
        if "min" in declared:
            assert float(variable["min"]) >= float(declared["min"]), name
        if variable["tag"] == real:
            assert declared["unit"], name
            assert float(effective(variable, types, "nominal")) > 0, name
    used = {variable.get("declaredType") for variable in variables(model, version)}
    assert set(types) <= used


@pytest.mark.parametrize("model", MODELS)
def test_bounded_types_bound(model: str) -> None:
    """Some types are for quantities that are never negative; starts below zero would violate them."""
    types = type_definitions(model, 3)
    bounded = {name for name, attributes in types.items() if attributes.get("min") == "0.0"}
    assert bounded
    for variable in variables(model, 3):
        if variable.get("declaredType") in bounded:
            assert float(variable.get("start", 0.0)) >= 0.0


@pytest.mark.parametrize(("model", "version"), EVERY_FMU)
def test_units_are_si_and_display_units_convert(model: str, version: int) -> None:
    """Against the definitions of the units, repeated here."""
    units = {unit.name: unit for unit in fmpy.read_model_description(str(fmu_path(model, version))).unitDefinitions}
    exact = {
        "mm": 1000.0, "cm": 100.0, "deg": 180 / np.pi, "deg/s": 180 / np.pi, "rpm": 60 / (2 * np.pi), "ms": 1000.0,
        "mm/s": 1000.0, "km/h": 3.6, "%": 100.0, "mJ": 1000.0, "g": 1000.0, "N/mm": 0.001, "deg/s2": 180 / np.pi,
        "N.m/deg": np.pi / 180,
    }  # fmt: skip
    shown = {name: unit for u in units.values() for name, unit in ((d.name, d) for d in u.displayUnits)}
    assert set(shown) <= set(exact)
    assert len(shown) > 3
    for name, display in shown.items():
        assert display.factor == pytest.approx(exact[name], rel=1e-15)
        assert display.offset == 0.0
    types, checked = type_definitions(model, version), 0
    for variable in variables(model, version):
        if display := effective(variable, types, "displayUnit"):
            checked += 1
            assert display in {d.name for d in units[effective(variable, types, "unit")].displayUnits}
    assert checked > 5
    joule = units["J" if model in INTEGRATED else "N.m"].baseUnit
    assert (joule.kg, joule.m, joule.s, joule.rad, joule.factor) == (1, 2, -2, 0, 1.0)


@pytest.mark.parametrize(("model", "version"), EVERY_FMU)
def test_dependencies_are_said_for_every_unknown(model: str, version: int) -> None:
    """Left out they would mean: all inputs."""
    structure = description(model, version).find("ModelStructure")
    unknowns = [
        e for e in structure.iter() if e.get("index") or (e.get("valueReference") and e.tag != "EventIndicator")
    ]
    assert unknowns
    assert all(e.get("dependencies") is not None for e in unknowns)


@pytest.mark.parametrize(("model", "version"), EVERY_FMU)
def test_default_experiment(model: str, version: int) -> None:
    experiment = dict(description(model, version).find("DefaultExperiment").attrib)
    tolerance = {"tolerance": "1e-06"} if model in INTEGRATED else {}
    assert experiment == {"startTime": "0.0", "stopTime": "1.0", "stepSize": "0.001", **tolerance}


class _Page(HTMLParser):
    """Collects what a page is made of, and notices elements that are not closed."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.links: list[str] = []
        self.code: list[str] = []
        self.equations = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag != "meta":
            self.open.append(tag)
        self.links += [str(value) for name, value in attrs if name in ("src", "href")]
        self.equations += tag == "math" and ("display", "block") in attrs

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] == "code":
            self.code.append(data)


@pytest.mark.parametrize(("model", "version"), EVERY_FMU)
def test_the_page_has_equations_and_every_variable(model: str, version: int) -> None:
    page = _Page()
    page.feed(member(model, version, "documentation/index.html").decode())
    page.close()
    assert page.open == []
    assert page.equations >= 4
    names = {variable["name"] for variable in variables(model, version)} - {"time"}
    assert names <= set(page.code)
    with zipfile.ZipFile(fmu_path(model, version)) as archive:  # no network resources
        assert {f"documentation/{link}" for link in page.links} <= set(archive.namelist())


def test_mathematics_becomes_mathml() -> None:
    found = etree.fromstring(mathml("F_x,i^2 = dot(q) ( a - 1.5 )"))
    tag = {"m": "http://www.w3.org/1998/Math/MathML"}
    assert ["".join(e.itertext()) for e in found.iterfind(".//m:msubsup", tag)] == ["Fx,i2"]
    assert ["".join(e.itertext()) for e in found.iterfind(".//m:mover", tag)] == ["q."]
    assert "".join(found.itertext()) == "Fx,i2=q.(a\u22121.5)"


@pytest.mark.parametrize("text", ["a = (b", "a ) b", "dot x", "a ? b", "a_"])
def test_wrong_mathematics_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"missing|not understood|never opened"):
        mathml(text)


@pytest.mark.parametrize("model", MODELS)
def test_the_icon_is_a_picture(model: str, tmp_path: Path) -> None:
    icon = member(model, 3, "terminalsAndIcons/icon.png")
    assert icon == member(model, 2, "model.png")
    (tmp_path / "icon.png").write_bytes(icon)
    pixels = matplotlib.image.imread(tmp_path / "icon.png")
    assert pixels.shape == (128, 128, 4)
    drawn = pixels[..., 3] > 0.5
    assert 0.15 < drawn.mean() < 0.7  # a drawing on a transparent background
    assert not drawn[0].any()
    assert not drawn[-1].any()
    assert len({tuple(colour) for colour in (pixels[drawn] * 255).astype(int)}) >= 3
    drawing = etree.fromstring(member(model, 3, "terminalsAndIcons/icon.svg"))
    assert len(drawing) >= 5


def fake_library(processor: int, size: int) -> bytes:
    return struct.pack("<III", 0xFEEDFACF, processor, 3) + bytes(range(256))[: size - 12]


def test_a_universal_binary_holds_both_images() -> None:
    images = [fake_library(0x01000007, 100), fake_library(0x0100000C, 200)]
    data = universal_binary(images)
    magic, count = struct.unpack_from(">II", data)
    assert (magic, count) == (0xCAFEBABE, 2)
    for i, image in enumerate(images):
        processor, _, offset, size, alignment = struct.unpack_from(">IIIII", data, 8 + 20 * i)
        assert processor == struct.unpack_from("<I", image, 4)[0]
        assert offset % (1 << alignment) == 0
        assert data[offset : offset + size] == image
    assert len(data) == 2 * 16384 + 200
    with pytest.raises(ValueError, match="not a 64-bit Mach-O file"):
        universal_binary([b"\x7fELF" + bytes(60)])


def test_each_fmi_version_has_its_folders(tmp_path: Path) -> None:
    """FMI 2 names x86 itself and takes the tuples of FMI 3 for the rest."""
    binaries = {}
    processors = {"x86_64": 0x01000007, "aarch64": 0x0100000C}
    for platform, suffix in {
        "x86_64-linux": "so", "aarch64-linux": "so", "x86_64-windows": "dll", "x86_64-darwin": "dylib",
        "aarch64-darwin": "dylib",
    }.items():  # fmt: skip
        path = tmp_path / platform / f"lib.{suffix}"
        path.parent.mkdir()
        path.write_bytes(fake_library(processors[platform.split("-")[0]], 64))
        binaries[platform] = path
    names = {}
    for version in (2, 3):
        write_fmu(version, tmp_path / "generated", binaries, {}, tmp_path / f"{version}.fmu")
        with zipfile.ZipFile(tmp_path / f"{version}.fmu") as archive:
            names[version] = {name.split("/")[1]: archive.read(name) for name in archive.namelist()}
    assert set(names[3]) == set(binaries)
    assert set(names[2]) == {"linux64", "aarch64-linux", "win64", "darwin64", "aarch64-darwin"}
    assert names[2]["darwin64"] == universal_binary([names[3]["x86_64-darwin"], names[3]["aarch64-darwin"]])
