within GiveWay.Components;
model DamperBumper "Damper with a weak return spring"
  import Modelica.Units.SI;
  extends Interfaces.PartialLawBumper;
  parameter SI.TranslationalSpringConstant k=robot.bumper_spring_rate "Rate of the return spring";
  parameter SI.Force f_pre=robot.bumper_preload "Its preload at full extension";
  parameter SI.TranslationalDampingConstant d_1=100 "Force per speed while compressing";
  parameter Real d_2(unit="N.s2/m2")=0 "Force per squared speed while compressing (an orifice)";
  parameter Real rebound(unit="1")=1 "The same while extending over that while compressing";
equation
  f_rest = f_pre + k*c;
  f_rate = noEvent(if u < 0 then rebound else 1)*(d_1 + d_2*noEvent(abs(u)))*u;
  e_law = f_pre*c + k/2*c^2;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>f = F<sub>pre</sub> + k c + r (d<sub>1</sub> + d<sub>2</sub>|c&#775;|) c&#775;, with r = 1 while compressing:
oil through a gap, and through an orifice.</p>
</html>"));
end DamperBumper;
