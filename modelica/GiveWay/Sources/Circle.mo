within GiveWay.Sources;
block Circle "Plan to move along a circle with a constant heading"
  import Modelica.Units.SI;
  extends Interfaces.PartialTravel(speed=0.16);
  parameter SI.Radius radius=0.75 "Radius";
  SI.Angle phase "Angle along the circle";
equation
  phase = s/radius;
  x = radius*sin(phase);
  y = radius*(1 - cos(phase));
  theta = 0;
  v_x = v*cos(phase);
  v_y = v*sin(phase);
  omega = 0;
  a_x = a*cos(phase) - v^2/radius*sin(phase);
  a_y = a*sin(phase) + v^2/radius*cos(phase);
  alpha = 0;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,0,127}, fillColor={255,255,255},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,40},{-30,50},{-10,30},{10,-30},{30,-50},{50,-40},{70,0}}, color={0,0,127}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The circle of 5.4: 1.5 m in diameter at 0.16 m/s, from the origin along x.</p>
</html>"));
end Circle;
