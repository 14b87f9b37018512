within GiveWay.Interfaces;
partial block PartialTravel "Plan that travels along a path from rest"
  import Modelica.Units.SI;
  extends Interfaces.PartialPlan;
  parameter SI.Velocity speed "Speed along the path";
  parameter SI.Acceleration a_max=0.6 "Largest acceleration";
  constant Real pi(unit="rad")=3.141592653589793 "Half a turn";
  final parameter SI.Time ramp=pi*speed/(2*a_max) "Time until full speed";
  SI.Position s "Travel along the path";
  SI.Velocity v "Speed along the path";
  SI.Acceleration a "Acceleration along the path";
equation
  a = if t < ramp then a_max*sin(pi*t/ramp) else 0;
  v = if t < ramp then speed/2*(1 - cos(pi*t/ramp)) else speed;
  s = if t < ramp then speed/2*(t - ramp/pi*sin(pi*t/ramp)) else speed*(t - ramp/2);
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,0,127}, fillColor={255,255,255},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,40},{-30,50},{-10,30},{10,-30},{30,-50},{50,-40},{70,0}}, color={0,0,127}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>It starts from rest with half a sine wave of acceleration, then continues at constant speed.</p>
</html>"));
end PartialTravel;
