within GiveWay.Components;
model Testbed "Robot with its controller, and the dummy that hits it"
  replaceable ControlledRobot robot constrainedby Interfaces.PartialRobot "Robot"
    annotation (Placement(transformation(extent={{-80,-20},{-40,20}})));
  replaceable Dummy dummy constrainedby Dummy "Collision dummy"
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
equation
  connect(robot.frame, dummy.frame)
    annotation (Line(points={{-40,-8},{80,0}}, color={0,70,140}));
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Polygon(points={{80,0},{-40,70},{-40,-70},{80,0}}, lineColor={0,70,140}, fillColor={200,220,240},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The scene of 3.4 and 5.2. Redeclare <code>dummy</code> for another bumper, <code>robot</code> for another plan or an
unpowered robot.</p>
</html>"));
end Testbed;
