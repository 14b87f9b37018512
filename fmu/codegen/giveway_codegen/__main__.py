"""Run by the build: ``python -m giveway_codegen sources ...`` and ``python -m giveway_codegen package ...``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from . import cpp, documentation, fmi
from .errors import TableError
from .package import BINARY_FOLDERS, write_fmu
from .table import read_table


def _write_sources(arguments: argparse.Namespace) -> None:
    table = read_table(arguments.table, arguments.robot)
    if table.name != arguments.name:
        raise TableError(f"{arguments.table}: model: name: {table.name!r}, but the build calls it {arguments.name!r}")
    contents = {
        f"{table.name}_variables.hpp": cpp.header(table),
        f"{table.name}_variables.cpp": cpp.source(table),
        f"{table.name}_fmu.cpp": cpp.fmu_entry(table),
        "fmi2/modelDescription.xml": fmi.fmi2_model_description(table, arguments.version),
        "fmi3/modelDescription.xml": fmi.fmi3_model_description(table, arguments.version),
        "documentation/index.html": documentation.page(table, arguments.version),
    }
    for name, text in contents.items():
        path = arguments.out / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")


def _write_package(arguments: argparse.Namespace) -> None:
    licences = dict(entry.split("=", 1) for entry in arguments.licence)
    files = {name: Path(path) for name, path in licences.items()}
    write_fmu(arguments.fmi, arguments.generated, arguments.binary, files, arguments.out)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="giveway_codegen", description=__doc__)
    commands = parser.add_subparsers(required=True)
    sources = commands.add_parser("sources", help="C++ sources, model descriptions and documentation of one FMU")
    sources.add_argument("--name", required=True, help="the model's name as the build knows it")
    sources.add_argument("--table", type=Path, required=True, help="variables.toml")
    sources.add_argument("--robot", type=Path, required=True, help="robot file with start values")
    sources.add_argument("--version", required=True, help="version of giveway, written into the descriptions")
    sources.add_argument("--out", type=Path, required=True, help="folder to write to")
    sources.set_defaults(run=_write_sources)
    package = commands.add_parser("package", help="the .fmu file")
    package.add_argument("--fmi", type=int, choices=sorted(BINARY_FOLDERS), required=True)
    package.add_argument("--generated", type=Path, required=True, help="folder that `sources` wrote to")
    package.add_argument("--binary", type=Path, required=True, help="shared library")
    package.add_argument("--licence", action="append", default=[], metavar="NAME=FILE")
    package.add_argument("--out", type=Path, required=True, help="file to write")
    package.set_defaults(run=_write_package)
    return parser


def main() -> int:
    arguments = _parser().parse_args()
    try:
        arguments.run(arguments)
    except TableError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
