within GiveWay.Examples;
model CircleRound "A full circle with a push, the escape and the return (5.4, Fig. 12)"
  extends Modelica.Icons.Example;
  Components.ControlledRobot robot(redeclare model Plan = Sources.Circle, counts=1000000, resolution=1e-9,
    controller(plan_acceleration=0.097)) "Robot"
    annotation (Placement(transformation(extent={{-80,40},{-40,80}})));
  Sources.Push push(f_x=-20, f_y=-34, p_x=0.088046, p_y=0.1525, t_on=8, t_off=8.2) "Push at one side"
    annotation (Placement(transformation(extent={{40,40},{80,80}})));
  Sensors.PlanarPosition position "Position of the robot"
    annotation (Placement(transformation(extent={{40,-80},{80,-40}})));
equation
  connect(push.frame, robot.frame)
    annotation (Line(points={{80,60},{-40,52}}, color={0,70,140}));
  connect(position.frame, robot.frame)
    annotation (Line(points={{80,-60},{-40,52}}, color={0,70,140}));
  annotation (
    experiment(StopTime=44, Tolerance=1e-9, Interval=0.01),
    Documentation(info="<html>
<p>5.4 and Fig. 12: 1.5 m in diameter at 0.16 m/s. The push is noticed after 67 ms; the robot escapes by 0.5 m, comes to
rest, returns to the point where it left the circle, and completes the round. The plan's clock stands still from the
push until the robot is back, 14 s later.</p>
<p>The return accelerates by only 0.097 m/s<sup>2</sup>: the paper's estimator knows the planned acceleration, not the
real one, and would mistake a jolt for a push.</p>
<p>The encoders are finer than the robot's and the solver tolerance is small. Otherwise a count that comes one sample
later in another tool would kick a motor by 2 N m, and results over 44 s could not be compared.</p>
</html>"));
end CircleRound;
