"""A short co-simulation loop over any importer that exposes the plain FMI functions.

Exchange order as in fmu/README.md: sensors, controller, command, testbed.
"""

from __future__ import annotations

from typing import Any, Protocol

from report import STEP_S, stage, write_trace

REALS = {"sensors": [*(f"sensor.torque[{i}]" for i in range(3)),
                     *(f"sensor.acceleration[{i}]" for i in range(2)), "sensor.yaw_rate"],
         "commands": [f"command.{w}[{i}]" for w in ("wheel_angle", "wheel_speed") for i in range(3)]}  # fmt: skip
INTEGERS = {"sensors": [*(f"sensor.encoder[{i}]" for i in range(3)), "sensor.counter", "sensor.imu_counter"],
            "commands": []}  # fmt: skip
BOOLEANS = {"sensors": ["sensor.present", "sensor.imu_present"], "commands": ["command.enable"]}
TICK_S, SUBSTEPS = 5e-4, 10
KINDS = ("real", "integer", "boolean")


class Fmu(Protocol):
    """One instance, through an importer; ``kind`` is "real", "integer" or "boolean"."""

    references: dict[str, int]

    def instantiate(self, exchange: bool) -> None: ...
    def initialise(self) -> None: ...
    def get(self, kind: str, references: list[int]) -> list[Any]: ...
    def set(self, kind: str, references: list[int], values: list[Any]) -> None: ...
    def step(self, time_s: float, step_s: float) -> None: ...
    def finish(self) -> None: ...

    # Model Exchange.
    state_count: int

    def update(self) -> tuple[bool, float]:
        """(again, next event time in s)."""

    def enter(self, mode: str) -> None: ...
    def set_time(self, time_s: float) -> None: ...
    def states(self) -> list[float]: ...
    def set_states(self, values: list[float]) -> None: ...
    def derivatives(self) -> list[float]: ...
    def completed(self) -> bool: ...


def pass_on(source: Fmu, sink: Fmu, what: str) -> None:
    """Copies outputs of one FMU to the inputs of the other with the same names."""
    for kind, names in zip(KINDS, (REALS[what], INTEGERS[what], BOOLEANS[what]), strict=True):
        if names:
            values = source.get(kind, [source.references[name] for name in names])
            sink.set(kind, [sink.references[name] for name in names], values)


def assign(fmu: Fmu, model: str, parameters: dict[str, Any]) -> None:
    """The job's parameters of ``model``, all of them whole numbers."""
    for name, value in parameters.items():
        if name.startswith(model + "."):
            fmu.set("integer", [fmu.references[name.removeprefix(model + ".")]], [int(value)])


def probe(job: dict[str, Any], make: Any) -> None:
    """All stages; ``make(path, version)`` gives an `Fmu` that has been loaded."""
    exchange = job["interface"] == "ME"
    with stage("load"):
        controller, testbed = make(job["controller"], job["version"]), make(job["testbed"], job["version"])
        controller.instantiate(False)
        testbed.instantiate(exchange)
    with stage("initialise"):
        for model, fmu in (("controller", controller), ("testbed", testbed)):
            assign(fmu, model, job["parameters"])
            fmu.initialise()
    recorded = [testbed.references[name] for name in job["recorded"]]
    rows: list[list[float]] = []
    loop = _Exchange(testbed) if exchange else None

    def step(k: int) -> None:
        rows.append([k * STEP_S, *testbed.get("real", recorded)])
        if loop is None:
            pass_on(testbed, controller, "sensors")
            controller.step(k * STEP_S, STEP_S)
            pass_on(controller, testbed, "commands")
            testbed.step(k * STEP_S, STEP_S)
        else:
            # At a bus cycle the first update samples the sensors; the controller answers before the second.
            loop.update(lambda: _answer(testbed, controller, k))
            for tick in (k * STEP_S + TICK_S, (k + 1) * STEP_S):
                loop.integrate(tick)
                if tick == k * STEP_S + TICK_S:
                    loop.update(lambda: None)

    with stage("step"):
        step(0)
    with stage("closed loop"):
        for k in range(1, job["steps"]):
            step(k)
        rows.append([job["steps"] * STEP_S, *testbed.get("real", recorded)])
        write_trace(job["trace"], job["recorded"], rows)
        testbed.finish()
        controller.finish()


def _answer(testbed: Fmu, controller: Fmu, k: int) -> None:
    pass_on(testbed, controller, "sensors")
    controller.step(k * STEP_S, STEP_S)
    pass_on(controller, testbed, "commands")


class _Exchange:
    """Fourth-order Runge-Kutta at 50 us between time events; an event within a step is handled after the step."""

    def __init__(self, fmu: Fmu) -> None:
        self.fmu, self.time_s = fmu, 0.0
        self.in_events = True  # as the initialisation ends

    def update(self, between: Any) -> None:
        """Event updates until no further one is requested; ``between`` is called after the first."""
        if not self.in_events:
            self.fmu.enter("event")
        again, _ = self.fmu.update()
        between()
        while again:
            again, _ = self.fmu.update()
        self.fmu.enter("continuous")
        self.in_events = False

    def integrate(self, until_s: float) -> None:
        step = (until_s - self.time_s) / SUBSTEPS
        for n in range(1, SUBSTEPS + 1):
            self._advance(step, until_s if n == SUBSTEPS else self.time_s + step)
            if self.fmu.completed() and n < SUBSTEPS:
                self.update(lambda: None)

    def _slope(self, time_s: float, states: list[float]) -> list[float]:
        self.fmu.set_time(time_s)
        self.fmu.set_states(states)
        return self.fmu.derivatives()

    def _advance(self, h: float, end_s: float) -> None:
        t, x = self.time_s, self.fmu.states()
        k1 = self._slope(t, x)
        k2 = self._slope(t + h / 2, [a + h / 2 * b for a, b in zip(x, k1, strict=True)])
        k3 = self._slope(t + h / 2, [a + h / 2 * b for a, b in zip(x, k2, strict=True)])
        k4 = self._slope(end_s, [a + h * b for a, b in zip(x, k3, strict=True)])
        self.fmu.set_states(
            [a + h / 6 * (b + 2 * c + 2 * d + e) for a, b, c, d, e in zip(x, k1, k2, k3, k4, strict=True)]
        )
        self.time_s = end_s
