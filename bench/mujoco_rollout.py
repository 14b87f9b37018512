"""Simulated seconds per second of `mujoco.rollout` on one thread, best of several, as one line of JSON."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import mujoco
import numpy as np
from mujoco import rollout

RUNS = 64


def main(duration_s: float, repeats: int) -> None:
    model = mujoco.MjModel.from_xml_path(str(Path(__file__).with_name("robot_slider.xml")))
    data = mujoco.MjData(model)
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    start = np.zeros(size)
    mujoco.mj_getState(model, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    states = np.tile(start, (RUNS, 1))
    steps = round(duration_s / model.opt.timestep)
    control = np.tile([0.0, 0.0, 0.0, 1.0], (1, steps, 1))
    best = np.inf
    for _ in range(repeats):
        started = time.perf_counter()
        state, _ = rollout.rollout(model, data, states, control)
        best = min(best, time.perf_counter() - started)
    # Position of the slider and speed of the base at the end, as evidence of the collision.
    positions = state[0, :, 1 : 1 + model.nq]
    slider, base = positions[:, 6], positions[:, 1]
    result = {
        "version": mujoco.__version__,
        "runs_per_s": RUNS / best,
        "step_s": model.opt.timestep,
        "slider_m": float(slider[-1]),
        "base_m": float(base[-1]),
    }
    print(json.dumps(result))


if __name__ == "__main__":
    main(float(sys.argv[1]), int(sys.argv[2]))
