within GiveWay.Interfaces;
connector RotaryFlange "Shaft of a wheel, everything reflected to the wheel axle"
  import Modelica.Units.SI;
  SI.Angle phi "Angle of the shaft";
  flow SI.Torque tau "Torque into the component";
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Ellipse(extent={{-90,90},{90,-90}}, lineColor={64,64,64}, fillColor={128,128,128}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>A shaft at the wheel axle (Fig. 6 of the paper).</p>
</html>"));
end RotaryFlange;
