"""Firmware in the controller's place: the closed loop has the bits that it has with the FMU, and failures are told."""

from __future__ import annotations

import dataclasses
import os
import random
import signal
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import giveway
import numpy as np
import pytest
from cosim_helpers import Cli, folder_content
from giveway.base.errors import GivewayError, SimulationError
from giveway.firmware import in_the_loop
from giveway.firmware.folder import program_files
from giveway.firmware.frames import Frame, Kind
from giveway.firmware.in_the_loop import Program, SerialController, controller_of
from giveway.firmware.lines import ProgramLine
from giveway.firmware.settings import Settings
from giveway.robot.variables import table
from giveway.scenario.plan import Straight
from giveway.simulation.fmu import Instance, open_fmu
from giveway.simulation.master import OpenController, Record, Stepped, simulate

HIT = dataclasses.replace(giveway.experiment("motionless").scenario("none"), duration_s=0.35)
DRIVE = dataclasses.replace(HIT, duration_s=0.9, testbed={}, contact=None, plan=Straight(0.2, 0.3))
STOP_S, FAULT_S, FAULT_END_S = 0.6, 0.5, 0.52
MODES = {"hit": 2, "stop": 5, "fault": 6}


class Meddled:
    """A controller whose inputs are changed before a step: a stop is requested, or a sensor says NaN for a while."""

    def __init__(self, controller: Stepped, what: str) -> None:
        self._controller, self._what = controller, what

    def __getattr__(self, name: str) -> Any:
        return getattr(self._controller, name)

    def stepper(self) -> Callable[[float, float], int]:
        step, inputs = self._controller.stepper(), table("controller")
        stop = self._controller.setter("boolean", [inputs["stop_request"].reference])
        torque = self._controller.setter("real", [inputs["sensor.torque[1]"].reference])
        yes, nan = np.ones(1, dtype=self._controller.dtype("boolean")), np.full(1, np.nan)

        def meddled(time_s: float, step_s: float) -> int:
            if self._what == "stop" and time_s >= STOP_S:
                stop(yes.ctypes.data)
            if self._what == "fault" and FAULT_S <= time_s < FAULT_END_S:
                torque(nan.ctypes.data)
            return step(time_s, step_s)

        return meddled


def run(what: str, opened: OpenController, fmi_version: int = 3) -> Record:
    @contextmanager
    def meddled() -> Iterator[Meddled]:
        with opened() as controller:
            yield Meddled(controller, what)

    scenario = dataclasses.replace(HIT if what == "hit" else DRIVE, fmi_version=fmi_version)
    return simulate(scenario, controller=meddled)


@contextmanager
def fmu() -> Iterator[Instance]:
    with Instance(open_fmu(giveway.base.native.fmu("controller", 3)), "controller") as instance:
        yield instance


@pytest.fixture(scope="module")
def with_fmu() -> dict[str, Record]:
    return {what: run(what, fmu) for what in MODES}


@pytest.fixture(scope="module", autouse=True)
def compiled_once(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """The C library's objects, which no configuration changes; `make` finds the place in its environment."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CORE_BUILD", str(tmp_path_factory.mktemp("core")))
        yield


@pytest.fixture(scope="module")
def host() -> OpenController:
    """The firmware of both scenarios, compiled once; each call starts it anew."""
    return controller_of(HIT, "host")


def assert_same_bits(found: Record, expected: Record, mode: int) -> None:
    assert mode in expected.traces["controller.mode"]
    assert set(found.traces) == set(expected.traces)
    differ = [name for name, values in expected.traces.items() if values.tobytes() != found.traces[name].tobytes()]
    assert differ == []


@pytest.mark.parametrize("what", MODES)
def test_a_program_has_the_bits_of_the_fmu(what: str, host: OpenController, with_fmu: dict[str, Record]) -> None:
    assert_same_bits(run(what, host), with_fmu[what], MODES[what])


def test_with_fmi_2(host: OpenController, with_fmu: dict[str, Record]) -> None:
    assert_same_bits(run("hit", controller_as(host, 2), 2), with_fmu["hit"], MODES["hit"])


def test_with_accelerometer_and_gyro() -> None:
    """And with the numbers of another robot."""
    delivery = giveway.base.native.robots()["delivery"]
    scenario = giveway.experiment("motionless").scenario("none", robot=delivery, duration_s=0.5)
    expected = simulate(scenario)
    assert expected.traces["controller.imu.trusted"].any()
    assert_same_bits(simulate(scenario, controller=controller_of(scenario, "host")), expected, MODES["hit"])


def controller_as(opened: OpenController, fmi_version: int) -> OpenController:
    """The same program, which exchanges values in the types of another FMI version."""

    @contextmanager
    def other() -> Iterator[SerialController]:
        with opened() as controller:
            assert isinstance(controller, SerialController)
            yield SerialController(controller._line, controller.file, fmi_version)

    return other


@pytest.mark.deep
@pytest.mark.parametrize("what", MODES)
def test_a_cortex_m4f_has_the_bits_of_the_fmu(what: str, with_fmu: dict[str, Record]) -> None:
    assert_same_bits(run(what, controller_of(HIT, "qemu")), with_fmu[what], MODES[what])


@contextmanager
def device(host: OpenController) -> Iterator[str]:
    """The path of a terminal at whose other end the program is."""
    with host() as controller:
        program = controller.file.path
    ours, theirs = os.openpty()
    process = subprocess.Popen([str(program)], stdin=ours, stdout=ours)
    try:
        yield os.ttyname(theirs)
    finally:
        process.kill()
        process.wait()
        os.close(ours)
        os.close(theirs)


def test_a_serial_device_has_the_bits_of_the_fmu(host: OpenController, with_fmu: dict[str, Record]) -> None:
    with device(host) as path:
        assert_same_bits(run("hit", controller_of(HIT, f"{path}@921600")), with_fmu["hit"], MODES["hit"])


def test_a_board_with_another_configuration_is_refused(host: OpenController) -> None:
    other = dataclasses.replace(HIT, preset="paper", controller={**HIT.controller, "channels.fast_rest": 7.5})
    with device(host) as path, pytest.raises(SimulationError) as caught:
        run("hit", controller_of(other, path))
    assert "controller at t = 0 s: the firmware has another configuration or library: digest " in str(caught.value)
    assert "trikey.toml --out DIR --preset paper --set controller.supervisor.after_settled=0 --set" in str(caught.value)
    assert "controller.channels.fast_rest=7.5" in str(caught.value)


class BadLine:
    """The line of a real program, on which something happens to the bytes of frame ``number``."""

    def __init__(self, line: ProgramLine, what: str, number: int) -> None:
        self._line, self._what, self._number, self._questions = line, what, number, -1

    def write(self, data: bytes) -> None:
        self._questions += 1
        if self._questions == self._number:
            if self._what == "flip there":
                data = data[:20] + bytes([data[20] ^ 4]) + data[21:]
            if self._what == "kill":
                os.kill(self._line.process_id, signal.SIGKILL)
            if self._what == "other kind":
                data = Frame(ord("X"), self._number).encoded()
            if self._what == "other length":
                data = Frame(Kind.TICK, self._number, bytes(4)).encoded()
            if self._what == "old answer":
                data = Frame(Kind.TICK, self._number - 1, data[8:-4]).encoded()
        self._line.write(data)

    def read(self, timeout_s: float) -> bytes:
        data = self._line.read(timeout_s)
        if self._questions == self._number:
            if self._what == "flip back":
                return data[:-6] + bytes([data[-6] ^ 128]) + data[-5:]
            if self._what == "lose a byte":
                return data[:11] + data[12:]
            if self._what == "noise":
                return b"\x00gboot\n" + data
        return data


@pytest.mark.parametrize(
    ("what", "words"),
    {
        "flip there": "the firmware refused frame 40: the question arrived with a wrong checksum",
        "flip back": "an answer arrived with a wrong checksum",
        "lose a byte": "no answer within 0.3 s; 183 bytes of an answer arrived",
        "kill": "serial ended with signal 9",
        "other kind": "the firmware refused frame 40: the question is of an unknown kind",
        "other length": "the firmware refused frame 40: the question has another number of words",
        "old answer": "frame 40 was answered by frame 39: a frame was lost",
        "noise": "",
    }.items(),
)
def test_what_happens_on_the_line_is_told(
    what: str, words: str, host: OpenController, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(in_the_loop, "TIMEOUT_S", 0.3 if what == "lose a byte" else 10.0)

    @contextmanager
    def bad() -> Iterator[SerialController]:
        with host() as controller:
            assert isinstance(controller, SerialController)
            assert isinstance(controller._line, ProgramLine)
            yield SerialController(BadLine(controller._line, what, 40), controller.file, 3)

    scenario = dataclasses.replace(HIT, duration_s=0.06)
    if not words:
        assert len(simulate(scenario, controller=bad).time_s) == 61
        return
    with pytest.raises(SimulationError) as caught:
        simulate(scenario, controller=bad)
    assert str(caught.value).startswith(f"controller at t = 0.039 s: {words}")


def test_a_tick_before_the_start_is_refused(host: OpenController) -> None:
    with host() as controller:
        assert isinstance(controller, SerialController)
        assert controller.stepper()(0.0, 1e-3) != 0
        with pytest.raises(SimulationError, match="a tick came before a start that went well"):
            controller.check(3, 0.0)


@pytest.mark.deep
def test_any_bytes_are_survived(tmp_path: Path) -> None:
    """With the sanitizers of gcc, and afterwards a question is answered as ever."""
    for name, content in program_files(Settings.of(giveway.base.native.robot())).items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(content)
    flags = "CFLAGS=-O1 -fsanitize=address,undefined -fno-sanitize-recover=all"
    places = ("BUILD=build", "CORE_BUILD=build", "build/host/serial")
    subprocess.run(["make", "-sj2", "-C", tmp_path, flags, *places], check=True, timeout=300)
    draw = random.Random(1)
    parts = []
    for number in range(20_000):
        body = draw.randbytes(4 * draw.choice([0, 1, 24, 24, 24, 255]))
        frame = bytearray(Frame(draw.choice([*Kind, draw.randrange(256)]), number, body).encoded())
        if draw.random() < 0.3:
            frame[draw.randrange(len(frame))] ^= 1 << draw.randrange(8)
        parts.append(bytes(frame[: draw.randrange(len(frame))] if draw.random() < 0.1 else frame))
    last = Frame(Kind.START, 123456).encoded()
    data = b"".join(parts) + bytes(2000) + last  # the zeros end what was cut off
    done = subprocess.run([tmp_path / "build" / "host" / "serial"], input=data, capture_output=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count(b"gwt") > 500
    assert done.stdout[-28:-20] == b"gws" + bytes([4]) + (123456).to_bytes(4, "little")


def test_no_process_is_left(host: OpenController) -> None:
    with host() as controller:
        assert isinstance(controller, SerialController)
        assert isinstance(controller._line, ProgramLine)
        number = controller._line.process_id
    assert not Path(f"/proc/{number}").exists()


def test_the_command_line(cli: Cli, tmp_path: Path) -> None:
    done = cli("run", "motionless", "--bumper", "none", "--duration", "0.05", "--out", "out", "--controller", "host")
    assert done.returncode == 0, done.stderr
    found = giveway.load(tmp_path / "out")
    assert found.manifest["fmus"]["controller"]["file"] == "serial"
    assert len(found.manifest["fmus"]["controller"]["token"]) == 16


RUN = ("run", "motionless", "--out", "out", "--controller")
WRONG = {
    "a name": ((*RUN, "hots"), ("--controller: hots", "fmu, host, qemu, or a serial device")),
    "no device": ((*RUN, "/dev/nowhere"), ("/dev/nowhere: cannot be opened: No such file",)),
    "no serial device": ((*RUN, "/dev/null"), ("/dev/null: is not a serial device",)),
    "a rate": ((*RUN, "/dev/null@12"), ("--controller /dev/null@12: 12", "9600")),
    "the library": ((*RUN, "host", "--engine", "native"), ("--controller: host", "only with --engine fmu")),
    "another period": (
        (*RUN, "host", "--set", "controller.controller.period=0.002"),
        ("step_s: 0.001", "0.002 s with --controller"),
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_input_is_one_line_and_writes_nothing(case: str, cli: Cli, tmp_path: Path) -> None:
    arguments, words = WRONG[case]
    done = cli(*arguments)
    assert done.returncode == 2, done.stderr
    said = done.stderr.splitlines()[-1]
    assert said.startswith("giveway: ")
    for word in words:
        assert word in said
    assert folder_content(tmp_path) == []


def test_missing_tools_are_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(GivewayError, match=r"only with make on the PATH \(Debian: make\)"):
        controller_of(HIT, "qemu")


def test_a_manifest_names_the_program(host: OpenController) -> None:
    with host() as controller:
        program = controller.file
    assert isinstance(program, Program)
    assert len(program.sha256) == 64
