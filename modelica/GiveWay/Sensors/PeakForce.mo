within GiveWay.Sensors;
block PeakForce "Largest value of a force so far"
  import Modelica.Units.SI;
  input SI.Force f "Force";
  discrete SI.Force peak(start=0, fixed=true) "Largest value so far";
  parameter SI.Time period=0.0001 "Sample period";
equation
  when sample(0, period) then
    peak = max(pre(peak), f);
  end when;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Ellipse(extent={{-70,70},{70,-70}}, lineColor={64,64,64}, fillColor={255,255,255}, fillPattern=FillPattern.Solid),
      Line(points={{0,0},{40,40}}, color={0,0,0}, thickness=0.5),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The force is sampled. If it lasts some milliseconds, the default period misses less than 1 % of the peak.</p>
</html>"));
end PeakForce;
