within GiveWay.Examples;
model LatchRelease "An ideal latch lets go in a collision and takes hold again"
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey data "Parameters of robot and dummy";
  Components.Robot robot(data=data) "Unpowered robot"
    annotation (Placement(transformation(extent={{-80,-20},{-40,20}})));
  Components.LatchedDummy dummy(robot=data) "Dummy with an ideal latch"
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
equation
  connect(robot.frame, dummy.frame)
    annotation (Line(points={{-40,-8},{80,0}}, color={0,70,140}));
  robot.tau_ref = zeros(3);
  annotation (
    experiment(StopTime=0.8, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>The dummy hits the unpowered robot; the latch releases at F<sub>L</sub> and the bumper is compressed. When the
rebounding plate is back at full extension the latch catches it in a plastic impact:
<code>dummy.slider.bumper.t_release</code>, <code>t_latch</code>.</p>
</html>"));
end LatchRelease;
