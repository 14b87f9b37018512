within GiveWay.Components;
model TanhWheel "Omnidirectional wheel with the roller friction of the estimator"
  extends Omniwheel(redeclare model Roller = TanhRoller);
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Ellipse(extent={{-70,70},{70,-70}}, lineColor={64,64,64}, fillColor={224,224,224}, fillPattern=FillPattern.Solid),
      Ellipse(extent={{-12,12},{12,-12}}, lineColor={64,64,64}, fillColor={64,64,64}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>For comparisons with (28), and for tools that cannot solve the bristles.</p>
</html>"));
end TanhWheel;
