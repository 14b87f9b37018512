within GiveWay.Components;
model Gravity "Constant pull on a slider on a vertical rail"
  import Modelica.Units.SI;
  parameter SI.Mass m "Mass";
  constant SI.Acceleration g=9.81 "Gravitational acceleration";
  Interfaces.LinearFlange flange "Body that is pulled"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
equation
  flange.f = -m*g;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Line(points={{-90,60},{40,60},{40,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{10,0},{70,-70}}, lineColor={64,64,64}, fillColor={160,160,160}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>f = m g.</p>
</html>"));
end Gravity;
