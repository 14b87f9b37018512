"""`giveway fmu check`: nothing to say of what we build, and each check finds the fault that it is there for."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest
from cosim_helpers import Cli
from giveway.base import native
from giveway.base.errors import FileError
from giveway.cli import _main
from giveway.fmu_tools.binaries import read_binary
from giveway.fmu_tools.check import CHECKS, check_fmu

MODELS = (*native.MODELS, *native.COMPONENTS)
EPOCH = (1980, 1, 1, 0, 0, 0)
DESCRIPTION = "modelDescription.xml"


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("model", MODELS)
def test_nothing_is_wrong_with_what_we_build(model: str, version: int) -> None:
    assert [str(finding) for finding in check_fmu(native.fmu(model, version))] == []


def test_without_what_reads_libraries_its_extra_is_named(
    cli: Cli, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Not taken for a finding, and nothing is written."""
    monkeypatch.setitem(sys.modules, "lief", None)
    path = str(native.fmu("bumper", 3))
    for arguments in (["check", path], ["info", path], ["run", path, "--out", "run.csv"]):
        answer = cli("fmu", *arguments)
        assert (answer.returncode, answer.stdout) == (2, "")
        assert answer.stderr == "giveway: lief is not installed; `pip install 'giveway[fmu]'` installs it\n"
    assert not list(tmp_path.iterdir())


class Draft:
    """An FMU as a list of files that a fault can be planted in; packed as the build packs them."""

    def __init__(self, version: int) -> None:
        with zipfile.ZipFile(native.fmu("bumper", version)) as archive:
            self.files = {name: archive.read(name) for name in archive.namelist()}
        self.version = version
        self.method: dict[str, int] = {}
        self.date = EPOCH
        self.backwards = False
        self.twice: list[str] = []

    @property
    def binary(self) -> str:
        return next(name for name in self.files if name.startswith("binaries/"))

    def edit(self, old: str, new: str, name: str = DESCRIPTION) -> None:
        text = self.files[name].decode()
        assert text.count(old) >= 1, f"{old} is not in {name}"
        self.files[name] = text.replace(old, new, 1).encode()

    def rename(self, old: str, new: str) -> None:
        self.files[new] = self.files.pop(old)

    def write(self, path: Path) -> Path:
        with zipfile.ZipFile(path, "w") as archive:
            for name in sorted([*self.files, *self.twice], reverse=self.backwards):
                entry = zipfile.ZipInfo(name, self.date)
                entry.compress_type = self.method.get(name, zipfile.ZIP_DEFLATED)
                archive.writestr(entry, self.files[name])
        return path


Plant = Callable[[Draft], object]
START = 'start="948.0"'  # of the spring rate, between 1 and 1e6

BUILD_DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0"><BuildConfiguration modelIdentifier="giveway_bumper">
<SourceFileSet><SourceFile name="all.c"/></SourceFileSet></BuildConfiguration></fmiBuildDescription>
"""


def with_sources(draft: Draft, text: str = BUILD_DESCRIPTION, name: str = "all.c") -> None:
    draft.files["sources/buildDescription.xml"] = text.encode()
    draft.files[f"sources/{name}"] = b"int x;"


def compiled(folder: Path, source: str, *options: str) -> bytes:
    (folder / "stray.c").write_text(source)
    command = ["cc", "-shared", "-fPIC", "-o", folder / "stray.so", folder / "stray.c", *options]
    subprocess.run(command, check=True)
    return (folder / "stray.so").read_bytes()


# (check, FMI version, what is done, words of the finding, whether it is a fault)
FAULTS: list[tuple[str, int, Plant, str, bool]] = [
    ("XML", 3, lambda d: d.edit("<ModelVariables>", "<ModelVariables"), "modelDescription.xml: ", True),
    ("FMI version", 2, lambda d: d.edit('fmiVersion="2.0"', 'fmiVersion="1.0"'), "'1.0'; this checks", True),
    ("zip method", 2, lambda d: d.method.update({d.binary: zipfile.ZIP_LZMA}), "compressed by method 14", True),
    ("zip names", 2, lambda d: d.rename("documentation/index.html", "../index.html"), "leads outside", True),
    ("zip names", 2, lambda d: d.rename("documentation/index.html", "C:index.html"), "leads outside", True),
    ("zip names", 2, lambda d: d.rename("documentation/index.html", "a\\b.html"), "has a backslash", True),
    ("zip names", 3, lambda d: d.twice.append(DESCRIPTION), "is there 2 times", True),
    ("zip names", 3, lambda d: d.files.update({"MODELdescription.xml": b"<a/>"}), "in different capitals", True),
    ("zip names", 3, lambda d: d.files.update({"documentation/\u00fc.txt": b""}), "not plain ASCII", False),
    ("zip order", 2, lambda d: setattr(d, "backwards", True), "not in the order of their names", False),
    ("zip order", 2, lambda d: setattr(d, "date", (2026, 1, 2, 3, 4, 6)), "carry a time stamp", False),
    ("layout", 2, lambda d: d.rename(DESCRIPTION, f"inner/{DESCRIPTION}"), "missing at the top", True),
    ("layout", 2, lambda d: d.files.update({"stuff/a.txt": b""}), "stuff/ means nothing", False),
    ("layout", 2, lambda d: d.files.pop("documentation/index.html"), "no documentation/index.html", False),
    (
        "layout",
        3,
        lambda d: [d.files.pop(name) for name in list(d.files) if "licenses" in name],
        "licenses/ is empty",
        False,
    ),
    (
        "schema",
        2,
        lambda d: d.edit('<Real declaredType="Position.mm"', '<Real colour="red" declaredType="Position.mm"'),
        "'colour' is not allowed",
        True,
    ),
    ("schema", 3, lambda d: d.edit('causality="input"', 'causality="entry"'), "'entry'", True),
    (
        "schema",
        3,
        lambda d: d.files.update({"terminalsAndIcons/terminalsAndIcons.xml": b"<icons/>"}),
        "terminalsAndIcons.xml, line 1",
        True,
    ),
    ("build description", 3, lambda d: with_sources(d, name="other.c"), "names all.c, which is not in sources/", True),
    (
        "build description",
        3,
        lambda d: with_sources(d, BUILD_DESCRIPTION.replace('"giveway_bumper"', '"other"')),
        "builds 'other'",
        True,
    ),
    ("build description", 3, lambda d: d.files.update({"sources/a.c": b""}), "no sources/buildDescription.xml", True),
    ("build description", 2, lambda d: d.files.update({"sources/a.c": b""}), "no interface names", True),
    (
        "build description",
        3,
        lambda d: [with_sources(d), d.files.update({"sources/b.c": b""})],
        "sources/b.c is in no list",
        False,
    ),
    (
        "build description",
        2,
        lambda d: d.edit(
            'canSerializeFMUstate="true"/>\n  <CoSim',
            'canSerializeFMUstate="true"><SourceFiles><File name="a.c"/></SourceFiles></ModelExchange>\n  <CoSim',
        ),
        "ModelExchange names the source file a.c",
        True,
    ),
    (
        "layered standards",
        3,
        lambda d: d.files.update({"extra/org.somebody/fmi-ls-manifest.xml": b"<a/>"}),
        "extra/org.somebody/fmi-ls-manifest.xml has no fmi-ls-name",
        False,
    ),
    (
        "numbers",
        3,
        lambda d: d.edit('valueReference="101"', 'valueReference="x"'),
        "valueReference is 'x', not a whole number",
        True,
    ),
    (
        "numbers",
        2,
        lambda d: (d.edit("<ModelStructure>", "<Structure>"), d.edit("</ModelStructure>", "</Structure>")),
        "there is no element ModelStructure",
        True,
    ),
    (
        "variable names",
        3,
        lambda d: d.edit('name="plate.force"', 'name="plate force"'),
        "plate force is no name of the convention 'structured'",
        True,
    ),
    ("identity", 2, lambda d: d.edit('guid="{', 'guid="" lost="{'), "is empty", True),
    (
        "identity",
        3,
        lambda d: d.edit('modelIdentifier="giveway_bumper"', 'modelIdentifier="2b"'),
        "not a name in C",
        True,
    ),
    ("identity", 3, lambda d: d.edit('canGetAndSetFMUState="true"', ""), "can serialise its state, but not", True),
    ("identity", 2, lambda d: d.edit('stopTime="1.0"', 'stopTime="0.0"'), "stops at 0 s", True),
    ("identity", 2, lambda d: d.edit('startTime="0.0"', 'startTime="2.0"'), "not after its start at 2 s", True),
    ("identity", 2, lambda d: d.edit('stepSize="0.001"', 'stepSize="-0.001"'), "step size is -0.001 s", True),
    (
        "names and references",
        2,
        lambda d: d.edit('name="plate.force"', 'name="carrier.force"'),
        "2 variables are",
        True,
    ),
    ("names and references", 3, lambda d: d.edit('valueReference="101"', 'valueReference="100"'), "is shared by", True),
    (
        "names and references",
        2,
        lambda d: d.edit('valueReference="102"', 'valueReference="101"'),
        "has different units",
        True,
    ),
    ("start values", 2, lambda d: d.edit(START, 'start="0.5"'), "start 0.5 is outside its bounds", True),
    ("start values", 3, lambda d: d.edit(START, 'start="2e6"'), "start 2e6 is outside its bounds", True),
    ("start values", 2, lambda d: d.edit('max="1000000.0"', 'max="0.5"'), "min 1 is above max 0.5", True),
    (
        "start values",
        2,
        lambda d: d.edit('<Real declaredType="Position.mm"', '<Real declaredType="Position.mm" nominal="0.0"'),
        "nominal 0 is not positive",
        True,
    ),
    ("start values", 3, lambda d: d.edit(START, 'start="stiff"'), "'stiff' is not a value", True),
    ("start values", 3, lambda d: d.edit('max="8" start="2"', 'start="4294967296"'), "does not fit into Int32", True),
    ("start values", 3, lambda d: d.edit('start="0.0"', 'start="INF"'), "is outside its bounds", True),
    ("start presence", 3, lambda d: d.edit(START, ""), "has no start value", True),
    (
        "start presence",
        2,
        lambda d: d.edit('<Real declaredType="Energy"/>', '<Real declaredType="Energy" start="1.0"/>'),
        "is calculated, but has a start value",
        True,
    ),
    (
        "units",
        2,
        lambda d: d.edit('declaredType="Force"', 'unit="ell"'),
        "in ell, which is not defined",
        True,
    ),
    (
        "units",
        2,
        lambda d: d.edit('<Unit name="J">', '<Unit name="N"><BaseUnit/></Unit><Unit name="J">'),
        "twice",
        True,
    ),
    (
        "units",
        3,
        lambda d: d.edit('<BaseUnit kg="1" m="1" s="-2" factor="1.0"', '<BaseUnit kg="1" m="1" s="-2" factor="0.0"'),
        "has the factor 0",
        True,
    ),
    ("units", 3, lambda d: d.edit('<Unit name="J">', '<Unit name="ell"/><Unit name="J">'), "no variable has it", False),
    (
        "units",
        3,
        lambda d: d.edit('Type="Position.mm"', 'Type="Position.mm" displayUnit="ell"'),
        "no display unit of m",
        True,
    ),
    ("units", 3, lambda d: d.edit('declaredType="Position.mm"', 'declaredType="Way"'), "type Way, which is not", True),
    (
        "units",
        2,
        lambda d: d.edit('declaredType="RateOfEnergy" derivative', 'declaredType="RateOfEnergy" unit="J" derivative'),
        "state state.work_in in J",
        True,
    ),
    (
        "model structure",
        2,
        lambda d: d.edit('<Unknown index="5" dependencies="1 2 3 4"/>', ""),
        "carrier.force is not among the outputs",
        True,
    ),
    (
        "model structure",
        3,
        lambda d: d.edit('<ContinuousStateDerivative valueReference="3000" dependencies="1 2 3 4"/>', ""),
        "der(state.work_in) is not among the derivatives",
        True,
    ),
    (
        "model structure",
        3,
        lambda d: d.edit('<Output valueReference="100"', '<Output valueReference="1003"'),
        "bumper.preload is among the outputs, but is none",
        True,
    ),
    (
        "model structure",
        3,
        lambda d: d.edit('<Output valueReference="101"', '<Output valueReference="100"'),
        "carrier.force is 2 times among the outputs",
        True,
    ),
    (
        "model structure",
        2,
        lambda d: d.edit('<Unknown index="5" dependencies="1 2 3 4"/>', '<Unknown index="5" dependencies="1 999"/>'),
        "carrier.force depends on 999",
        True,
    ),
    (
        "model structure",
        2,
        lambda d: d.edit('<Unknown index="5" dependencies="1 2 3 4"/>', '<Unknown index="999" dependencies=""/>'),
        "999 among the outputs is no variable",
        True,
    ),
    (
        "model structure",
        2,
        lambda d: d.edit('<Unknown index="5" dependencies="1 2 3 4"/>', '<Unknown index="5"/>'),
        "states no dependencies",
        False,
    ),
    (
        "model structure",
        3,
        lambda d: d.edit(
            '<Output valueReference="100" dependencies="1 2 3 4"/>',
            '<Output valueReference="100" dependencies="1 2 3 4" dependenciesKind="dependent"/>',
        ),
        "4 dependencies, but 1 kinds",
        True,
    ),
    (
        "model structure",
        3,
        lambda d: d.edit("<InitialUnknown", '<ClockedState valueReference="9999"/><InitialUnknown'),
        "9999 among the clocked states is no variable",
        True,
    ),
    ("model structure", 2, lambda d: d.edit('derivative="145"', 'derivative="990"'), "is the derivative of 990", True),
    (
        "event indicators",
        2,
        lambda d: d.edit('numberOfEventIndicators="2"', 'numberOfEventIndicators="two"'),
        "numberOfEventIndicators is 'two'",
        True,
    ),
    (
        "event indicators",
        3,
        lambda d: d.edit('<EventIndicator valueReference="4000"', '<EventIndicator valueReference="104"'),
        "latched is not a continuous real",
        True,
    ),
    (
        "FMPy",
        3,
        lambda d: d.edit('causality="parameter" variability="fixed"', 'causality="parameter" variability="continuous"'),
        "variability",
        True,
    ),
    ("platforms", 2, lambda d: d.files.pop(d.binary), "neither a binary nor source code", True),
    (
        "platforms",
        3,
        lambda d: d.rename(d.binary, "binaries/x86_64-linux/bumper.so"),
        "giveway_bumper.so is missing",
        True,
    ),
    ("platforms", 3, lambda d: d.files.update({"binaries/linux64/a.so": b""}), "no platform that FMI 3 names", False),
    ("machine", 2, lambda d: d.files.update({d.binary: b"MZ"}), "is no shared library", True),
    ("machine", 2, lambda d: d.rename(d.binary, "binaries/linux32/giveway_bumper.so"), "not for linux32", True),
]


@pytest.mark.parametrize(("check", "version", "plant", "words", "fault"), FAULTS)
def test_each_check_finds_its_fault(
    check: str, version: int, plant: Plant, words: str, fault: bool, tmp_path: Path
) -> None:
    draft = Draft(version)
    plant(draft)
    found = check_fmu(draft.write(tmp_path / "planted.fmu"))
    said = [finding for finding in found if finding.check == check and words in finding.text]
    assert said, [str(finding) for finding in found]
    assert {finding.fault for finding in said} == {fault}


@pytest.mark.parametrize(("number", "strict", "code"), [(0, [], 1), (9, [], 0), (9, ["--strict"], 1)])
def test_the_exit_code_says_whether_there_is_a_fault(
    number: int, strict: list[str], code: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, version, plant, words, fault = FAULTS[number]
    assert fault == (number == 0)
    draft = Draft(version)
    plant(draft)
    path = draft.write(tmp_path / "planted.fmu")
    assert _main(["fmu", "check", *strict, str(path)]) == code
    assert words in capsys.readouterr().out


@pytest.mark.parametrize(
    ("check", "source", "words", "fault"),
    [
        ("exported symbols", "int nothing;", "does not export fmi3DoStep", True),
        ("exported symbols", "int nothing;", "exports 1 symbols that are not FMI's (nothing)", False),
        ("imported libraries", "void deflate(void); void f(void) { deflate(); }", "needs libz.so.1, which not", True),
        ("imported libraries", "int nothing; /* libstdc++ */", "needs libstdc++.so.6: nearly every machine", False),
    ],
)
def test_each_check_of_binaries_finds_its_fault(
    check: str, source: str, words: str, fault: bool, tmp_path: Path
) -> None:
    draft = Draft(3)
    library = "libz.so.1" if "deflate" in source else "libstdc++.so.6" if "libstdc++" in source else None
    libraries = ["-Wl,--no-as-needed", f"-l:{library}"] if library else []
    draft.files[draft.binary] = compiled(tmp_path, source, *libraries)
    found = [f for f in check_fmu(draft.write(tmp_path / "planted.fmu")) if f.check == check]
    assert any(words in finding.text and finding.fault == fault for finding in found), [str(f) for f in found]


LATE = """int __cxa_atexit(void (*)(void *), void *, void *);
void late(void *);
__attribute__((constructor)) void start(void) { __cxa_atexit(late, 0, 0); }"""


def test_destructors_that_nobody_runs_at_unloading_are_a_fault(tmp_path: Path) -> None:
    for options, faults in ((["-nostartfiles"], 1), ([], 0)):  # gcc's start files import __cxa_finalize
        draft = Draft(3)
        draft.files[draft.binary] = compiled(tmp_path, LATE, *options)
        found = [f for f in check_fmu(draft.write(tmp_path / "planted.fmu")) if f.check == "unloading"]
        assert [f.fault for f in found] == [True] * faults, options
        assert all("__cxa_atexit without __cxa_finalize" in f.text for f in found)


def test_a_source_file_that_another_includes_need_not_be_listed(tmp_path: Path) -> None:
    draft = Draft(3)
    with_sources(draft)
    draft.files["sources/part.cpp"] = b"int y;"
    noted = [f.text for f in check_fmu(draft.write(tmp_path / "noted.fmu"))]
    assert noted == ["sources/part.cpp is in no list of source files"]
    draft.files["sources/all.c"] = b'  # include "part.cpp"\nint x;'
    assert check_fmu(draft.write(tmp_path / "fine.fmu")) == []


def test_every_check_has_a_planted_fault() -> None:
    planted = {check for check, *_ in FAULTS} | {"exported symbols", "imported libraries", "unloading"}
    planted |= {"limits", "links"}  # test_fmu_hostile.py
    assert planted == set(CHECKS) | {"XML", "FMI version"}


@pytest.mark.parametrize("place", [2000, 2001, 20_000])
def test_a_damaged_zip_is_noticed(place: int, tmp_path: Path) -> None:
    """Wherever the damage is: some of it unpacks to other bytes, some does not unpack at all."""
    path = Draft(2).write(tmp_path / "damaged.fmu")
    data = bytearray(path.read_bytes())
    data[place] ^= 0xFF  # in the middle of the packed binary
    path.write_bytes(data)
    assert any(finding.check == "zip method" and finding.fault for finding in check_fmu(path))


@pytest.mark.parametrize("content", [b"", b"no zip at all"])
def test_what_is_no_fmu_is_said_in_one_line(content: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "no.fmu"
    path.write_bytes(content)
    with pytest.raises(FileError):
        check_fmu(path)
    for command in (["check"], ["info"], ["run", "--out", str(tmp_path / "x.csv")]):
        assert _main(["fmu", *command, str(path)]) == 2
        assert capsys.readouterr().err.startswith(f"giveway: {path}")
    assert not (tmp_path / "x.csv").exists()


def test_libraries_of_all_three_systems_are_read() -> None:
    folder = Path(fmpy.__file__).parent
    windows = read_binary(folder / "remoting" / "win64" / "client_tcp.dll")
    assert (windows.system, windows.machines) == ("windows", {"x86_64"})
    assert "fmi2DoStep" in windows.exported
    assert any(name.lower() == "kernel32.dll" for name in windows.needed)
    darwin = read_binary(folder / "logging" / "darwin64" / "logging.dylib")
    assert (darwin.system, darwin.needed) == ("darwin", ("/usr/lib/libSystem.B.dylib",))
    assert "addLoggerProxy" in darwin.exported
    linux = read_binary(folder / "logging" / "linux64" / "logging.so")
    assert (linux.system, linux.machines) == ("linux", {"x86_64"})
    assert linux.newest_glibc is not None
    assert linux.newest_glibc >= (2, 2)
