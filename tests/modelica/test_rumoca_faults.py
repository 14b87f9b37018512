"""Known faults of rumoca 0.10.2, each as it shows. One that fails here is mended: the workaround it names can go."""

import importlib.metadata
from pathlib import Path

import pytest

BOUNCE = """
partial model Law
  parameter Real k=1;
  input Real u;
  Real y;
end Law;
model Line
  extends Law;
equation
  y = k*u;
end Line;
model Curve
  extends Law;
equation
  y = k*u^2;
end Curve;
"""


def compiled(tmp_path: Path, text: str, name: str = "M"):  # type: ignore[no-untyped-def]
    import rumoca

    path = tmp_path / "M.mo"
    path.write_text(text)
    return rumoca.Session(roots=[]).load(path, model=name)


def test_the_version_is_the_one_with_these_faults() -> None:
    assert importlib.metadata.version("rumoca") == "0.10.2"


def test_a_modifier_of_a_redeclared_model_is_dropped(tmp_path: Path) -> None:
    """Parts therefore find their numbers in the robot's record, not in modifiers of a redeclaration."""
    text = BOUNCE + (
        "model Holder\n  replaceable model L = Line constrainedby Law;\n  L law(u=time);\nend Holder;\n"
        "model M\n  Holder holder(redeclare model L = Curve(k=3));\nend M;\n"
    )
    result = compiled(tmp_path, text).simulate(t=(0.0, 2.0), dt=1.0)
    assert result["holder.law.y"][-1] == pytest.approx(4.0)  # 3*2^2 = 12 if it were kept


def test_a_redeclaration_two_levels_deep_is_dropped(tmp_path: Path) -> None:
    """`HardDummy` and the like redeclare level by level."""
    text = BOUNCE + (
        "model Part\n  replaceable Line law(u=time) constrainedby Law(u=time);\nend Part;\n"
        "model Whole\n  Part part;\nend Whole;\n"
        "model M\n  Whole whole(part(redeclare Curve law));\nend M;\n"
    )
    result = compiled(tmp_path, text).simulate(t=(0.0, 2.0), dt=1.0)
    assert result["whole.part.law.y"][-1] == pytest.approx(2.0)  # 4 if it were a Curve


def test_a_replaceable_model_cannot_be_handed_on(tmp_path: Path) -> None:
    """The same workaround."""
    text = BOUNCE + (
        "model Part\n  replaceable model L = Line constrainedby Law;\n  L law(u=time);\nend Part;\n"
        "model M\n  replaceable model L = Curve constrainedby Law;\n  Part part(redeclare model L = L);\nend M;\n"
    )
    result = compiled(tmp_path, text).simulate(t=(0.0, 2.0), dt=1.0)
    assert result["part.law.y"][-1] == pytest.approx(2.0)  # 4 if it were a Curve


def test_a_chain_of_flags_through_numbers_seems_a_loop(tmp_path: Path) -> None:
    """`SampledController`: `lasts` reads `samples`, or it would be sorted beside the flags its mean depends on."""
    text = (
        "model M\n  Real s(start=0, fixed=true);\n  discrete Real x(start=0, fixed=true);\n"
        "  discrete Boolean b(start=false, fixed=true), c(start=false, fixed=true);\nequation\n  der(s) = 1;\n"
        "  when sample(0, 0.1) then\n    b = s > 0.5;\n    x = if b then 1 else 0;\n    c = x > 0.5;\n"
        "  end when;\nend M;\n"
    )
    with pytest.raises(Exception, match="algebraic loop"):
        compiled(tmp_path, text).simulate(t=(0.0, 1.0), dt=0.1)


def test_an_element_of_a_discrete_vector_cannot_be_assigned(tmp_path: Path) -> None:
    """`SampledController` assigns whole vectors."""
    text = (
        "model M\n  discrete Real x[2](each start=0, each fixed=true);\nequation\n"
        "  when sample(0, 0.1) then\n    x[1] = 1;\n    x[2] = 2;\n  end when;\nend M;\n"
    )
    with pytest.raises(Exception, match="not a discrete coordinate"):
        compiled(tmp_path, text)


def test_an_array_constructor_with_an_index_in_a_when_clause_panics(tmp_path: Path) -> None:
    """`SampledController` writes out its vectors of three."""
    text = (
        "model M\n  discrete Real x[2](each start=0, each fixed=true);\nequation\n"
        "  when sample(0, 0.1) then\n    x = {pre(x[i]) + i for i in 1:2};\n  end when;\nend M;\n"
    )
    with pytest.raises(BaseException, match="comprehension"):
        compiled(tmp_path, text)


def test_several_results_of_a_function_in_a_when_clause_are_refused(tmp_path: Path) -> None:
    """`Functions.escapeStep` has one result of four velocities."""
    text = (
        "function two\n  input Real u;\n  output Real a;\n  output Real b;\nalgorithm\n  a := u;\n  b := 2*u;\n"
        "end two;\n"
        "model M\n  discrete Real a(start=0, fixed=true), b(start=0, fixed=true);\nequation\n"
        "  when sample(0, 0.1) then\n    (a, b) = two(time);\n  end when;\nend M;\n"
    )
    with pytest.raises(Exception, match="multi-output"):
        compiled(tmp_path, text)


def test_the_past_of_an_input_from_outside_is_refused(tmp_path: Path) -> None:
    """`JointServo` is compiled inside what drives it."""
    text = (
        "model M\n  input Real u;\n  discrete Real a(start=0, fixed=true);\nequation\n"
        "  when sample(0, 0.1) then\n    a = pre(u);\n  end when;\nend M;\n"
    )
    with pytest.raises(Exception, match="external input"):
        compiled(tmp_path, text)


def test_a_derivative_of_an_element_of_a_part_fails_in_a_loop(tmp_path: Path) -> None:
    """`PartialRobot` and `OmniBase` write out their three wheels."""
    text = (
        "model Wheel\n  Real phi(start=0, fixed=true);\nend Wheel;\n"
        "model M\n  Wheel w[2];\nequation\n  for i in 1:2 loop\n    der(w[i].phi) = i;\n  end for;\nend M;\n"
    )
    with pytest.raises(Exception, match="exactly one resolved variable-reference"):
        compiled(tmp_path, text)
    written_out = text.replace("  for i in 1:2 loop\n    der(w[i].phi) = i;\n  end for;\n", "  der(w[1].phi) = 1;\n")
    result = compiled(tmp_path, written_out.replace("= 1;\n", "= 1;\n  der(w[2].phi) = 2;\n")).simulate(
        t=(0.0, 1.0), dt=0.5
    )
    assert result["w[2].phi"][-1] == pytest.approx(2.0)


FLANGES = (
    "connector Flange\n  Real phi;\n  flow Real tau;\nend Flange;\n"
    "model Pull\n  Flange axle;\nequation\n  axle.tau = -2;\nend Pull;\n"
    "model M\n  Base base;\n  Pull a;\n  Pull b;\nequation\n"
    "  connect(base.axle[1], a.axle);\n  connect(base.axle[2], b.axle);\nend M;\n"
    "model Base\n  Flange axle[2];\n  Real phi[2](each start=0, each fixed=true);\n"
    "  Real w[2](each start=0, each fixed=true);\nequation\n  for i in 1:2 loop\n"
    "    axle[i].phi = phi[i];\n    der(phi[i]) = w[i];\n    der(w[i]) = axle[i].tau;\n  end for;\nend Base;\n"
)


def test_a_flange_in_an_array_has_no_derivative_in_a_loop(tmp_path: Path) -> None:
    """`OmniBase` has axle0, axle1 and axle2. Tied to an angle of its own a flange in an array works."""
    assert compiled(tmp_path, FLANGES).simulate(t=(0.0, 1.0), dt=0.5)["base.phi[2]"][-1] == pytest.approx(1.0)
    with pytest.raises(Exception, match="exactly one resolved variable-reference"):
        compiled(tmp_path, FLANGES.replace("der(phi[i])", "der(axle[i].phi)"))


def test_an_input_at_the_top_cannot_be_simulated(tmp_path: Path) -> None:
    """All examples are closed."""
    text = "model M\n  input Real u(start=3);\n  Real x(start=0, fixed=true);\nequation\n  der(x) = u;\nend M;\n"
    model = compiled(tmp_path, text)
    with pytest.raises(Exception, match="neither a checked default nor a runtime value"):
        model.simulate(t=(0.0, 1.0), dt=0.5)


def test_external_c_does_not_run(tmp_path: Path) -> None:
    """The package has none."""
    text = (
        'function root\n  input Real u;\n  output Real y;\n  external "C" y = sqrt(u);\nend root;\n'
        "model M\n  Real x(start=0, fixed=true);\nequation\n  der(x) = root(4);\nend M;\n"
    )
    model = compiled(tmp_path, text)
    with pytest.raises(Exception, match="external C function"):
        model.simulate(t=(0.0, 1.0), dt=0.5)


def test_an_external_object_is_refused(tmp_path: Path) -> None:
    """The friction elements of Standard Library 4 look their torque up in such a table: `Motor` has its own friction.

    Their switch between sliding and sticking, rewritten with a plain number for the torque, does run.
    """
    text = (
        "class Table\n  extends ExternalObject;\n"
        "  function constructor\n    input Real values[:, 2];\n    output Table table;\n"
        '    external "C" table = make(values, size(values, 1));\n  end constructor;\n'
        '  function destructor\n    input Table table;\n    external "C" release(table);\n  end destructor;\n'
        "end Table;\n"
        "function friction\n  input Table table;\n  input Real w;\n  output Real tau;\n"
        '  external "C" tau = look_up(table, w);\nend friction;\n'
        "model M\n  parameter Table table=Table([0, 1; 1, 2]);\n  Real w(start=1, fixed=true);\n"
        "equation\n  der(w) = -friction(table, w);\nend M;\n"
    )
    with pytest.raises(Exception, match="unsupported type `Table`"):
        compiled(tmp_path, text)


def test_units_are_not_checked(tmp_path: Path) -> None:
    """`giveway_modelica.units` does."""
    text = 'model M\n  Real x(unit="m");\nequation\n  x = time;\nend M;\n'
    assert compiled(tmp_path, text).structure().is_balanced
