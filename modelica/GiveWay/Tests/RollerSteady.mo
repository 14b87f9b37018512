within GiveWay.Tests;
model RollerSteady "In steady motion the bristle's friction is (28)"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "The robot's parameters";
  parameter SI.Velocity v=0.05 "Speed";
  Components.BristleRoller bristle(robot=robot, v_start=0.05, v=v) "Bristle"
    annotation (Placement(transformation(extent={{-80,-20},{-40,20}})));
  Components.TanhRoller steady(robot=robot, v=v) "(28)"
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
  SI.Force residual "Difference";
equation
  residual = bristle.f - steady.f;
  assert(abs(residual) < 1e-5, "the bristle does not settle on (28)");
  annotation (
    experiment(StopTime=0.2, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>The bristle starts at the deflection of that motion and stays there.</p>
</html>"));
end RollerSteady;
