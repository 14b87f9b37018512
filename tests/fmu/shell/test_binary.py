"""The FMU files: valid, reproducible, exporting only FMI functions and needing only the C library."""

from __future__ import annotations

import csv
import math
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from fmu_driver import BINARY_FOLDERS, BUILD, INTEGRATED, MODELS, ROOT, Fmu, fmu_path

EVERY_FMU = [(model, version) for model in (*MODELS, "lag") for version in (2, 3)]
GOLDEN = Path(__file__).parent / "golden_references"
AT_EXIT = {"atexit", "on_exit", "__cxa_atexit", "__cxa_thread_atexit", "__cxa_thread_atexit_impl"}
C_LIBRARY = {"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2"}


def shared_library(model: str, version: int, folder: Path) -> Path:
    with zipfile.ZipFile(fmu_path(model, version)) as archive:
        return Path(archive.extract(f"binaries/{BINARY_FOLDERS[version]}/giveway_{model}.so", folder))


@pytest.mark.parametrize(("model", "version"), EVERY_FMU)
def test_fmpy_has_nothing_to_say(model: str, version: int) -> None:
    assert validate_fmu(str(fmu_path(model, version))) == []


@pytest.mark.parametrize("model", [*MODELS, "lag"])
def test_both_versions_hold_the_same_binary(model: str, tmp_path: Path) -> None:
    binaries = [shared_library(model, version, tmp_path).read_bytes() for version in (2, 3)]
    assert binaries[0] == binaries[1]


def exported_symbols(library: Path) -> set[str]:
    command = ["nm", "--dynamic", "--defined-only", "--format=posix", library]
    listing = subprocess.run(command, check=True, capture_output=True, text=True)
    return {line.split()[0] for line in listing.stdout.splitlines()}


def needed_libraries(library: Path) -> set[str]:
    listing = subprocess.run(["objdump", "--private-headers", library], check=True, capture_output=True, text=True)
    return set(re.findall(r"NEEDED\s+(\S+)", listing.stdout))


def fmi_functions() -> set[str]:
    names = set()
    for header in ("fmi2Functions.h", "fmi3Functions.h"):
        text = (Path(fmpy.__file__).parent / "c-code" / header).read_text()
        names |= set(re.findall(r"FMI[23]_Export\s+fmi[23]\w+TYPE\s+(fmi[23]\w+);", text))
    return names


@pytest.mark.parametrize("model", [*MODELS, "lag"])
def test_all_fmi_functions_are_exported_and_nothing_else(model: str, tmp_path: Path) -> None:
    wanted = fmi_functions()
    assert len(wanted) > 100  # the headers were read
    assert exported_symbols(shared_library(model, 3, tmp_path)) == wanted


@pytest.mark.parametrize("model", [*MODELS, "lag"])
def test_only_the_c_library_is_needed(model: str, tmp_path: Path) -> None:
    needed = needed_libraries(shared_library(model, 3, tmp_path))
    assert "libc.so.6" in needed
    assert needed <= C_LIBRARY


def imported_symbols(library: Path) -> set[str]:
    command = ["nm", "--dynamic", "--undefined-only", "--format=posix", library]
    listing = subprocess.run(command, check=True, capture_output=True, text=True)
    return {line.split()[0].split("@")[0] for line in listing.stdout.splitlines()}


@pytest.mark.parametrize("model", [*MODELS, "lag"])
def test_nothing_is_left_to_do_when_the_process_ends(model: str, tmp_path: Path) -> None:
    """By then an importer has unloaded the library."""
    assert not imported_symbols(shared_library(model, 3, tmp_path)) & AT_EXIT


def test_an_ordinary_library_would_be_noticed(tmp_path: Path) -> None:
    """The planted fault for the three checks above: a library without the FMUs' options, and one with a destructor."""
    late = tmp_path / "late.cpp"
    late.write_text("struct Late { ~Late(); int a; }; Late::~Late() { a = 1; } Late late;")
    subprocess.run(["g++", "-shared", "-fPIC", late, "-o", late.with_suffix(".so")], check=True)
    assert imported_symbols(late.with_suffix(".so")) & AT_EXIT
    library = BUILD / "tests" / "libgiveway_plant_probe.so"
    assert exported_symbols(library) - fmi_functions()
    assert needed_libraries(library) - C_LIBRARY


@pytest.mark.parametrize(("model", "version"), EVERY_FMU)
def test_the_file_holds_what_it_should_in_order(model: str, version: int) -> None:
    with zipfile.ZipFile(fmu_path(model, version)) as archive:
        entries = archive.infolist()
    names = [entry.filename for entry in entries]
    assert names == sorted(names)
    assert {entry.compress_type for entry in entries} == {zipfile.ZIP_DEFLATED}
    assert {entry.date_time for entry in entries} == {(1980, 1, 1, 0, 0, 0)}
    wanted = {
        f"binaries/{BINARY_FOLDERS[version]}/giveway_{model}.so",
        "documentation/index.html",
        "documentation/licenses/license.txt",
        "modelDescription.xml",
    }
    if model in INTEGRATED:
        wanted.add("documentation/licenses/sundials.txt")
    if model in MODELS:
        wanted |= {"documentation/licenses/zig.txt", "documentation/licenses/libcxx.txt"}
    if model != "lag":
        wanted |= {"model.png"} if version == 2 else {f"terminalsAndIcons/icon.{kind}" for kind in ("png", "svg")}
    assert {name for name in names if not name.startswith("sources/")} == wanted
    assert any(name.startswith("sources/") for name in names) == (model == "controller")


def test_packing_twice_gives_the_same_bytes(tmp_path: Path) -> None:
    """From other copies of the same files, with other time stamps and permissions."""
    packed = []
    for name in ("first", "second"):
        folder = tmp_path / name
        table, robot = (ROOT / "tests/fmu/shell/lag" / file for file in ("variables.toml", "robot.toml"))
        version = re.search(r'^version = "(.*)"', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)[1]
        codegen(
            "sources", "--name", "lag", "--table", table, "--robot", robot, "--version", version, "--out", folder
        )  # fmt: skip
        binary = folder / "giveway_lag.so"
        binary.write_bytes(shared_library("lag", 3, folder).read_bytes())
        binary.chmod(0o600 if name == "first" else 0o755)
        output = folder / "lag.fmu"
        codegen(
            "package", "--fmi", "3", "--generated", folder, "--binary", f"x86_64-linux={binary}",
            "--licence", f"license.txt={ROOT / 'LICENSE'}", "--out", output,
        )  # fmt: skip
        packed.append(output.read_bytes())
    assert packed[0] == packed[1] == fmu_path("lag", 3).read_bytes()


def codegen(*arguments: object) -> None:
    command = [sys.executable, "-m", "giveway_codegen", *map(str, arguments)]
    subprocess.run(command, check=True, cwd=ROOT / "fmu" / "codegen")


def excitation(fmu: Fmu, step: int) -> dict[str, list]:
    """Values for every input, within its range and different at every step."""
    values: dict[str, list] = {"real": [], "integer": [], "boolean": []}
    for name, variable in fmu.variables.items():
        if variable.causality != "input":
            continue
        kind = fmu.kind(name)
        reference = variable.valueReference
        phase = math.sin(0.05 * step * (1 + reference % 5) + reference)
        if kind == "boolean":
            value = name in ("command.enable", "sensor.present") or phase > 0.8
        elif kind == "integer":
            low, high = int(variable.min or -1000), int(variable.max or 1000)
            value = step if name == "sensor.counter" else int(max(low, min(high, 100 * phase)))
        else:
            low, high = float(variable.min or -1.0), float(variable.max or 1.0)
            value = float(max(low, min(high, 0.2 * phase)))
        values[kind].append((reference, value))
    return values


def run(model: str, version: int, folder: Path) -> list[dict[str, float]]:
    fmu = Fmu(fmu_path(model, version), version, folder)
    fmu.start()
    trace = [fmu.snapshot()]
    for k in range(200):
        for kind, pairs in excitation(fmu, k).items():
            if pairs:
                numbers, values = zip(*pairs, strict=True)
                assert fmu.set_references(kind, numbers, values) == 0, fmu.last_message
        assert fmu.step(k * 0.001, 0.001) == 0, fmu.last_message
        if k % 10 == 9:
            trace.append(fmu.snapshot())
    fmu.free()
    return trace


@pytest.mark.parametrize("model", [*MODELS, "lag"])
def test_both_versions_give_the_same_bits(model: str, tmp_path: Path) -> None:
    traces = [run(model, version, tmp_path / str(version)) for version in (2, 3)]
    assert traces[0] == traces[1]
    changed = {name for name in traces[0][0] if traces[0][0][name] != traces[0][-1][name]}
    assert len(changed) > 3  # the run was a run


@pytest.mark.parametrize("model", [*MODELS, "lag"])
def test_outputs_at_the_start_follow_what_is_declared(model: str, tmp_path: Path) -> None:
    """No input, where the model descriptions name none, so importers see no algebraic loop."""
    fmu = Fmu(fmu_path(model, 3), 3, tmp_path)
    direct = {u.variable.name for u in fmu.description.outputs if u.dependencies}
    outputs = [name for name, v in fmu.variables.items() if v.causality == "output" and name not in direct]
    starts = []
    for step in (None, 3, 40):
        assert fmu.instantiate()
        assert fmu.setup() == 0
        if step is not None:
            for kind, pairs in excitation(fmu, step).items():
                for reference, value in pairs:
                    assert fmu.set_references(kind, [reference], [value]) == 0, fmu.last_message
        starts.append({name: repr(fmu.get(name)) for name in outputs})
        fmu.free()
    assert starts[1] == starts[0]
    assert starts[2] == starts[0]


Row = tuple[int, str, str]  # reference, name, type


def reference_faults(golden: list[Row], now: list[Row]) -> tuple[list[Row], list[Row]]:
    """Published rows that are missing, and rows that are not published yet."""
    return [row for row in golden if row not in now], [row for row in now if row not in golden]


def references(model: str) -> tuple[list[Row], list[Row]]:
    """The published rows and those of the FMU."""
    with (GOLDEN / f"{model}.csv").open(newline="") as file:
        golden = [(int(row["reference"]), row["name"], row["type"]) for row in csv.DictReader(file)]
    types = {"Float64": "real", "Int32": "integer", "Boolean": "boolean"}
    description = fmpy.read_model_description(str(fmu_path(model, 3)))
    now = sorted((v.valueReference, v.name, types[v.type]) for v in description.modelVariables if v.name != "time")
    return golden, now


@pytest.mark.parametrize("model", MODELS)
def test_references_are_append_only(model: str) -> None:
    """An importer's project stores references, so all references ever published keep their name and type."""
    golden, now = references(model)
    assert golden
    gone, missing = reference_faults(golden, now)
    assert not gone, "published references are append-only: these were changed or removed"
    lines = "\n".join(",".join(map(str, row)) for row in missing)
    assert not missing, f"new variables: add these lines to {GOLDEN.name}/{model}.csv\n{lines}"


def test_a_changed_reference_would_be_noticed() -> None:
    golden, now = references("testbed")
    reference, name, kind = golden[3]
    for changed in ((reference, name + "_new", kind), (99999, name, kind), (reference, name, "integer")):
        assert reference_faults(golden, [*now[:3], changed, *now[4:]]) == ([golden[3]], [changed])
    assert reference_faults(golden, now[:-1])[0] == [golden[-1]]
