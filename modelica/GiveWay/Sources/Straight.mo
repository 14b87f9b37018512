within GiveWay.Sources;
block Straight "Plan to move along a straight line"
  import Modelica.Units.SI;
  extends Interfaces.PartialTravel(speed=0.22);
  parameter SI.Angle direction=1.0471975511965976
    "Direction of motion, world frame: the side between wheels 0 and 1 ahead";
equation
  x = s*cos(direction);
  y = s*sin(direction);
  theta = 0;
  v_x = v*cos(direction);
  v_y = v*sin(direction);
  omega = 0;
  a_x = a*cos(direction);
  a_y = a*sin(direction);
  alpha = 0;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,0,127}, fillColor={255,255,255},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,40},{-30,50},{-10,30},{10,-30},{30,-50},{50,-40},{70,0}}, color={0,0,127}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Used in 5.3.</p>
</html>"));
end Straight;
