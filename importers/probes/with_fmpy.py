"""FMPy: its classes that wrap the FMI functions one by one."""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

import fmpy
from fmpy import fmi2, fmi3
from raw_loop import probe

VERBS = {2: {"real": "Real", "integer": "Integer", "boolean": "Boolean"},
         3: {"real": "Float64", "integer": "Int32", "boolean": "Boolean"}}  # fmt: skip


class FmpyFmu:
    def __init__(self, path: str, version: int) -> None:
        self.folder = tempfile.mkdtemp()
        fmpy.extract(path, unzipdir=self.folder)
        self.description = fmpy.read_model_description(path, validate=True)
        self.version = version
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.state_count = self.description.numberOfContinuousStates or 0

    def instantiate(self, exchange: bool) -> None:
        interface = self.description.modelExchange if exchange else self.description.coSimulation
        token = self.description.guid if self.version == 2 else self.description.instantiationToken
        kinds = {
            (2, False): fmi2.FMU2Slave,
            (2, True): fmi2.FMU2Model,
            (3, False): fmi3.FMU3Slave,
            (3, True): fmi3.FMU3Model,
        }
        self.fmu = kinds[self.version, exchange](
            guid=token, unzipDirectory=self.folder, modelIdentifier=interface.modelIdentifier, instanceName="probe"
        )
        self.fmu.instantiate()

    def initialise(self) -> None:
        if self.version == 2:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def get(self, kind: str, references: list[int]) -> list[Any]:
        return getattr(self.fmu, "get" + VERBS[self.version][kind])(references)

    def set(self, kind: str, references: list[int], values: list[Any]) -> None:
        getattr(self.fmu, "set" + VERBS[self.version][kind])(references, values)

    def step(self, time_s: float, step_s: float) -> None:
        self.fmu.doStep(time_s, step_s)

    def update(self) -> tuple[bool, float]:
        said = self.fmu.newDiscreteStates() if self.version == 2 else self.fmu.updateDiscreteStates()
        return bool(said[0]), float(said[5])

    def enter(self, mode: str) -> None:
        if mode == "event":
            self.fmu.enterEventMode()
        else:
            self.fmu.enterContinuousTimeMode()

    def set_time(self, time_s: float) -> None:
        self.fmu.setTime(time_s)

    def _array(self, values: list[float] | None = None) -> Any:
        import ctypes

        return (ctypes.c_double * self.state_count)(*(values or []))

    def states(self) -> list[float]:
        room = self._array()
        self.fmu.getContinuousStates(room, self.state_count)
        return list(room)

    def set_states(self, values: list[float]) -> None:
        self.fmu.setContinuousStates(self._array(values), self.state_count)

    def derivatives(self) -> list[float]:
        room = self._array()
        get = self.fmu.getDerivatives if self.version == 2 else self.fmu.getContinuousStateDerivatives
        get(room, self.state_count)
        return list(room)

    def completed(self) -> bool:
        return bool(self.fmu.completedIntegratorStep()[0])

    def finish(self) -> None:
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


if __name__ == "__main__":
    probe(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")), FmpyFmu)
