within GiveWay.Sources;
block Standstill "Plan to stay at the origin"
  extends Interfaces.PartialPlan;
equation
  x = 0;
  y = 0;
  theta = 0;
  v_x = 0;
  v_y = 0;
  omega = 0;
  a_x = 0;
  a_y = 0;
  alpha = 0;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,0,127}, fillColor={255,255,255},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,40},{-30,50},{-10,30},{10,-30},{30,-50},{50,-40},{70,0}}, color={0,0,127}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Used in 5.1 and 5.2.</p>
</html>"));
end Standstill;
