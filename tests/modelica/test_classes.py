"""rumoca parses, type-checks and balances every class, its units fit, and what checks itself has no residual."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from giveway_modelica.compiler import PACKAGE, Compiler, ModelicaClass, classes
from giveway_modelica.units import findings

ALL = {found.name: found for found in classes()}
COMPLETE = [name for name, found in ALL.items() if found.kind in ("model", "block") and not found.partial]
OTHERS = [name for name in ALL if name not in COMPLETE]
SELF_CHECKING = [name for name in ALL if name.startswith("GiveWay.Tests.")]
# Largest |residual| per model, in its own unit: what a relative tolerance of 1e-7 leaves of quantities near 1.
RESIDUALS = {
    "FreeBaseEnergy": 1e-6,
    "RollingMass": 1e-7,
    "RollerSteady": 1e-9,
    "GearHolds": 1e-12,
    "LatchImpact": 1e-6,
    "UnevenBase": 1e-6,
}


# rumoca has no past of an input from outside, which these read with pre(): they are compiled inside what drives them.
DRIVEN_IN = {
    "GiveWay.Components.JointServo": "GiveWay.Components.ControlledRobot",
    "GiveWay.Components.SampledController": "GiveWay.Components.ControlledRobot",
}


@pytest.mark.parametrize("name", COMPLETE)
def test_class_compiles_and_is_balanced(compiler: Compiler, name: str) -> None:
    structure = compiler.load(DRIVEN_IN.get(name, name)).structure()
    assert structure.is_balanced
    # What is open at its flanges cannot be solved by itself; what is closed can.
    assert structure.is_matched or not name.startswith(("GiveWay.Examples.", "GiveWay.Tests."))


@pytest.mark.parametrize("name", [name for name in COMPLETE if name not in DRIVEN_IN])
def test_units_are_consistent(compiler: Compiler, name: str) -> None:
    assert list(findings(compiler, name)) == []


@pytest.mark.parametrize("name", OTHERS)
def test_class_has_no_syntax_error(name: str) -> None:
    import rumoca

    assert [found.message for found in rumoca.validate(ALL[name].path) if found.level == "error"] == []


@pytest.mark.parametrize("name", SELF_CHECKING)
def test_model_that_checks_itself_has_no_residual(compiler: Compiler, name: str) -> None:
    residual = np.asarray(compiler.simulate(name)["residual"])
    assert np.isfinite(residual).all()
    assert np.abs(residual).max() < RESIDUALS[name.rsplit(".", 1)[1]]


def test_a_class_with_a_mistake_is_refused(modelica_library: Path, tmp_path: Path) -> None:
    package = tmp_path / "GiveWay"
    shutil.copytree(PACKAGE, package)
    motor = package / "Components" / "Motor.mo"
    healthy = motor.read_text()
    faults = {"  der(phi) = w;\n": "unbalanced", "SI.AngularVelocity w(": "w", "end Motor;": "end"}
    for sick, complaint in faults.items():
        assert sick in healthy
        motor.write_text(healthy.replace(sick, ""))
        with pytest.raises(Exception, match=complaint):
            Compiler(modelica_library, tmp_path / "variants", package).load("GiveWay.Components.Motor")


def test_every_example_is_closed_and_has_an_experiment() -> None:
    found: list[ModelicaClass] = [ALL[name] for name in ALL if name.startswith(("GiveWay.Examples.", "GiveWay.Tests."))]
    assert len(found) == 25
    assert all(example.experiment for example in found)
