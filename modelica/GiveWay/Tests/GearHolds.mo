within GiveWay.Tests;
model GearHolds "A stuck gear holds a static load without creeping"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "The robot's parameters";
  Components.Drivetrain drivetrain(robot=robot) "Drivetrain"
    annotation (Placement(transformation(extent={{-80,-20},{-40,20}})));
  Components.Load load(J=0.15, viscous=0.3) "Load"
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
  parameter SI.Torque tau_ext=1.17 "Load of the push";
  SI.Angle residual "Motion of the motor";
equation
  connect(drivetrain.wheel, load.axle)
    annotation (Line(points={{-40,8},{40,5}}, color={0,70,140}));
  drivetrain.tau_m = 0;
  load.tau_ext = tau_ext;
  residual = drivetrain.phi_m;
  assert(abs(residual) < 1e-9, "the gear creeps");
  annotation (
    experiment(StopTime=1, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>1.17 N m is the largest torque that 10 N can cause at a wheel in 5.1.</p>
</html>"));
end GearHolds;
