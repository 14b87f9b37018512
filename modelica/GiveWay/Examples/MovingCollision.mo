within GiveWay.Examples;
model MovingCollision "The robot runs into the resting dummy (5.3)"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  constant SI.Angle side=1.0471975511965976 "Direction of motion: the side between wheels 0 and 1 ahead";
  parameter SI.Time steady=0.3 "Time at full speed before the contact";
  parameter SI.Velocity speed=0.22 "Speed of the plan";
  parameter SI.Time ramp=0.5759586531581288 "Time the plan takes to reach full speed";
  parameter SI.Length travel=speed*(ramp/2 + steady) "Travel of the robot until the contact";
  parameter SI.Position x_side=0.088046 "Middle of the robot's side at the start";
  parameter SI.Position y_side=0.1525 "Middle of the robot's side at the start";
  Components.ControlledRobot robot(redeclare model Plan = Sources.Straight) "Robot"
    annotation (Placement(transformation(extent={{-80,40},{-40,80}})));
  Components.Dummy dummy(m=13.62, roped=false, run_up=0, x_target=x_side + travel*cos(side), y_target=y_side
    + travel*sin(side)) "Dummy at rest, without the rope"
    annotation (Placement(transformation(extent={{40,40},{80,80}})));
  Sensors.FirstContact first(touching=dummy.contact.touching) "First contact"
    annotation (Placement(transformation(extent={{-80,-80},{-40,-40}})));
  SI.Time detection_time "From the first contact to the controller's decision, -1 before";
equation
  connect(robot.frame, dummy.frame)
    annotation (Line(points={{-40,52},{80,60}}, color={0,70,140}));
  detection_time = if robot.controller.hits > 0 then robot.controller.hit_tick*robot.controller.period - first.t
    else first.never;
  annotation (
    experiment(StopTime=1.3, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>5.3: the robot moves at 0.22 m/s with the side between wheels 0 and 1 ahead, and meets 13.62 kg at rest. The paper
notices the hit after 105 ms.</p>
</html>"));
end MovingCollision;
