within GiveWay.Components;
model ServoRobot "Robot whose wheels follow wanted angles from inputs"
  extends Interfaces.PartialServoRobot;
  Interfaces.AngleInput phi_wanted[3] "Wanted angles"
    annotation (Placement(transformation(extent={{-110,10},{-90,30}})));
  Interfaces.AngularVelocityInput w_wanted[3] "Wanted speeds"
    annotation (Placement(transformation(extent={{-110,-30},{-90,-10}})));
equation
  phi_ref = phi_wanted;
  w_ref = w_wanted;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Polygon(points={{80,0},{-40,70},{-40,-70},{80,0}}, lineColor={0,70,140}, fillColor={200,220,240},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The robot of 4.2: joint position control alone, no estimator and no reaction.</p>
</html>"));
end ServoRobot;
