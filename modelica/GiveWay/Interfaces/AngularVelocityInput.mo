within GiveWay.Interfaces;
connector AngularVelocityInput = input Modelica.Units.SI.AngularVelocity "Angular velocity as an input signal"
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Polygon(points={{-90,90},{90,0},{-90,-90},{-90,90}}, lineColor={0,0,127}, fillColor={0,0,127},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Signal connector, an input.</p>
</html>"));
