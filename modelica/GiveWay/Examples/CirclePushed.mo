within GiveWay.Examples;
model CirclePushed "The robot drives along a circle and is pushed twice (5.4)"
  extends Modelica.Icons.Example;
  Components.ControlledRobot robot(redeclare model Plan = Sources.Circle) "Robot"
    annotation (Placement(transformation(extent={{-80,40},{-40,80}})));
  Sources.Push first(f_x=-20, f_y=-34, p_x=0.088046, p_y=0.1525, t_on=0.8, t_off=1) "Push at one side"
    annotation (Placement(transformation(extent={{40,40},{80,80}})));
  Sources.Push second(f_x=30, p_x=-0.176092, t_on=1.4, t_off=1.6) "Push at the side opposite wheel 0"
    annotation (Placement(transformation(extent={{-80,-80},{-40,-40}})));
  Sensors.PlanarPosition position "Position of the robot"
    annotation (Placement(transformation(extent={{40,-80},{80,-40}})));
equation
  connect(first.frame, robot.frame)
    annotation (Line(points={{80,60},{-40,52}}, color={0,70,140}));
  connect(second.frame, robot.frame)
    annotation (Line(points={{-40,-60},{-40,52}}, color={0,70,140}));
  connect(position.frame, robot.frame)
    annotation (Line(points={{80,-60},{-40,52}}, color={0,70,140}));
  annotation (
    experiment(StopTime=1.8, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>5.4 and Fig. 12: each push is noticed, and the robot escapes in its direction. After the first push the plan's clock
stands still.</p>
</html>"));
end CirclePushed;
