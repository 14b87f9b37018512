within GiveWay.Components;
model LatchedBumper "Spring bumper with an ideal latch: latched or released"
  import Modelica.Units.SI;
  extends Interfaces.PartialSpringBumper;
  parameter SI.Force f_latch=robot.bumper_latch_force "Release force of the latch, in addition to the preload";
  Boolean latched(start=true, fixed=true) "The plate is held at full extension";
  discrete SI.Time t_release(start=-1, fixed=true) "Time of the last release, -1 before the first";
  discrete SI.Time t_latch(start=-1, fixed=true) "Time of the last latching, -1 before the first";
initial equation
  c = 0;
  u = 0;
equation
  f = if latched then f_lock else f_spring + f_bottom;
  der(c) = u;
  m_reduced*der(u) = if latched then 0 else f_lock - f;
  when pre(latched) and f_lock > f_latch + f_pre then
    latched = false;
    t_release = time;
    t_latch = pre(t_latch);
  elsewhen not pre(latched) and c < 0 then
    latched = true;
    t_release = pre(t_release);
    t_latch = time;
    reinit(c, 0);
    reinit(u, 0);
  end when;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The latch as two modes. Latched, plate and carriage are one body, and the inner force is F<sub>lock</sub>. It lets go
when that exceeds F<sub>L</sub> + F<sub>pre</sub>, and takes hold again when the plate comes back to full extension: a
plastic impact, in which the common momentum is kept and &mu;c&#775;<sup>2</sup>/2 is lost.</p>
<p>The coordinates are c&#775; and the velocity of the common centre of mass (<code>Components.Slider</code>), so the
impact is just c&#775; := 0.</p>
</html>"));
end LatchedBumper;
