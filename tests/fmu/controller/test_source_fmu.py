"""The controller's sources, compiled from the FMU alone as an importer does it, give the bits of the shipped binary."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import fmpy.build
import numpy as np
import pytest
from lxml import etree

from fmu.platforms.plan import Fmu, Plan, read_outputs

ROOT = Path(__file__).parents[3]
sys.path.insert(0, str(ROOT / "tests" / "fmu" / "shell"))

from fmu_driver import BINARY_FOLDERS, BUILD  # noqa: E402

HEADERS = Path(fmpy.__file__).parent / "c-code"  # the importer's
RUNNER = ROOT / "fmu" / "platforms" / "run_fmus.c"
STEPS = 1500


def packed(version: int) -> Path:
    return BUILD / "fmus" / f"giveway_controller_fmi{version}.fmu"


def plan() -> Plan:
    """A robot that stands, is tared, hit twice and pushed: torques and angles of all wheels, some of them wild."""
    made = Plan([Fmu.open(packed(3))], STEPS, 1e-3)
    random = np.random.default_rng(7)
    time = np.arange(STEPS) * 1e-3
    hit = 4.0 * np.exp(-(((time - 0.5) / 0.02) ** 2)) - 3.0 * np.exp(-(((time - 1.0) / 0.05) ** 2))
    for wheel, share in enumerate((0.2, 1.0, -0.8)):
        made.drive(0, f"sensor.torque[{wheel}]", share * hit + 0.02 * random.standard_normal(STEPS))
        made.drive(0, f"sensor.encoder[{wheel}]", np.round(400 * share * np.maximum(0.0, time - 0.55) ** 2))
    made.drive(0, "sensor.counter", np.arange(STEPS))
    made.read_all()
    return made


def printed(made: Plan, program: Path, library: str) -> str:
    """What the runner prints."""
    made.write(program.with_suffix(".plan"), [library])
    answer = subprocess.run(
        [program, program.with_suffix(".plan")], check=True, capture_output=True, text=True, timeout=60
    )  # fmt: skip
    return answer.stdout


@pytest.fixture(scope="module")
def shipped(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Of the binary in the FMU."""
    folder = tmp_path_factory.mktemp("shipped")
    runner = folder / "run_fmus"
    subprocess.run(["gcc", "-std=c11", f"-I{HEADERS}", RUNNER, "-o", runner, "-ldl"], check=True)
    made = plan()
    text = printed(made, runner, str(made.fmus[0].library("x86_64-linux", folder)))
    outputs = read_outputs(text, made)
    assert outputs[0, "detection.count"][-1] >= 1  # the run was a run
    return text


def unpacked(version: int, folder: Path) -> Path:
    """Only the sources and the model description of the FMU."""
    with zipfile.ZipFile(packed(version)) as archive:
        names = [n for n in archive.namelist() if n.startswith("sources/") or n == "modelDescription.xml"]
        archive.extractall(folder, names)
    return folder / "sources"


def described(sources: Path) -> tuple[list[str], list[str]]:
    """Files to compile and compiler options, as the build description has them."""
    root = etree.parse(sources / "buildDescription.xml").getroot()
    (configuration,) = root
    (files,) = configuration
    assert configuration.get("modelIdentifier") == "giveway_controller"
    assert files.get("language") == "C++17"
    return [e.get("name") for e in files.iterfind("SourceFile")], files.get("compilerOptions").split()


# Compiler (it takes .c as C and .cpp as C++ unless told), options, size of a pointer.
MACHINES = {
    "64 bits, all as C++": ("gcc", ["-std=c++17", "-x", "c++"], 8),
    "64 bits": ("gcc", [], 8),
    # Without SSE, x86 computes with more digits than float has, which c_core refuses.
    "32 bits": ("i686-linux-gnu-gcc", ["-msse2", "-mfpmath=sse"], 4),
}


def linked(command: list[str], sources: Path, folder: Path) -> Path:
    """The runner with the sources in it: it calls the functions by their prefix."""
    files, options = described(sources)
    compiler, *own = command
    machine = [option for option in own if option.startswith("-m")]
    runner, program = folder / "run_fmus.o", folder / "program"
    subprocess.run(
        [compiler, *machine, "-std=c11", "-DGIVEWAY_LINKED", f"-I{HEADERS}", "-c", RUNNER, "-o", runner], check=True
    )  # fmt: skip
    # Unoptimised: quick to compile, and the bits are the same whatever the optimisation.
    arguments = ["-O0", *own, *options, "-fno-exceptions", "-fno-rtti", f"-I{HEADERS}", f"-I{sources}"]
    inputs = [*(sources / name for name in files), "-x", "none", runner]
    subprocess.run([compiler, *arguments, *inputs, "-static", "-lstdc++", "-o", program], check=True)
    return program


@pytest.mark.parametrize("machine", MACHINES)
def test_statically_linked_sources_give_the_bits_of_the_binary(machine: str, shipped: str, tmp_path: Path) -> None:
    compiler, own, pointer = MACHINES[machine]
    program = linked([compiler, *own], unpacked(3, tmp_path), tmp_path)
    assert program.read_bytes()[4] == {4: 1, 8: 2}[pointer]  # the ELF class
    assert printed(plan(), program, "linked") == shipped


@pytest.mark.parametrize("version", [2, 3])
def test_an_importer_builds_a_binary_from_the_sources(
    version: int, shipped: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """FMPy's own builder; the result has the same functions and, in FMI 3, the same bits."""
    unpacked(version, tmp_path / "fmu")
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=":")
    monkeypatch.setenv("CMAKE_GENERATOR", "Ninja")
    build = tmp_path / "build"
    build.mkdir()
    fmpy.build.build_platform_binary(tmp_path / "fmu", build)
    library = tmp_path / "fmu" / "binaries" / BINARY_FOLDERS[version] / "giveway_controller.so"
    listing = subprocess.run(["nm", "-D", "--defined-only", library], check=True, capture_output=True, text=True).stdout
    names = {line.split()[-1] for line in listing.splitlines()}
    assert f"fmi{version}DoStep" in names
    if version == 3:
        runner = tmp_path / "run_fmus"
        subprocess.run(["gcc", "-std=c11", f"-I{HEADERS}", RUNNER, "-o", runner, "-ldl"], check=True)
        assert printed(plan(), runner, str(library)) == shipped
    else:
        description = fmpy.read_model_description(str(tmp_path / "fmu"))
        inputs = np.array([(0.0, 0.0), (0.3, 5.0)], dtype=[("time", float), ("sensor.torque[1]", float)])
        runs = [
            fmpy.simulate_fmu(
                str(folder), model_description=description, stop_time=0.6, step_size=0.001, output_interval=0.01,
                fmi_type="CoSimulation", input=inputs,
            )
            for folder in (tmp_path / "fmu", fmpy.extract(str(packed(2)), unzipdir=str(tmp_path / "packed")))
        ]  # fmt: skip
        assert runs[0].tobytes() == runs[1].tobytes()
        assert any(runs[0][name][0] != runs[0][name][-1] for name in runs[0].dtype.names[1:])


def test_another_source_would_be_noticed(shipped: str, tmp_path: Path) -> None:
    """The planted fault: torques with a relative error of 1e-7."""
    sources = unpacked(3, tmp_path)
    values = sources / "controller_members.hpp"
    right = "torque_nm[i], v.sensor_torque[i]"
    assert right in values.read_text()
    values.write_text(values.read_text().replace(right, "torque_nm[i], 1.0000001 * v.sensor_torque[i]"))
    assert printed(plan(), linked(["gcc"], sources, tmp_path), "linked") != shipped


def test_the_build_description_follows_its_schema(tmp_path: Path) -> None:
    document = etree.parse(unpacked(3, tmp_path) / "buildDescription.xml")
    schema = etree.XMLSchema(etree.parse(Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3BuildDescription.xsd"))
    assert schema.validate(document), schema.error_log
    document.getroot().append(etree.Element("Planted"))
    assert not schema.validate(document)


@pytest.mark.parametrize("version", [2, 3])
def test_the_list_of_sources_is_complete_and_the_headers_of_fmi_are_not_in_it(version: int, tmp_path: Path) -> None:
    sources = unpacked(version, tmp_path)
    present = {path.relative_to(sources).as_posix() for path in sources.rglob("*") if path.is_file()}
    description = fmpy.read_model_description(str(tmp_path))
    (configuration,) = description.buildConfigurations
    listed = set(configuration.sourceFileSets[0].sourceFiles)
    assert listed <= present
    code = {name for name in present if name.endswith((".c", ".cpp"))}
    assert code - listed == {f"fmi{version}_shell.cpp"}  # included by giveway_controller_fmi<version>.cpp
    assert not {name for name in present if Path(name).name.startswith("fmi") and name.endswith(".h")}
