within GiveWay.Components;
model LeverBumper "Spring behind a lever"
  import Modelica.Units.SI;
  extends Interfaces.PartialLawBumper(m_inner=m_lever);
  parameter SI.TranslationalSpringConstant k=robot.bumper_spring_rate "Rate of the spring itself";
  parameter SI.Force f_pre=robot.bumper_preload "Its preload at full extension";
  parameter Real ratio(unit="1")=1.5 "Travel of the spring over that of the plate";
  parameter SI.Mass m_lever=0 "Inertia of the lever and what moves with the spring, reduced to the plate";
equation
  f_rest = ratio*(f_pre + k*ratio*c);
  f_rate = 0;
  e_law = ratio*f_pre*c + k/2*(ratio*c)^2;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>f = i (F<sub>pre</sub> + k i c). A lever that turns by c/a, with the inertia J about its pivot and the arm a to the
plate, acts between plate and carriage as m<sub>l</sub>c&#776; with m<sub>l</sub> = J/a<sup>2</sup>. Its weight is part
of the carriage's.</p>
<p>The ratio does not change with the angle: exact for a spring that is parallel to the travel, on sliding or rolling
joints.</p>
</html>"));
end LeverBumper;
