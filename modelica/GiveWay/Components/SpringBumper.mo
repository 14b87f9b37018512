within GiveWay.Components;
model SpringBumper "Spring bumper with an end stop"
  import Modelica.Units.SI;
  extends Interfaces.PartialSpringBumper;
  SI.Force f_end "Force of the end stop";
initial equation
  c = -f_pre/(k + k_stop);
  u = 0;
equation
  f_end = if c < 0 then max(0, -k_stop*c*(1 - e_stop*u)) else 0;
  f = f_spring - f_end + f_bottom;
  der(c) = u;
  m_reduced*der(u) = f_lock - f;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The spring bumper of 3.5. At full extension a stop carries the preload: f<sub>end</sub> = max(0, &minus;k<sub>e</sub>
c (1 &minus; e c&#775;)) for c &lt; 0.</p>
</html>"));
end SpringBumper;
