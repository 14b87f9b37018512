"""The smallest push that can be noticed: against simulated pushes, and its noise against integrals of the filters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import giveway
import numpy as np
import pytest
from giveway.drivetrain import smallest_push
from giveway.drivetrain.smallest_push import CONTROLLER, TESTBED, smallest_push_n
from giveway.scenario.scenario_file import scenario_of
from giveway.study.quantities import columns
from scipy.integrate import quad

Values = dict[str, np.ndarray[Any, np.dtype[np.float64]]]


def robot(**changes: float) -> tuple[Values, Values]:
    """Parameters of both models, at their start values but for ``changes`` (model__name with dots as underscores)."""
    start = columns().start
    both: tuple[Values, Values] = ({}, {})
    for found, model, names in zip(both, ("controller", "testbed"), (CONTROLLER, TESTBED), strict=True):
        for name in names:
            full = f"{model}.{name}"
            found[name] = np.array([changes.get(full, start[columns().index[full]])])
    return both


def stiff(stiffness: float, noise: float) -> dict[str, float]:
    return {
        "testbed.drivetrain.stiffness": stiffness,
        "controller.estimator.drivetrain_stiffness": stiffness,
        "testbed.electronics.torque_noise": noise,
        "controller.estimator.torque_noise": noise,
    }


def noticed(force_n: float, changes: dict[str, float]) -> bool:
    """A push at the base's middle, towards -120 degrees, for 1.5 s."""
    tables: dict[str, dict[str, float]] = {"controller": {}, "testbed": {}}
    for name, value in changes.items():
        model, _, variable = name.partition(".")
        tables[model][variable] = value
    push = {"force": force_n, "direction": -120.0, "point": [0.0, 0.0], "start": 1.0, "duration": 1.5, "ramp": 0.0}
    document = {"schema_version": 1, "duration": 2.5, "push": [push], **tables}
    result = giveway.run(scenario_of(document, Path("push.toml")), engine="native")
    (detections,) = [one.value for one in result.pushes[0] if one.name == "detections"]
    return bool(detections)


@pytest.mark.parametrize("changes", [{}, stiff(10000.0, 0.005), {"controller.channels.fast_rest": 20.0,
                                                                 "controller.channels.slow_rest": 8.0}])  # fmt: skip
def test_a_simulated_push_is_noticed_above_and_not_below(changes: dict[str, float]) -> None:
    least = float(smallest_push_n(*robot(**changes))[0])
    assert noticed(1.25 * least, changes)
    assert not noticed(0.8 * least, changes)  # noise and the drivetrain's swinging help it over the threshold


def test_by_motor_current_it_would_promise_what_the_gears_hide() -> None:
    """Why a study refuses it there: below the gears' stiction nothing of the push reaches the signal."""
    least = float(smallest_push_n(*robot())[0])
    assert not noticed(1.25 * least, {"testbed.drivetrain.sensing": 1})


def test_softer_and_noisier_sensors_need_harder_pushes() -> None:
    found = [
        float(smallest_push._fast_channel_n(*robot(**stiff(k, noise)))[0])
        for k, noise in ((10000.0, 0.03), (700.0, 0.03), (700.0, 0.1), (100.0, 0.1))
    ]
    assert found == sorted(found)
    assert found[-1] > 3.0 * found[0]


def test_the_other_detectors_have_one_number() -> None:
    for kind, name in ((0, "detector.force_threshold"), (1, "detector.leak_rest")):
        controller, testbed = robot(**{"controller.detector.kind": kind})
        assert smallest_push_n(controller, testbed) == pytest.approx(controller[name])


@pytest.mark.parametrize("time_s", smallest_push.BANK_S)
def test_the_noise_is_the_integral_over_the_filters(time_s: float) -> None:
    """White noise of one torque per tick through |s^2 G| as a position and |G| as a force, G of three poles."""
    controller, testbed = robot()
    w, a = float(controller["estimator.rate_cutoff"][0]), 1.0 / time_s
    period = float(controller["controller.period"][0])

    def size2(frequency: float) -> float:
        return (w**2 * a) ** 2 / ((frequency**2 + w**2) ** 2 * (frequency**2 + a**2))

    force = quad(size2, 0.0, np.inf, limit=400)[0] / np.pi
    acceleration = quad(lambda f: f**4 * size2(f), 0.0, np.inf, limit=400)[0] / np.pi
    radius = float(testbed["wheel.radius"][0])
    mass = float(testbed["base.mass"][0]) + 1.5 * float(
        testbed["wheel.inertia"][0] / radius**2 + testbed["roller.inertia"][0] / testbed["roller.radius"][0] ** 2
    )
    compliance = 1.0 / float(controller["estimator.drivetrain_stiffness"][0])
    wanted = period * (1.5 / radius**2 * force + mass**2 * 2.0 / 3.0 * (compliance * radius) ** 2 * acceleration)
    found = smallest_push._force_variance(controller, testbed, np.array([compliance]), time_s)
    assert found == pytest.approx(wanted, rel=1e-6)  # of the numerical integrals


def test_a_step_behind_baseline_and_low_pass_peaks_where_it_is_said() -> None:
    """With noiseless sensors only the floor counts."""
    controller, testbed = robot(**{**stiff(1e5, 0.0), "testbed.electronics.torque_resolution": 0.0})
    tau, base = smallest_push.BANK_S[0], float(controller["channels.baseline_time"][0])
    t = np.linspace(0.0, 0.2, 200_001)
    seen = base / (base - tau) * (np.exp(-t / base) - np.exp(-t / tau))
    wanted = float(controller["channels.fast_rest"][0]) / seen.max()
    assert smallest_push._fast_channel_n(controller, testbed) == pytest.approx(wanted, rel=1e-6)
