"""Run by the build: ``python -m giveway_codegen sources ...`` and ``python -m giveway_codegen package ...``."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from . import c_core, cpp, documentation, fmi, icon, plant, source_code, toml
from .errors import TableError
from .package import PLATFORMS, write_fmu
from .table import Table, expanded, read_table


def _pictures(table: Table) -> dict[str, bytes]:
    """The icon at the path that each FMI version expects; a model without a picture has none."""
    shapes = icon.PICTURES.get(table.name)
    if shapes is None:
        return {}
    picture = icon.png(shapes)
    return {
        "fmi2/model.png": picture,
        "fmi3/terminalsAndIcons/icon.png": picture,
        "fmi3/terminalsAndIcons/icon.svg": icon.svg(shapes).encode(),
    }


def _shipped(table: Table, files: list[Path], generated: dict[str, str]) -> dict[str, bytes]:
    """The folder ``sources`` of both FMI versions."""
    contents: dict[str, bytes] = {}
    for version in (2, 3):
        folder = f"fmi{version}/sources"
        for path in files:
            if path.name != f"fmi{5 - version}_shell.cpp":  # without the other version's functions
                # c_core includes its headers by their folder.
                name = f"giveway/{path.name}" if path.parent.name == "giveway" else path.name
                contents[f"{folder}/{name}"] = path.read_bytes()
        for name, text in generated.items():
            contents[f"{folder}/{name}"] = text.encode()
        contents[f"{folder}/giveway_{table.name}_fmi{version}.cpp"] = source_code.entry(table, version).encode()
    contents["fmi3/sources/buildDescription.xml"] = source_code.build_description(table, files).encode()
    return contents


def _write_sources(arguments: argparse.Namespace) -> None:
    table = read_table(arguments.table, arguments.robot)
    if table.name != arguments.name:
        raise TableError(f"{arguments.table}: model: name: {table.name!r}, but the build calls it {arguments.name!r}")
    shipped = sorted(arguments.ship, key=lambda path: path.name)
    code = {
        f"{table.name}_variables.hpp": cpp.header(table),
        f"{table.name}_variables.cpp": cpp.source(table),
        f"{table.name}_fmu.cpp": cpp.fmu_entry(table),
    }
    if table.c_core is not None:
        code[f"{table.name}_members.hpp"] = c_core.members_header(table)
    compiled = source_code.source_names(table, shipped, 2) if shipped else []
    texts = {
        "fmi2/modelDescription.xml": fmi.fmi2_model_description(table, arguments.version, compiled),
        "fmi3/modelDescription.xml": fmi.fmi3_model_description(table, arguments.version),
        "common/documentation/index.html": documentation.page(table, arguments.version, arguments.equations),
    }
    # For users who compile the model, or read its table without codegen; not part of a source-code FMU.
    aside = {
        f"{table.name}.variables.toml": toml.text(expanded(arguments.table), f"Variables of the {table.name} FMU.")
    }
    if table.plant_parameters:
        aside[f"{table.name}_plant_parameters.hpp"] = plant.reader_header(table)
    contents = {name: text.encode() for name, text in {**code, **texts, **aside}.items()}
    contents.update(_pictures(table))
    if shipped:
        contents.update(_shipped(table, shipped, code))
    for folder in ("common", "fmi2", "fmi3"):  # files of an earlier build would be packed otherwise
        shutil.rmtree(arguments.out / folder, ignore_errors=True)
    for name, data in contents.items():
        path = arguments.out / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)


def _write_plant_parameters(arguments: argparse.Namespace) -> None:
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text(plant.parameters_header(read_table(arguments.table, arguments.robot)), encoding="utf-8")


def _pairs(option: str, entries: list[str]) -> dict[str, Path]:
    """``NAME=FILE`` entries of an option."""
    pairs = {}
    for entry in entries:
        name, equals, path = entry.partition("=")
        if not equals:
            raise TableError(f"{option}: {entry!r}, but must be NAME=FILE")
        pairs[name] = Path(path)
    return pairs


def _write_package(arguments: argparse.Namespace) -> None:
    binaries = _pairs("--binary", arguments.binary)
    licences = _pairs("--licence", arguments.licence)
    write_fmu(arguments.fmi, arguments.generated, binaries, licences, arguments.out)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="giveway_codegen", description=__doc__)
    commands = parser.add_subparsers(required=True)
    sources = commands.add_parser("sources", help="C++ sources, model descriptions and documentation of one FMU")
    sources.add_argument("--name", required=True, help="the model's name as the build knows it")
    sources.add_argument("--table", type=Path, required=True, help="variables.toml")
    sources.add_argument("--robot", type=Path, required=True, help="robot file with start values")
    sources.add_argument("--version", required=True, help="version of giveway, written into the descriptions")
    sources.add_argument("--equations", type=Path, help="text file with the equations, for the documentation")
    sources.add_argument("--ship", type=Path, nargs="*", default=[], help="source files of a source-code FMU")
    sources.add_argument("--out", type=Path, required=True, help="folder to write to")
    sources.set_defaults(run=_write_sources)
    parameters = commands.add_parser("plant-parameters", help="the plant's parameters as a C++ header")
    parameters.add_argument("--table", type=Path, required=True, help="the testbed's variables.toml")
    parameters.add_argument("--robot", type=Path, required=True, help="robot file with start values")
    parameters.add_argument("--out", type=Path, required=True, help="header to write")
    parameters.set_defaults(run=_write_plant_parameters)
    package = commands.add_parser("package", help="the .fmu file")
    package.add_argument("--fmi", type=int, choices=(2, 3), required=True)
    package.add_argument("--generated", type=Path, required=True, help="folder that `sources` wrote to")
    package.add_argument(
        "--binary", action="append", required=True, metavar="PLATFORM=FILE", help=f"PLATFORM: {', '.join(PLATFORMS)}"
    )
    package.add_argument("--licence", action="append", default=[], metavar="NAME=FILE")
    package.add_argument("--out", type=Path, required=True, help="file to write")
    package.set_defaults(run=_write_package)
    return parser


def main(words: Sequence[str] | None = None) -> int:
    """The exit code; ``words``: the command line's, by default."""
    arguments = _parser().parse_args(words)
    try:
        arguments.run(arguments)
    except TableError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
