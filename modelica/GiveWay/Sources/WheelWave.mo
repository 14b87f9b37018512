within GiveWay.Sources;
block WheelWave "Wave of a wheel's angle, as in 4.2"
  import Modelica.Units.SI;
  parameter SI.Angle amplitude=1.5 "Amplitude";
  parameter SI.Frequency f=0.1 "Frequency";
  constant SI.Angle turn=6.283185307179586 "A turn";
  Interfaces.AngleOutput phi "Wanted angle"
    annotation (Placement(transformation(extent={{90,17},{110,37}})));
  Interfaces.AngularVelocityOutput w "Wanted speed"
    annotation (Placement(transformation(extent={{90,-37},{110,-17}})));
equation
  phi = amplitude*(1 - cos(turn*f*time));
  w = amplitude*turn*f*sin(turn*f*time);
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,0,127}, fillColor={255,255,255},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,40},{-30,50},{-10,30},{10,-30},{30,-50},{50,-40},{70,0}}, color={0,0,127}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>q(t) = 3/2 &minus; 3/2 cos(2&pi;&omega;t) (4.2).</p>
</html>"));
end WheelWave;
