within GiveWay.Sensors;
block FirstContact "Time of the first contact"
  import Modelica.Units.SI;
  input Boolean touching "Contact";
  constant SI.Time never=-1 "Time of an event that has not happened yet";
  discrete SI.Time t(start=-1, fixed=true) "Time of the first contact, -1 before";
equation
  when touching then
    t = if pre(t) < 0 then time else pre(t);
  end when;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Ellipse(extent={{-70,70},{70,-70}}, lineColor={64,64,64}, fillColor={255,255,255}, fillPattern=FillPattern.Solid),
      Line(points={{0,0},{40,40}}, color={0,0,0}, thickness=0.5),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The detection times of 5.2 and 5.3 start here.</p>
</html>"));
end FirstContact;
