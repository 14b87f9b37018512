within GiveWay.Interfaces;
partial block PartialPlan "Planned motion of the base over path time"
  import Modelica.Units.SI;
  input SI.Time t "Path time";
  SI.Position x "Planned position, world frame";
  SI.Position y "Planned position, world frame";
  SI.Angle theta "Planned heading";
  SI.Velocity v_x "Planned velocity, world frame";
  SI.Velocity v_y "Planned velocity, world frame";
  SI.AngularVelocity omega "Planned yaw rate";
  SI.Acceleration a_x "Planned acceleration, world frame";
  SI.Acceleration a_y "Planned acceleration, world frame";
  SI.AngularAcceleration alpha "Planned yaw acceleration";
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,0,127}, fillColor={255,255,255},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,40},{-30,50},{-10,30},{10,-30},{30,-50},{50,-40},{70,0}}, color={0,0,127}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Pose, twist and acceleration of the plan at the path time, which stands still while the robot escapes.</p>
</html>"));
end PartialPlan;
