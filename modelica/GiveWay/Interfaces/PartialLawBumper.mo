within GiveWay.Interfaces;
partial model PartialLawBumper "Bumper with an end stop whose force is a law of compression and rate"
  import Modelica.Units.SI;
  extends PartialGuidedBumper;
  parameter SI.Mass m_inner=0 "Inertia of what moves between plate and carriage, reduced to the compression";
  SI.Force f_rest "Force of the law at rest";
  SI.Force f_rate "What the rate adds to it";
  SI.Energy e_law "Energy that the law stores, 0 at full extension";
  SI.Force f_damping "Damping and friction of the guide";
  SI.Force f_end "Force of the end stop";
  SI.Force f_slow "Force without that of the inertia between";
  SI.Energy e_stored "Energy stored in law, stops and the inertia between";
  SI.Power p_loss "Power lost in law, damping, guide and stops";
initial equation
  f_rest = -k_stop*c;
  u = 0;
equation
  f_damping = d*u + f_guide*tanh(u/u_guide);
  f_end = if c < 0 then max(0, -k_stop*c*(1 - e_stop*u)) else 0;
  f_slow = f_rest + f_rate + f_damping - f_end + f_bottom;
  f = f_slow + m_inner*der(u);
  der(c) = u;
  (m_reduced + m_inner)*der(u) = f_lock - f_slow;
  e_stored = e_law + k_stop/2*(noEvent(min(c, 0))^2 + noEvent(max(c - travel, 0))^2) + m_inner/2*u^2;
  p_loss = (f_rate + f_damping)*u - (f_end + k_stop*noEvent(min(c, 0)))*u
    + (f_bottom - k_stop*noEvent(max(c - travel, 0)))*u;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>A law defines f<sub>rest</sub>(c), the energy e<sub>law</sub> with e<sub>law</sub>(0) = 0 and
de<sub>law</sub>/dc = f<sub>rest</sub>, and f<sub>rate</sub>(c, c&#775;) with f<sub>rate</sub>c&#775; &ge; 0: over a
closed cycle it never gives more than it took. Every law has the same guide and stops:</p>
<p>f = f<sub>rest</sub> + f<sub>rate</sub> + d c&#775; + F<sub>g</sub> tanh(c&#775;/v<sub>g</sub>) &minus;
f<sub>end</sub> + f<sub>bottom</sub> + m<sub>i</sub>c&#776;, &nbsp; f<sub>end</sub> = max(0, &minus;k<sub>e</sub> c (1
&minus; e c&#775;)) for c &lt; 0.</p>
<p>The plate starts where the end stop carries the law's force. The power f c&#775; that the bumper takes in is
de<sub>stored</sub>/dt + p<sub>loss</sub>.</p>
</html>"));
end PartialLawBumper;
