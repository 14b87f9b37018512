within GiveWay.Sensors;
model PlanarPosition "Distance of a body from its start position"
  import Modelica.Units.SI;
  Interfaces.PlanarFrame frame "The body"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  SI.Distance distance "Distance from the start position";
  parameter SI.Position x_start=0 "Start position, world frame";
  parameter SI.Position y_start=0 "Start position, world frame";
equation
  frame.f_x = 0;
  frame.f_y = 0;
  frame.tau = 0;
  distance = sqrt((frame.x - x_start)^2 + (frame.y - y_start)^2);
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Ellipse(extent={{-70,70},{70,-70}}, lineColor={64,64,64}, fillColor={255,255,255}, fillPattern=FillPattern.Solid),
      Line(points={{0,0},{40,40}}, color={0,0,0}, thickness=0.5),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The last value of <code>distance</code> is the escape distance of 5.2.</p>
</html>"));
end PlanarPosition;
