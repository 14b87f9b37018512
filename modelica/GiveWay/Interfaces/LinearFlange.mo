within GiveWay.Interfaces;
connector LinearFlange "Point on a straight rail"
  import Modelica.Units.SI;
  SI.Position s "Travel along the rail";
  flow SI.Force f "Force into the component, along the rail";
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,90,0}, fillColor={0,140,0}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>A point that moves along a straight rail; travel and force have the same direction.</p>
</html>"));
end LinearFlange;
