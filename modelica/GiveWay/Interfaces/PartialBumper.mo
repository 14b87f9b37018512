within GiveWay.Interfaces;
partial model PartialBumper "Compression of a bumper between carriage and plate"
  import Modelica.Units.SI;
  parameter Parameters.Trikey robot "Parameters of the bumper";
  parameter SI.Mass m_reduced "Reduced mass of plate and carriage";
  input SI.Force f_lock "Compressing force that would hold plate and carriage together";
  SI.Position c "Compression, 0 at full extension";
  SI.Velocity u "Rate of compression";
  SI.Force f "Force that drives plate and carriage apart";
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Plate and carriage share one rail, so their relative motion has one degree of freedom, the compression c. With the
carriage's mass m<sub>c</sub>, the plate's m<sub>p</sub>, the force F<sub>d</sub> that drives the carriage and the
contact force N on the plate it is</p>
<p>&mu; c&#776; = F<sub>lock</sub> &minus; f, &nbsp; &mu; = m<sub>p</sub>m<sub>c</sub>/(m<sub>p</sub>+m<sub>c</sub>),
&nbsp; F<sub>lock</sub> = (m<sub>p</sub>F<sub>d</sub> + m<sub>c</sub>N)/(m<sub>p</sub>+m<sub>c</sub>).</p>
<p>A bumper defines f, or holds c; the model that contains it provides F<sub>lock</sub>.</p>
</html>"));
end PartialBumper;
