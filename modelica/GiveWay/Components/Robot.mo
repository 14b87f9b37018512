within GiveWay.Components;
model Robot "Base with three drivetrains, motors driven from outside"
  extends Interfaces.PartialRobot;
  Interfaces.TorqueInput tau_ref[3] "Wanted motor torques"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
equation
  tau_m = tau_ref;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Polygon(points={{80,0},{-40,70},{-40,-70},{80,0}}, lineColor={0,70,140}, fillColor={200,220,240},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>With zero motor torque this is the unpowered robot of 5.1, held by the stiction of its gears.</p>
</html>"));
end Robot;
