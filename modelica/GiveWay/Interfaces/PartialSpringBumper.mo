within GiveWay.Interfaces;
partial model PartialSpringBumper "Spring on a guide with a bottom stop"
  import Modelica.Units.SI;
  extends PartialGuidedBumper;
  parameter SI.TranslationalSpringConstant k=robot.bumper_spring_rate "Rate of the spring";
  parameter SI.Force f_pre=robot.bumper_preload "Preload of the spring at full extension";
  SI.Force f_spring "Spring, damping and friction of the guide";
equation
  f_spring = f_pre + k*c + d*u + f_guide*tanh(u/u_guide);
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The spring bumper of 3.5 of the paper, without the part that holds the plate at full extension:</p>
<p>f<sub>spring</sub> = F<sub>pre</sub> + k c + d c&#775; + F<sub>g</sub> tanh(c&#775;/v<sub>g</sub>)</p>
</html>"));
end PartialSpringBumper;
