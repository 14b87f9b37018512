"""Collisions per second of the two FMUs (FMI 2.0) under ecos, loaded once, best of several, as JSON."""

from __future__ import annotations

import json
import sys
import time

from ecospy import EcosSimulation, EcosSimulationStructure

STEP_S = 1e-3


def main(fmus: str, duration_s: float, repeats: int) -> None:
    connections = json.loads(sys.stdin.read())
    best, steps = float("inf"), round(duration_s / STEP_S)
    with EcosSimulationStructure() as structure:
        # In this order a step transfers the sensor values, then steps the controller and then the testbed.
        for model in ("controller", "testbed"):
            structure.add_model(model, f"{fmus}/giveway_{model}_fmi2.fmu")
        for kind, source, target in connections:
            getattr(structure, f"make_{kind}_connection")(source, target)
        with EcosSimulation(structure=structure, step_size=STEP_S) as simulation:
            for _ in range(repeats):
                started = time.perf_counter()
                simulation.init()
                simulation.step(steps)
                force = simulation.get_real("testbed::truth.contact_impulse_y")
                simulation.reset()
                best = min(best, time.perf_counter() - started)
    print(json.dumps({"runs_per_s": 1.0 / best, "impulse_y": force}))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), int(sys.argv[3]))
