within GiveWay.Examples;
model DrivetrainStep "Steps of motor torque on a drivetrain with its wheel"
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "The robot's parameters";
  Components.Drivetrain drivetrain(robot=robot) "Drivetrain"
    annotation (Placement(transformation(extent={{-80,40},{-40,80}})));
  Components.Load load(J=0.15, coulomb=robot.roller_coulomb_torque, slope=robot.roller_tanh_slope, viscous=0.02)
    "A third of the base, reflected to the wheel"
    annotation (Placement(transformation(extent={{40,40},{80,80}})));
  Sources.TorqueSteps steps "Wanted torque"
    annotation (Placement(transformation(extent={{-80,-80},{-40,-40}})));
equation
  connect(drivetrain.wheel, load.axle)
    annotation (Line(points={{-40,68},{40,65}}, color={0,70,140}));
  connect(steps.tau, drivetrain.tau_m)
    annotation (Line(points={{-40,-60},{-80,60}}, color={0,70,140}));
  load.tau_ext = 0;
  annotation (
    experiment(StopTime=0.8, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>The first torque is below the stiction and moves nothing; the second breaks the gear away; the third reverses it
through standstill; with the last the gear comes to rest and holds while the load oscillates on the sensor's spring.</p>
</html>"));
end DrivetrainStep;
