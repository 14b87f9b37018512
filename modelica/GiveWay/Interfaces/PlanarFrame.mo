within GiveWay.Interfaces;
connector PlanarFrame "Frame of a body that moves in the plane"
  import Modelica.Units.SI;
  SI.Position x "Position, world frame";
  SI.Position y "Position, world frame";
  SI.Angle theta "Heading, world frame";
  flow SI.Force f_x "Force into the component, world frame";
  flow SI.Force f_y "Force into the component, world frame";
  flow SI.Torque tau "Torque into the component about the frame's origin";
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,70,140}, fillColor={200,220,240},
        fillPattern=FillPattern.Solid),
      Line(points={{0,0},{70,0}}, color={0,70,140}), Line(points={{0,0},{0,70}}, color={0,70,140}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>World frame: x and y horizontal, z up; the heading is positive about z.</p>
</html>"));
end PlanarFrame;
