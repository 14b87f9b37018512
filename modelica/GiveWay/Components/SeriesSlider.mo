within GiveWay.Components;
model SeriesSlider "Slider with two springs in series"
  extends Slider(redeclare model Bumper = SeriesBumper);
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-70,40},{60,-10}}, lineColor={64,64,64}, fillColor={192,192,192},
        fillPattern=FillPattern.Solid),
      Line(points={{-95,-20},{95,-20}}, color={0,0,0}, thickness=0.5),
      Ellipse(extent={{60,35},{90,-5}}, lineColor={140,60,0}, fillColor={240,190,140}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p><code>Slider</code> with <code>SeriesBumper</code> in place of the magnetic bumper.</p>
</html>"));
end SeriesSlider;
