within GiveWay.Sources;
block TorqueSteps "Staircase of torque"
  import Modelica.Units.SI;
  parameter SI.Time t[3]={0.05, 0.25, 0.5} "Times of the steps";
  parameter SI.Torque steps[4]={2, 5, -4, 0} "Torque before, between and after";
  Interfaces.TorqueOutput tau "Torque"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
equation
  tau = if time < t[1] then steps[1] else if time < t[2] then steps[2] else if time < t[3] then steps[3] else steps[4];
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,0,127}, fillColor={255,255,255},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,40},{-30,50},{-10,30},{10,-30},{30,-50},{50,-40},{70,0}}, color={0,0,127}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Four constant torques.</p>
</html>"));
end TorqueSteps;
