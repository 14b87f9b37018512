within GiveWay.Components;
model MagneticBumper "Spring bumper with a magnetic latch whose force follows the gap"
  import Modelica.Units.SI;
  extends Interfaces.PartialSpringBumper;
  parameter SI.Force f_latch=robot.bumper_latch_force "Force of the latch at full extension";
  parameter SI.Length g_0=robot.bumper_latch_gap "Gap at which a quarter of that force is left";
  SI.Force f_end "Force of the end stop";
  SI.Force f_magnet "Force of the magnet, in the direction of extension";
initial equation
  c = -(f_pre + f_latch)/(k + k_stop);
  u = 0;
equation
  f_end = if c < 0 then max(0, -k_stop*c*(1 - e_stop*u)) else 0;
  f_magnet = f_latch/(1 + noEvent(max(c, 0))/g_0)^2;
  f = f_spring + f_magnet - f_end + f_bottom;
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
<p>The magnetic spring bumper of 3.5 and Fig. 5. Over the gap c the latch pulls with F(c) = F<sub>L</sub>/(1 +
c/g<sub>0</sub>)<sup>2</sup>; near contact this is a negative stiffness 2F<sub>L</sub>/g<sub>0</sub>, far above the
spring's. So the latch releases in a snap, and catches the plate when it returns.</p>
</html>"));
end MagneticBumper;
