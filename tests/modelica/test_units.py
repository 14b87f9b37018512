"""The check of units sees an equation that adds, compares or assigns what has different ones.

That no class has such an equation is checked where they are compiled: test_classes.py.
"""

import shutil
from pathlib import Path

import pytest
from giveway_modelica.compiler import PACKAGE, Compiler, classes
from giveway_modelica.dimensions import parsed, shown, si_types
from giveway_modelica.units import findings


def test_every_function_is_called_by_a_model_that_is_checked(compiler: Compiler) -> None:
    called = set()
    for example in ("MotionlessMagnetic", "BumperTable"):
        called |= set(compiler.load(f"GiveWay.Examples.{example}").to_dict("flat")["functions"])
    assert {found.name for found in classes() if found.kind == "function"} == called


FAULTS = {
    "m = s": ("Components/Slider.mo", "nose.s = s - bumper.c;", "nose.s = time;", "Components.Slider"),
    "m - m/s": ("Components/Slider.mo", "nose.s = s - bumper.c;", "nose.s = s - bumper.u;", "Components.Slider"),
    "N added to N m": ("Components/Motor.mo", "+ flange.tau;", "+ flange.tau/R;", "Components.Motor"),
    "derivative": ("Components/Motor.mo", "der(phi) = w;", "der(phi) = phi;", "Components.Motor"),
    "number": ("Components/HangingWeight.mo", "m*g - tension", "9.81 - tension", "Components.HangingWeight"),
    "condition": ("Components/HangingWeight.mo", "if h > drop", "if h > m", "Components.HangingWeight"),
    "function argument": ("Components/TanhRoller.mo", "tanh(slope*v/r_r)", "tanh(slope*v)", "Components.TanhRoller"),
    "binding": ("Components/OmniBase.mo", "m=robot.base_mass", "m=robot.base_yaw_inertia", "Components.OmniBase"),
    "start": ("Components/Slider.mo", "v_mean(start=v_start", "v_mean(start=v_start*m", "Components.Slider"),
    "when": ("Components/Motor.mo", "reinit(w, 0);", "reinit(w, phi);", "Components.Motor"),
    "trigger": ("Components/Motor.mo", "abs(tau_net) > stiction", "abs(tau_net) > J", "Components.Motor"),
    "discrete": ("Components/JointServo.mo", "k_d*(w_wanted", "k_p*(w_wanted", "Components.ControlledRobot"),
    "call": (
        "Components/SampledController.mo",
        "Functions.rotate(pre(v), -pre",
        "Functions.rotate(pre(x), -pre",
        "Components.ControlledRobot",
    ),
    "inside a function": (
        "Functions/nominalForce.mo",
        "m_roll*omega*v[2]",
        "m_roll*omega",
        "Components.ControlledRobot",
    ),
    "law": ("Components/FoamBumper.mo", "rate_gain*u)", "rate_gain*c)", "Components.FoamBumper"),
    "table": ("Functions/tableEnergy.mo", "e + l*(", "e + (", "Components.TableBumper"),
    "several results": ("Components/DiscContact.mo", "q_y, outline_x", "n_y, outline_x", "Components.DiscContact"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found(modelica_library: Path, tmp_path: Path, fault: str) -> None:
    package = tmp_path / "GiveWay"
    shutil.copytree(PACKAGE, package)
    name, healthy, sick, model = FAULTS[fault]
    path = package / name
    assert healthy in path.read_text()
    text = path.read_text().replace(healthy, sick)
    if "/R;" in sick:
        text = text.replace(
            "parameter SI.Torque coulomb", 'parameter SI.Length R=1 "An arm";\n  parameter SI.Torque coulomb', 1
        )
    path.write_text(text)
    assert list(findings(Compiler(modelica_library, tmp_path / "variants", package), f"GiveWay.{model}"))


def test_units_are_read() -> None:
    assert parsed("N.m.s/rad") == parsed("kg.m2/s")
    assert parsed("N/m") == parsed("kg.s-2") != parsed("N.m")
    assert shown(parsed("m/s2")) == "m.s-2"
    assert si_types()["Torque"] == "N.m"
    assert si_types()["Position"] == "m"
    with pytest.raises(ValueError, match="furlong"):
        parsed("furlong/s")
