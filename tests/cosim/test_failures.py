"""What nobody can help: a full disk, a place that cannot be written, a strange path, a fault of ours. One line each."""

from __future__ import annotations

import os
import re
import resource
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import giveway
import pytest
from arc_logs import arc_log, csv_lines, sine
from cosim_helpers import folder_content, short
from giveway.base.errors import WriteError
from giveway.cli import _main
from giveway.simulation.result import Result
from study_helpers import small_study

LIMIT_BYTES = 100  # what a file may hold: as a disk that is full, every write beyond it fails
FULL = "File too large"  # what the system calls it; ENOSPC comes the same way


@contextmanager
def full_disk() -> Iterator[None]:
    """No file of this process grows beyond `LIMIT_BYTES`."""
    before, compiled = resource.getrlimit(resource.RLIMIT_FSIZE), sys.dont_write_bytecode
    sys.dont_write_bytecode = True  # Python keeps a module whose compiled form was cut short, and fails ever after
    resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT_BYTES, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        sys.dont_write_bytecode = compiled


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a study that has been run, a study file, a log and a robot file; FMUs are unpacked by then."""
    folder = tmp_path_factory.mktemp("inputs")
    giveway.run(short(duration_s=0.01))
    small_study().objective("peak force of the run").run(folder / "study")
    (folder / "study.toml").write_text(
        "schema_version = 1\n[scenario]\nduration = 0.1\n[[collision]]\nspeed = 0.5\nmass = 5\nedge = 0\ntime = 0.05\n"
    )
    log = arc_log((1.0, 0.0, 0.0), sine(2.5, 0.1), 20.0)
    (folder / "arc.csv").write_text("\n".join(csv_lines(log)) + "\n")
    (folder / "robot.toml").write_bytes(giveway.base.native.robot().read_bytes())
    return folder


COMMANDS = {
    "run": ("run", "motionless", "--duration", "0.1", "--out", "{out}/run"),
    "demo": ("demo", "--out", "{out}/demo"),
    "drivetrain": ("drivetrain", "--plot", "--out", "{out}/drivetrain"),
    "picture": ("drivetrain", "--out", "{out}/drivetrain.png"),
    "calibrate": ("calibrate", "{inputs}/arc.csv", "--robot", "{inputs}/robot.toml", "--out", "{out}/new.toml"),
    "firmware": ("firmware", "trikey", "--out", "{out}/firmware"),
    "ssp": ("ssp", "--out", "{out}/giveway.ssp"),
    "sweep": ("sweep", "{inputs}/study.toml", "--out", "{out}/study"),
    "export of a table": ("study", "export", "{inputs}/study", "--out", "{out}/table.csv"),
    "export of a design": ("study", "export", "{inputs}/study", "--design", "1", "--out", "{out}/design.toml"),
}


def arguments_of(command: str, inputs: Path, out: str) -> list[str]:
    return [argument.format(inputs=inputs, out=out) for argument in COMMANDS[command]]


@pytest.mark.parametrize("command", COMMANDS)
def test_a_full_disk_is_one_line_and_leaves_nothing(command: str, inputs: Path, tmp_path: Path) -> None:
    arguments = arguments_of(command, inputs, str(tmp_path))
    with full_disk():
        code, error = run_quietly(arguments)
    assert code == 1, error
    *said, error = error.splitlines()
    assert not any("Traceback" in line or line.startswith("giveway:") for line in said)  # progress
    assert error.startswith("giveway: ")
    assert f"{tmp_path}/" in error
    assert FULL in error
    if command != "sweep":  # its folder is made first, and the same command goes on in it
        assert folder_content(tmp_path) == []


def run_quietly(arguments: list[str]) -> tuple[int, str]:
    """Exit code and standard error of the command line in this process."""
    import io
    from contextlib import redirect_stderr, redirect_stdout

    error = io.StringIO()
    with redirect_stdout(io.StringIO()), redirect_stderr(error):
        code = _main(arguments)
    return code, error.getvalue()


@pytest.mark.parametrize("command", COMMANDS)
def test_a_place_that_cannot_be_written_is_refused_before_any_work(command: str, inputs: Path) -> None:
    code, error = run_quietly(arguments_of(command, inputs, "/proc/giveway"))
    assert code == 2
    assert error.count("\n") == 1, error
    assert error.startswith("giveway: /proc/giveway/")
    assert "cannot be written" in error


def test_a_name_that_is_too_long_is_one_line() -> None:
    code, error = run_quietly(["run", "motionless", "--out", "x" * 300])
    assert code == 2
    assert error.endswith("cannot be written: File name too long\n")


def test_in_python_a_full_disk_is_an_error_that_names_the_folder(short_run: Result, tmp_path: Path) -> None:
    with full_disk(), pytest.raises(WriteError, match=FULL) as caught:
        short_run.save(tmp_path / "result")
    assert caught.value.path == tmp_path / "result"
    assert folder_content(tmp_path) == []


def test_a_study_on_a_full_disk_goes_on_later(inputs: Path, tmp_path: Path) -> None:
    arguments = arguments_of("sweep", inputs, str(tmp_path))
    with full_disk():
        assert run_quietly(arguments)[0] == 1
    assert run_quietly(arguments)[0] == 0


def process(
    *arguments: str, folder: Path, environment: dict[str, str] | None = None, stdout: int = subprocess.PIPE
) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, "-m", "giveway", *arguments],
        cwd=folder,
        env={**os.environ, **(environment or {})},
        stdout=stdout,
        stderr=subprocess.PIPE,
        timeout=300,
        check=False,
    )


@pytest.mark.parametrize(
    "environment", [{"LC_ALL": "C"}, {"LC_ALL": "C", "PYTHONUTF8": "0"}, {}], ids=["C", "C without UTF-8", "as it is"]
)
def test_a_path_of_any_bytes_is_written_and_read(environment: dict[str, str], tmp_path: Path) -> None:
    """The folder's name is Latin-1, the file's UTF-8."""
    folder, name = os.fsdecode(b"\xfcber"), os.fsdecode(b"\xc3\xbcber \xe2\x82\xac")
    (tmp_path / folder).mkdir()
    robot = f"{folder}/{name}.toml"
    (tmp_path / robot).write_bytes(giveway.base.native.robot().read_bytes())
    arguments = ("run", "motionless", "--duration", "0.1", "--robot", robot, "--out", f"{folder}/{name}")
    done = process(*arguments, folder=tmp_path, environment=environment)
    assert (done.returncode, done.stderr) == (0, b"[1 of 2] simulation\n[2 of 2] report\n")
    assert giveway.load(tmp_path / folder / name).manifest["simulated_s"] == pytest.approx(0.1)


@pytest.fixture
def faulty(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """A command with a fault that nobody foresaw."""

    def broken(*_: object) -> None:
        raise RuntimeError("first line\nsecond line")

    monkeypatch.setattr("giveway.simulation.runner.run", broken)
    return ["run", "motionless", "--out", str(tmp_path / "out")]


def test_what_nobody_foresaw_is_one_line_that_names_the_details(faulty: list[str], tmp_path: Path) -> None:
    code, error = run_quietly(faulty)
    assert code == 1
    said = re.fullmatch(r"giveway: unexpected RuntimeError: first line second line; details: (\S+)\n", error)
    assert said is not None, error
    details = Path(said[1])
    text = details.read_text(encoding="utf-8")
    details.unlink()
    for word in ("Traceback", "RuntimeError: first line", f"giveway {giveway.__version__}", "run motionless --out"):
        assert word in text
    assert folder_content(tmp_path) == []


def test_a_file_cut_short_is_no_interruption(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def cut_short(*_: object) -> None:
        raise EOFError("No data left in file")

    monkeypatch.setattr("giveway.simulation.runner.run", cut_short)
    code, error = run_quietly(["run", "motionless", "--out", str(tmp_path / "out")])
    assert code == 1
    said = re.fullmatch(r"\n?giveway: unexpected EOFError: No data left in file; details: (\S+)\n", error)
    assert said is not None, error
    Path(said[1]).unlink()


def test_debug_shows_the_traceback(faulty: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    for arguments, variable in ((["--debug", *faulty], ""), (faulty, "1")):
        monkeypatch.setenv("GIVEWAY_DEBUG", variable)
        code, error = run_quietly(arguments)
        assert code == 1
        assert error.startswith("Traceback")
        Path(error.rpartition(" ")[2].strip()).unlink()


def test_the_details_find_another_place_or_none(
    faulty: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("tempfile.tempdir", "/proc")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert f"details: {tmp_path}/cache/giveway/giveway-failure-" in run_quietly(faulty)[1]
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc")
    error = run_quietly(faulty)[1]
    assert error.count("\n") == 1
    assert "GIVEWAY_DEBUG=1 shows the traceback" in error


def test_an_error_of_the_system_names_the_file(faulty: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def unplugged(*_: object) -> None:
        raise FileNotFoundError(2, "…", "/media/stick/table")

    monkeypatch.setattr("giveway.simulation.runner.run", unplugged)
    code, error = run_quietly(faulty)
    assert code == 1
    assert error.startswith("giveway: /media/stick/table: No such file or directory; details: ")
    Path(error.rpartition(" ")[2].strip()).unlink()


def test_output_that_nobody_takes_is_no_traceback(tmp_path: Path) -> None:
    with open("/dev/full", "wb") as full:
        done = process("variables", "testbed", folder=tmp_path, stdout=full.fileno())
    assert done.returncode == 1
    assert b"No space left on device" in done.stderr
    assert b"Traceback" not in done.stderr
    assert b"Exception ignored" not in done.stderr
    reading, writing = os.pipe()
    os.close(reading)
    done = process("variables", "testbed", folder=tmp_path, stdout=writing)
    os.close(writing)
    assert (done.returncode, done.stderr) == (1, b"")


@pytest.mark.parametrize("arguments", [(), ("study",), ("fmu",)])
def test_no_command_is_the_help_and_no_error(arguments: tuple[str, ...], tmp_path: Path) -> None:
    done = process(*arguments, folder=tmp_path)
    assert done.returncode == 2
    assert b"Commands" in done.stdout
    assert done.stderr == b""
