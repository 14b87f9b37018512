"""FMUs that are broken or made to do harm: `check` names it, `info` and `run` refuse in a line, and nothing is left."""

from __future__ import annotations

import json
import signal
import stat
import struct
import subprocess
import tempfile
import time
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from giveway.base.errors import FileError, SimulationError
from giveway.cli import _main
from giveway.fmu_tools.check import check_fmu
from giveway.fmu_tools.limits import Limits
from giveway.fmu_tools.run import FmuStoppedError, run_fmu
from measured_process import measure
from stub_fmus import (
    DESCRIPTION,
    binary_name,
    command,
    description_3,
    entry,
    files,
    library,
    own_temporary_folder,
    pack,
    patch_directory,
)

LINK = stat.S_IFLNK | 0o777
LAUGHS = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10}">' for i in range(1, 10))
ENTITY = '<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'


def encrypted(path: Path) -> None:
    pack(path, files())
    patch_directory(path, "documentation/index.html", 8, struct.pack("<H", 1))


def encrypted_description(path: Path) -> None:
    pack(path, files())
    patch_directory(path, DESCRIPTION, 8, struct.pack("<H", 1))


def lying_size(path: Path) -> None:
    """The directory says 100 bytes, and 100,000 come out; the stated checksum is of the first hundred."""
    content = bytes(100_000)
    pack(path, files(), [entry("resources/data", content)])
    patch_directory(path, "resources/data", 16, struct.pack("<L", zipfile.crc32(content[:100])))  # type: ignore[attr-defined]
    patch_directory(path, "resources/data", 24, struct.pack("<L", 100))


def with_xml(text: str) -> Callable[[Path], None]:
    return lambda path: pack(path, {**files(), DESCRIPTION: text.encode()}) and None


def with_entry(name: str, content: bytes = b"x", mode: int = 0) -> Callable[[Path], None]:
    return lambda path: pack(path, files(), [entry(name, content, mode)]) and None


def many_variables(path: Path, count: int = 900_000) -> None:
    line = '<Float64 name="v{}" valueReference="{}"/>\n'
    rows = "".join(line.format(i, i) for i in range(count))
    pack(path, {**files(), DESCRIPTION: description_3(variables=rows).encode()})


def huge_tag(path: Path) -> None:
    text = " ".join(f'a{i}=""' for i in range(900_000))
    pack(path, {**files(), DESCRIPTION: description_3(variables=f"<Float64 {text}/>").encode()})


def deep(path: Path) -> None:
    pack(path, {**files(), DESCRIPTION: description_3(variables="<a>" * 5000 + "</a>" * 5000).encode()})


def bomb(path: Path) -> None:
    """A GB of zeros in one MB."""
    pack(path, files())
    with zipfile.ZipFile(path, "a") as archive, archive.open(entry("resources/zeros")[0], "w") as stream:
        for _ in range(1050):
            stream.write(bytes(1_000_000))


# (check, how it is made, words of the finding)
REFUSED: dict[str, tuple[str, Callable[[Path], None], str]] = {
    "outside": ("zip names", with_entry("../../x"), "../../x leads outside"),
    "absolute": ("zip names", with_entry("/outside/x"), "/outside/x leads outside"),
    "drive": ("zip names", with_entry("C:/x"), "C:/x leads outside"),
    "twice": ("zip names", with_entry("documentation/index.html"), "documentation/index.html is there 2 times"),
    "capitals": ("zip names", with_entry("Documentation/Index.html"), "n/index.html is there 2 times in different"),
    "file and folder": ("zip names", with_entry("documentation"), "documentation is a file and a folder"),
    "control characters": ("zip names", with_entry("a\x1b[2J"), "a\\x1b[2J has control characters"),
    "deep folders": ("zip names", with_entry("a/" * 300 + "b"), "folders deep"),
    "long name": ("zip names", with_entry("a" * 2000), "longer than 1000 bytes"),
    "link": ("links", with_entry("resources", b"/etc", LINK), "resources is a symbolic link"),
    "pipe": (
        "links",
        with_entry("resources/p", b"", stat.S_IFIFO | 0o644),
        "resources/p is a symbolic link or a device",
    ),
    "encrypted": ("zip method", encrypted, "documentation/index.html is encrypted"),
    "encrypted description": ("XML", encrypted_description, "modelDescription.xml is encrypted"),
    "lying size": ("zip method", lying_size, "larger than the 100 bytes that are stated"),
    "external entity": ("XML", with_xml(HEAD + ENTITY + "<a>&x;</a>"), "has a document type"),
    "laughs": ("XML", with_xml(f'{HEAD}<!DOCTYPE a [<!ENTITY l0 "ha">{LAUGHS}]><a>&l9;</a>'), "has a document type"),
    "not XML": ("XML", with_xml("<fmiModelDescription"), "modelDescription.xml: line 1"),
    "empty": ("XML", with_xml(""), "no element found"),
    "encoding": ("XML", with_xml('<?xml version="1.0" encoding="nonsense"?><a/>'), "modelDescription.xml: line 1"),
    "other root": ("XML", with_xml("<a/>"), "the root element is a, not fmiModelDescription"),
    "FMI 1": (
        "FMI version",
        with_xml('<fmiModelDescription fmiVersion="1.0" modelName="a" modelIdentifier="a"/>'),
        "'1.0'; this checks FMI 2 and FMI 3",
    ),
    "no version": ("FMI version", with_xml("<fmiModelDescription/>"), "''; this checks FMI 2 and FMI 3"),
    "missing description": ("layout", lambda path: pack(path, {"a": b""}) and None, "missing at the top"),
    "deep elements": ("XML", deep, "more than 100 levels deep"),
    "huge tag": ("XML", huge_tag, "one element has over 4 MB"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_it_is_a_fault_and_refused_in_one_line(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    check, make, words = REFUSED[name]
    path = tmp_path / "hostile.fmu"
    make(path)
    found = check_fmu(path)
    assert any(f.check == check and f.fault and words in f.text for f in found), [str(f) for f in found]
    out = tmp_path / "out.csv"
    for arguments in (["info", str(path)], ["run", str(path), "--out", str(out)]):
        assert _main(["fmu", *arguments]) == 2
        said = capsys.readouterr()
        assert said.err.startswith(f"giveway: {path}: is refused: "), said.err
        assert said.err.count("\n") == 1
        assert said.out == ""
    assert not out.exists()


@pytest.fixture(scope="module", params=[many_variables, huge_tag, bomb])
def large(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small file with much in it."""
    path: Path = tmp_path_factory.mktemp("large") / "large.fmu"
    request.param(path)
    return path


@pytest.mark.deep
@pytest.mark.parametrize("kind", ["check", "info", "run"])
def test_what_is_large_is_refused_in_little_memory(large: Path, kind: str, tmp_path: Path) -> None:
    """900,000 variables took 4.1 GB, and 1 GB of zeros was unpacked: now 10 s and 500 MB, what is promised of any."""
    path = large
    assert path.stat().st_size < 10e6
    folder, environment = own_temporary_folder(tmp_path)
    found = measure([command(), "fmu", kind, str(path)], tmp_path, environment)
    assert found.code == (1 if kind == "check" else 2), found.said
    assert "--max-" in found.said or "4 MB" in found.said
    assert "Traceback" not in found.said
    assert found.memory_kb < 500_000
    assert found.processor_s < 10.0  # of the processor: the machine may do other things
    assert list(folder.iterdir()) == []


@pytest.mark.deep
def test_a_long_list_of_variables_takes_little(tmp_path: Path) -> None:
    """150,000 rows as a table took 1.1 GB and 81 s; line by line it is 183 MB and 3 s."""
    path = tmp_path / "many.fmu"
    many_variables(path, 150_000)
    found = measure([command(), "fmu", "info", "--variables", str(path)], tmp_path)
    assert found.code == 0
    assert found.said.splitlines()[-1].split()[:3] == ["v149999", "local", "Float64"]
    assert found.memory_kb < 500_000
    assert found.processor_s < 10.0


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        (Limits(unpacked_mb=0.001), "--max-unpacked allows more"),
        (Limits(entries=2), "has more than 2 entries; --max-entries allows more"),
        (Limits(xml_mb=0.001), "--max-xml allows more"),
        (Limits(xml_elements=5), "--max-elements allows more"),
    ],
)
def test_each_limit_is_named_with_its_option(limits: Limits, words: str, tmp_path: Path) -> None:
    path = pack(tmp_path / "healthy.fmu", files())
    assert [str(f) for f in check_fmu(path) if f.fault] == []
    assert any(words in f.text and f.fault for f in check_fmu(path, limits))
    with pytest.raises(FileError, match="--max-"):
        run_fmu(path, limits=limits)


def test_a_limit_that_is_none_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(pack(tmp_path / "healthy.fmu", files()))
    for option, value in (
        ("--max-unpacked", "0"),
        ("--max-entries", "0"),
        ("--max-xml", "nan"),
        ("--max-elements", "0"),
    ):
        assert _main(["fmu", "check", path, option, value]) == 2
        assert option in capsys.readouterr().err


def test_many_entries_are_refused_before_they_are_read(tmp_path: Path) -> None:
    path = tmp_path / "many.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        for number in range(20_000):
            archive.writestr(zipfile.ZipInfo(f"resources/{number}"), b"")
    start = time.monotonic()
    assert "has more than 10,000 entries" in str(check_fmu(path)[0])
    assert time.monotonic() - start < 1.0


def test_json_has_severities(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = pack(tmp_path / "bad.fmu", files(), [entry("../x"), entry("resources/aux.txt")])
    assert _main(["fmu", "check", "--json", str(bad), str(pack(tmp_path / "good.fmu", files()))]) == 1
    document = json.loads(capsys.readouterr().out)
    assert document["schema_version"] == 1
    first, second = document["files"]
    assert (first["faults"], first["warnings"], second["faults"]) == (1, 1, 0)
    assert {
        "check": "zip names",
        "severity": "warning",
        "text": "resources/aux.txt is a name that Windows does not take",
    } in (first["findings"])


# --- The library


@pytest.mark.parametrize("share", [0.5, 0.95])
def test_a_truncated_library_is_refused(share: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    whole = library()
    path = pack(tmp_path / "cut.fmu", files(binary=whole[: int(len(whole) * share)]))
    found = [f.text for f in check_fmu(path) if f.check == "machine" and f.fault]
    assert len(found) == 1
    assert "is cut short" in found[0] or "is damaged" in found[0]
    assert _main(["fmu", "run", str(path), "--out", str(tmp_path / "x.csv")]) == 2
    assert "cannot be run: binaries/" in capsys.readouterr().err


def test_a_library_that_is_missing_says_what_there_is(tmp_path: Path) -> None:
    content = files()
    content["binaries/x86_64-windows/stub.dll"] = content.pop(binary_name())
    with pytest.raises(FileError, match=r"stub.so is missing; it has binaries for x86_64-windows"):
        run_fmu(pack(tmp_path / "other.fmu", content))


def test_an_identifier_does_not_lead_to_another_library(tmp_path: Path) -> None:
    text = description_3('<CoSimulation modelIdentifier="../../stub"/>')
    with pytest.raises(FileError, match="is not a name in C"):
        run_fmu(pack(tmp_path / "other.fmu", files(description=text)))


SEGFAULT = "*(volatile int *)0 = 1; return 0;"
ENDS = [
    (3, "fmi3DoStep", "abort();", "ended with SIGABRT in fmi3DoStep"),
    (3, "fmi3DoStep", 'if (b > 0.45) { puts("out of wax"); fflush(stdout); raise(SIGBUS); } return 0;', "SIGBUS"),
    (3, "fmi3EnterInitializationMode", SEGFAULT, "ended with SIGSEGV in fmi3EnterInitializationMode"),
    (3, "fmi3InstantiateCoSimulation", "exit(7);", "ended by itself (exit code 7) in fmi3InstantiateCoSimulation"),
    (2, "fmi2DoStep", SEGFAULT, "ended with SIGSEGV in fmi2DoStep"),
    (2, "fmi2GetReal", "raise(SIGKILL); return 0;", "ended with SIGKILL in fmi2GetReal"),
]


@pytest.mark.parametrize(("version", "function", "body", "words"), ENDS)
def test_a_crash_is_a_message_with_the_call(
    version: int, function: str, body: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    folder, _ = own_temporary_folder(tmp_path)
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    path = pack(tmp_path / "crash.fmu", files(version, binary=library(version, ((function, body),))))
    out = tmp_path / "x.csv"
    assert _main(["fmu", "run", str(path), "--out", str(out)]) == 1
    said = capsys.readouterr().err
    assert words in said
    assert said.startswith("giveway: crash.fmu at t = ")
    assert ("at t = 0.5 s" in said and "out of wax" in said) == ("wax" in body)
    assert said.count("\n") == 1
    assert not out.exists()
    assert list(folder.iterdir()) == []


def test_a_crash_in_a_constructor_names_the_loading(tmp_path: Path) -> None:
    extra = "__attribute__((constructor)) static void start(void) { abort(); }"
    with pytest.raises(FmuStoppedError, match="SIGABRT in loading the library"):
        run_fmu(pack(tmp_path / "crash.fmu", files(binary=library(extra=extra))))


@pytest.mark.parametrize(
    ("extra", "words"),
    [
        ("__attribute__((destructor)) static void end(void) { abort(); }", "SIGABRT in unloading the library"),
        (
            "static void end(void) {}\n__attribute__((constructor)) static void start(void) { on_exit((void *)8, 0); }",
            "SIGSEGV in the library's own functions at the end of the process",
        ),
    ],
)
def test_a_crash_after_the_run_loses_nothing(
    extra: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = pack(tmp_path / "late.fmu", files(binary=library(extra=extra)))
    out = tmp_path / "x.csv"
    assert _main(["fmu", "run", str(path), "--out", str(out)]) == 1
    assert f"the run is complete, but then the FMU's process ended with {words}" in capsys.readouterr().err
    assert len(out.read_text().splitlines()) == 12  # head, 0 s to 1 s every 0.1 s


@pytest.mark.parametrize("body", ["for (;;) {}", 'for (;;) puts("a message without end");'])
def test_a_run_without_end_is_ended(body: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, _ = own_temporary_folder(tmp_path)
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    path = pack(tmp_path / "endless.fmu", files(binary=library(3, (("fmi3DoStep", body),))))
    start = time.monotonic()
    with pytest.raises(FmuStoppedError, match=r"not finished after 3 s \(--time-limit\), in fmi3DoStep"):
        run_fmu(path, time_limit_s=3.0)
    assert time.monotonic() - start < 8.0
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_a_killed_run_leaves_nothing(how: signal.Signals, tmp_path: Path) -> None:
    folder, environment = own_temporary_folder(tmp_path)
    note = tmp_path / "pid"
    body = f'FILE *f = fopen("{note}", "w"); fprintf(f, "%d\\n", getpid()); fclose(f); for (;;) sleep(1);'
    path = pack(tmp_path / "endless.fmu", files(binary=library(3, (("fmi3DoStep", body),))))
    process = subprocess.Popen(
        [command(), "fmu", "run", str(path)], env=environment, cwd=tmp_path, stderr=subprocess.DEVNULL
    )
    _until(lambda: note.exists() and note.read_text().endswith("\n"))
    child = int(note.read_text())
    assert list(folder.iterdir()) != []
    process.send_signal(how)
    process.wait(30)
    _until(lambda: not list(folder.iterdir()))
    _until(lambda: not Path(f"/proc/{child}").exists() or "Z" in Path(f"/proc/{child}/stat").read_text())


def _until(true: Callable[[], bool]) -> None:
    end = time.monotonic() + 30.0
    while not true():
        assert time.monotonic() < end, "it does not come"
        time.sleep(0.05)


def test_an_fmu_that_refuses_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, _ = own_temporary_folder(tmp_path)
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    path = pack(tmp_path / "no.fmu", files(binary=library(3, (("fmi3DoStep", "return 3;"),))))
    with pytest.raises(SimulationError, match="fmi3DoStep"):
        run_fmu(path)
    assert list(folder.iterdir()) == []
