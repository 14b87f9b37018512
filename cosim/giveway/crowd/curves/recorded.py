"""Runs of the crowd's robots for the curves, with what their controllers estimate and when they follow the plan."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway import batch
from giveway.crowd.curves.candidates import Residual
from giveway.crowd.curves.situations import REST, situations, ticks_since
from giveway.crowd.parts import Interrupted
from giveway.crowd.population import start_value
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from giveway.scenario.scenario import Scenario

__all__ = ["RESIDUAL_TRACES", "Recording", "record"]

REFERENCE = ("controller.reference.vx", "controller.reference.vy", "controller.reference.omega", "controller.mode")
WRENCH = ("controller.estimate.force_x", "controller.estimate.force_y", "controller.estimate.torque_z")
ENCODERS = tuple(f"testbed.sensor.encoder[{wheel}]" for wheel in range(WHEELS))
RESIDUAL_TRACES = (*WRENCH, *ENCODERS)
TURNED_S = 0.06  # after its last count a wheel counts as still
TRACKING = 1  # controller.mode: it follows the plan


@dataclass(frozen=True)
class Recording:
    """Some runs side by side.

    Attributes:
        traces: as asked for, (runs, n).
        situations: of each tick, (runs, n).
        tracking: the controller followed the plan before this tick, (runs, n).
        step_s: between two rows.
        failed: by index, why a run has no result.
        rows: of each run; what follows is empty.
    """

    traces: Mapping[str, NDArray[np.float64]]
    situations: NDArray[np.int8]
    tracking: NDArray[np.bool_]
    step_s: float
    failed: Mapping[int, str]
    rows: tuple[int, ...]

    def residual(self) -> Residual:
        """Of runs with `RESIDUAL_TRACES`; the wrench is 0 until the first tare is done."""
        wrench = np.stack([self.traces[name] for name in WRENCH], axis=1)
        moved = np.zeros(self.situations.shape, dtype=np.bool_)
        for name in ENCODERS:
            count = self.traces[name]
            moved |= np.diff(count, axis=-1, prepend=count[..., :1]) != 0.0
        still = (self.situations == REST) & (ticks_since(moved) >= round(TURNED_S / self.step_s))
        return Residual(np.where(self.tracking[:, None, :], wrench, 0.0), self.situations, still)


def record(
    scenarios: Sequence[Scenario],
    traces: Sequence[str],
    method: str,
    threads: int,
    progress: Callable[[int], None],
    robot: Path | None = None,
) -> Recording:
    """Run ``scenarios``, which last equally long and are of ``robot``, and keep ``traces``. Ctrl-C: `Interrupted`."""
    wanted = list(dict.fromkeys([*traces, *REFERENCE]))
    table = batch.Prepared(scenarios, traces=wanted).run(
        threads=threads, method=method, progress=lambda done, _of: progress(done)
    )
    if table.attrs["interrupted"]:
        raise Interrupted
    step_s = scenarios[0].step_s
    # What the controller finds in a tick belongs to the reference and the mode of the tick before.
    vx, vy, omega, mode = (_before(table[name].values) for name in REFERENCE)
    rim = omega * start_value("wheel.distance", robot=robot)
    status, message = table["status"].values, table["message"].values
    failed = {index: str(message[index]) for index in range(len(scenarios)) if str(status[index]) != "ok"}
    rows = tuple(round(float(simulated) / step_s) + 1 for simulated in table["simulated"].values)
    kept = {name: np.asarray(table[name].values) for name in traces}
    return Recording(kept, situations(np.hypot(vx, vy), rim, step_s), mode == TRACKING, step_s, failed, rows)


def _before(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of the row before."""
    return np.concatenate([values[:, :1], values[:, :-1]], axis=1)
