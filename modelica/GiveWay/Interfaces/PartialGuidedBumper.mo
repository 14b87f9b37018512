within GiveWay.Interfaces;
partial model PartialGuidedBumper "Guide and bottom stop that all bumpers with a plate share"
  import Modelica.Units.SI;
  extends PartialBumper;
  parameter SI.TranslationalDampingConstant d=robot.bumper_damping "Damping";
  parameter SI.Force f_guide=robot.bumper_guide_friction "Coulomb friction of the guide";
  parameter SI.Velocity u_guide=0.005 "Speed over which the guide's friction changes sign";
  parameter SI.Length travel=robot.bumper_travel "Compression at which it bottoms";
  parameter SI.TranslationalSpringConstant k_stop=2e5 "Stiffness of the stops";
  parameter Real e_stop(unit="s/m")=1 "Damping of the stops (Hunt and Crossley)";
  SI.Force f_bottom "Force of the bottom stop";
equation
  f_bottom = if c > travel then max(0, k_stop*(c - travel)*(1 + e_stop*u)) else 0;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>What does not depend on what extends the plate; beyond the travel</p>
<p>f<sub>bottom</sub> = max(0, k<sub>t</sub>(c &minus; c<sub>max</sub>)(1 + e c&#775;)), else 0.</p>
</html>"));
end PartialGuidedBumper;
