"""fmuloader: FMI's functions one by one; it reads no model description, so FMPy's reader supplies names."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import fmpy
from fmuloader.fmi2 import Fmi2Slave, Fmi2Type
from fmuloader.fmi3 import Fmi3Slave
from raw_loop import probe

VERBS = {2: {"real": "real", "integer": "integer", "boolean": "boolean"},
         3: {"real": "float64", "integer": "int32", "boolean": "boolean"}}  # fmt: skip


class LoadedFmu:
    def __init__(self, path: str, version: int) -> None:
        self.description = fmpy.read_model_description(path, validate=False)
        self.version = version
        identifier = self.description.coSimulation.modelIdentifier
        self.fmu = (Fmi2Slave if version == 2 else Fmi3Slave)(path, model_identifier=identifier)
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.state_count = self.description.numberOfContinuousStates or 0

    def instantiate(self, exchange: bool) -> None:
        if self.version == 2:
            kind = Fmi2Type.MODEL_EXCHANGE if exchange else Fmi2Type.CO_SIMULATION
            self.fmu.instantiate("probe", kind, guid=self.description.guid)
        else:
            make = self.fmu.instantiate_model_exchange if exchange else self.fmu.instantiate_co_simulation
            make("probe", instantiation_token=self.description.instantiationToken)

    def initialise(self) -> None:
        if self.version == 2:
            self.fmu.setup_experiment(start_time=0.0)
        self.fmu.enter_initialization_mode()
        self.fmu.exit_initialization_mode()

    def get(self, kind: str, references: list[int]) -> list[Any]:
        return getattr(self.fmu, "get_" + VERBS[self.version][kind])(references)

    def set(self, kind: str, references: list[int], values: list[Any]) -> None:
        getattr(self.fmu, "set_" + VERBS[self.version][kind])(references, values)

    def step(self, time_s: float, step_s: float) -> None:
        self.fmu.do_step(time_s, step_s)

    def update(self) -> tuple[bool, float]:
        if self.version == 2:
            said = self.fmu.new_discrete_states()
            return bool(said.newDiscreteStatesNeeded), float(said.nextEventTime)
        told = self.fmu.update_discrete_states()
        return bool(told.discrete_states_need_update), float(told.next_event_time)

    def enter(self, mode: str) -> None:
        if mode == "event":
            self.fmu.enter_event_mode()
        else:
            self.fmu.enter_continuous_time_mode()

    def set_time(self, time_s: float) -> None:
        self.fmu.set_time(time_s)

    def states(self) -> list[float]:
        return self.fmu.get_continuous_states(self.state_count)

    def set_states(self, values: list[float]) -> None:
        self.fmu.set_continuous_states(values)

    def derivatives(self) -> list[float]:
        get = self.fmu.get_derivatives if self.version == 2 else self.fmu.get_continuous_state_derivatives
        return get(self.state_count)

    def completed(self) -> bool:
        return bool(self.fmu.completed_integrator_step()[0])

    def finish(self) -> None:
        self.fmu.terminate()
        self.fmu.free_instance()


if __name__ == "__main__":
    probe(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")), LoadedFmu)
