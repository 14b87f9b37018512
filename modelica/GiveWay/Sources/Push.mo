within GiveWay.Sources;
model Push "Constant force on a point of the base for a limited time"
  import Modelica.Units.SI;
  parameter SI.Force f_x=0 "Force, world frame";
  parameter SI.Force f_y=0 "Force, world frame";
  parameter SI.Position p_x=0 "Point of action, base frame";
  parameter SI.Position p_y=0 "Point of action, base frame";
  parameter SI.Time t_on=0 "Start time";
  parameter SI.Time t_off=1e9 "End time";
  Interfaces.PlanarFrame frame "Centre of the base"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Real on(unit="1") "1 while the force acts";
  SI.Position r_x "Point, world axes";
  SI.Position r_y "Point, world axes";
equation
  on = if time >= t_on and time < t_off then 1 else 0;
  r_x = cos(frame.theta)*p_x - sin(frame.theta)*p_y;
  r_y = sin(frame.theta)*p_x + cos(frame.theta)*p_y;
  frame.f_x = -on*f_x;
  frame.f_y = -on*f_y;
  frame.tau = -on*(r_x*f_y - r_y*f_x);
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,0,127}, fillColor={255,255,255},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,40},{-30,50},{-10,30},{10,-30},{30,-50},{50,-40},{70,0}}, color={0,0,127}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>A push by hand, as in 5.1 and 5.4; its force keeps its direction in the world.</p>
</html>"));
end Push;
