"""The golden bits of c_core: here, on a Cortex-M4F, in the firmware example, and inside the controller's FMU.

`make verify` compares all other compilers, optimisation levels and machines.
"""

from __future__ import annotations

import functools
import os
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from giveway.base import native
from giveway.robot.presets import preset_values
from giveway.robot.variables import Value, VariableTable, table
from giveway.simulation.fmu import Instance, open_fmu

from verify import golden
from verify.context import Context
from verify.targets import HOST, TARGETS, Target, core_sources

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "firmware_mps2_an386"
FNV_START, FNV_PRIME = 0xCBF29CE484222325, 0x100000001B3
NAN_BITS = 0x7FC00000
# Outputs that are newer than the digests, which keep their values.
NOT_DIGESTED = {"detection.channel", "imu.trusted", "estimate.acceleration_source"}


def context(folder: Path) -> Context:
    return Context(ROOT, folder, os.environ["PATH"])


def expected(module: str) -> str:
    (line,) = [line for line in golden.read_table(ROOT, 0).splitlines() if line.split()[0] == module]
    return line.split()[2]


@pytest.mark.parametrize(
    ("target", "double"),
    [(HOST, 0), (HOST, 1), (TARGETS["cortex-m4f"], 0), (TARGETS["cortex-m7"], 1)],
    ids=lambda value: value.name if isinstance(value, Target) else golden.TYPES[value],
)
def test_bits_are_the_golden_ones(tmp_path: Path, target: Target, double: int) -> None:
    program = golden.build(context(tmp_path), target, ROOT / "c_core", double, "golden", "-O2")
    golden.compare(target.name, golden.digests(context(tmp_path), target, program), golden.read_table(ROOT, double))


SOFT_DOUBLE = r"""
#include <stdio.h>
int main(void)
{
    volatile double one = 1.0, small = 0x1.2f84f34dfab73p-33;
    (void)printf("%.17g\n", one - small);
    return 0;
}
"""


def test_software_double_on_arm_still_rounds_wrongly(tmp_path: Path) -> None:
    """Once this fails, `double_rounds` of verify/targets.py may become true for every Cortex-M."""
    source = tmp_path / "difference.c"
    source.write_text(SOFT_DOUBLE, encoding="utf-8")
    answers = {}
    for target in (HOST, TARGETS["cortex-m4f"], TARGETS["cortex-m7"]):
        program = target.build(context(tmp_path), [source], tmp_path / target.name, "-O2")
        answers[target.name] = float(target.run(context(tmp_path), program, timeout_s=60.0).stdout)
    assert answers["x86-64"] == answers["cortex-m7"] == 1.0 - float.fromhex("0x1.2f84f34dfab73p-33")
    assert answers["cortex-m4f"] == answers["x86-64"] - 2.0**-53


def test_every_module_has_a_digest() -> None:
    modules = {line.split()[0].partition(".")[0] for line in golden.read_table(ROOT, 0).splitlines()}
    files = {path.stem.removeprefix("gw_") for path in (ROOT / "c_core" / "src").glob("*.c")}
    assert files <= modules


class ControllerFmu:
    """The controller's FMU, tick by tick, and the digest of its outputs as the C programs compute it."""

    def __init__(self, instance: Instance, variables: VariableTable, parameters: dict[str, Value]) -> None:
        self.inputs = [(v.name, v.type, v.reference) for v in variables.select("input")]
        outputs = [v for v in variables.select("output") if v.name not in NOT_DIGESTED]
        self.kinds = {kind: [v.reference for v in outputs if v.type == kind] for kind in ("real", "integer", "boolean")}
        self.order = [(v.type, self.kinds[v.type].index(v.reference)) for v in outputs]
        self.names = [v.name for v in outputs]
        self.instance = instance
        self.tick = 0
        self.digest = FNV_START
        instance.initialise(parameters, variables)
        self.step = instance.stepper()

    def set(self, values: dict[str, float]) -> None:
        for kind in self.kinds:
            chosen = [(values[name], reference) for name, of, reference in self.inputs if of == kind]
            array = np.array([value for value, _ in chosen], dtype=self.instance.dtype(kind))
            assert self.instance.setter(kind, [reference for _, reference in chosen])(array.ctypes.data) == 0

    def run_tick(self, values: dict[str, float]) -> dict[str, float]:
        self.set(values)
        assert self.step(self.tick * 1e-3, 1e-3) == 0
        self.tick += 1
        arrays = {}
        for kind, references in self.kinds.items():
            arrays[kind] = np.zeros(len(references), dtype=self.instance.dtype(kind))
            assert self.instance.getter(kind, references)(arrays[kind].ctypes.data) == 0
        found = [arrays[kind][index] for kind, index in self.order]
        for (kind, _), value in zip(self.order, found, strict=True):
            for byte in bytes_of(kind, value):
                self.digest = ((self.digest ^ byte) * FNV_PRIME) & 0xFFFFFFFFFFFFFFFF
        return dict(zip(self.names, map(float, found), strict=True))


def bytes_of(kind: str, value: float) -> bytes:
    if kind == "boolean":
        return bytes([bool(value)])
    if kind == "integer":
        return int(value).to_bytes(4, "little", signed=True)
    single = np.float32(value)
    assert float(single) == float(value) or np.isnan(single), "an output of the float controller that is no float"
    return NAN_BITS.to_bytes(4, "little") if np.isnan(single) else single.tobytes()


@pytest.fixture(params=[2, 3], ids=["fmi2", "fmi3"])
def opened(request: pytest.FixtureRequest) -> Iterator[tuple[Instance, VariableTable]]:
    with Instance(open_fmu(native.fmu("controller", request.param)), "controller") as instance:
        yield instance, table("controller")


def signed(word: int) -> int:
    return word - (1 << 32) if word >= (1 << 31) else word


@functools.cache
def _inputs() -> tuple[str, ...]:
    return tuple(variable.name for variable in table("controller").select("input"))


def standing() -> dict[str, float]:
    return dict.fromkeys(_inputs(), 0.0)


def test_the_fmu_gives_the_golden_bits_of_the_script(tmp_path: Path, opened: tuple[Instance, VariableTable]) -> None:
    folder = ROOT / "tests" / "c_core"
    program = HOST.build(
        context(tmp_path),
        [
            *core_sources(ROOT / "c_core"),
            folder / "fmu_inputs" / "print_inputs.c",
            folder / "golden" / "script.c",
            folder / "golden" / "generator.c",
        ],
        tmp_path / "print_inputs",
        "-O2",
        f"-I{folder / 'golden'}",
    )
    lines = HOST.run(context(tmp_path), program).stdout.splitlines()
    fmu = ControllerFmu(*opened, parameters=preset_values("paper"))
    plan = ("x", "y", "theta", "vx", "vy", "omega", "ax", "ay", "alpha")
    assert len(lines) > 5000
    for line in lines:
        words = line.split()
        values = standing()  # without accelerometer and gyro
        values |= {f"sensor.torque[{wheel}]": float.fromhex(words[wheel]) for wheel in range(3)}
        values |= {f"sensor.encoder[{wheel}]": int(words[3 + wheel]) for wheel in range(3)}
        values |= {"sensor.counter": signed(int(words[6])), "sensor.present": int(words[7])}
        values |= {f"plan.{name}": float.fromhex(word) for name, word in zip(plan, words[8:17], strict=True)}
        values |= {"stop_request": int(words[17]), "tare_request": int(words[18])}
        fmu.run_tick(values)
    assert f"{fmu.digest:016x}" == expected("controller.trikey")


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> str:
    """What the firmware says on its processor."""
    make = ["make", "--silent", "-C", str(EXAMPLE), f"BUILD={tmp_path_factory.mktemp('firmware')}", "run"]
    return subprocess.run(make, check=True, capture_output=True, text=True, timeout=300).stdout


def test_firmware_and_fmu_notice_the_recorded_collision_alike(
    printed: str, opened: tuple[Instance, VariableTable]
) -> None:
    ticks, digest = replayed(opened, {"supervisor.after_settled": 0})
    first = next(tick for tick in ticks if tick >= 0)
    assert printed == f"first hit at tick {first}\nlast hit at tick {ticks[-1]}\noutputs {digest}\n"
    for page in (EXAMPLE / "README.md", ROOT / "docs" / "site" / "tutorials" / "microcontroller.md"):
        assert printed in page.read_text(encoding="utf-8"), page


def test_the_paper_s_reflex_on_the_recorded_collision(opened: tuple[Instance, VariableTable]) -> None:
    _, digest = replayed(opened, {"supervisor.after_settled": 0, **preset_values("paper")})
    assert digest == expected("controller.recorded")


def replayed(opened: tuple[Instance, VariableTable], parameters: dict[str, Value]) -> tuple[list[int], str]:
    """Ticks of the last hit, tick by tick, and the digest of all outputs."""
    fmu = ControllerFmu(*opened, parameters=parameters)
    rows = re.findall(r"^\{(.*)\},$", (EXAMPLE / "recorded_collision.inc").read_text(), re.MULTILINE)
    ticks = []
    for counter, row in enumerate(rows):
        numbers = [int(word) for word in row.split(",")]
        values = standing() | {"sensor.counter": counter, "sensor.present": 1}
        values |= {f"sensor.torque[{wheel}]": numbers[wheel] * 0.0143 for wheel in range(3)}
        values |= {f"sensor.encoder[{wheel}]": numbers[3 + wheel] for wheel in range(3)}
        ticks.append(int(fmu.run_tick(values)["detection.tick"]))
    return ticks, f"{fmu.digest:016x}"
