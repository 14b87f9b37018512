within GiveWay.Components;
model Floor "Rigid floor under a soft cover"
  import Modelica.Units.SI;
  parameter SI.TranslationalSpringConstant k "Stiffness of the cover";
  parameter Real e(unit="s/m") "Damping of the cover (Hunt and Crossley)";
  parameter SI.Position s_0 "Position of its surface along the rail";
  Interfaces.LinearFlange nose "Body that lands on it"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
equation
  nose.f = if nose.s > s_0 then noEvent(max(0, k*(nose.s - s_0)*(1 + e*der(nose.s)))) else 0;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Ellipse(extent={{-90,40},{-10,-40}}, lineColor={64,64,64}, fillColor={224,224,224},
        fillPattern=FillPattern.Solid),
      Rectangle(extent={{-10,60},{70,-60}}, lineColor={0,70,140}, fillColor={200,220,240},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>N = max(0, k &delta; (1 + e &delta;&#775;)), where &delta; is the penetration beyond s<sub>0</sub>.</p>
</html>"));
end Floor;
