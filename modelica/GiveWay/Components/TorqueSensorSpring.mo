within GiveWay.Components;
model TorqueSensorSpring "Elastic torque sensor in series with gear and belt"
  import Modelica.Units.SI;
  parameter SI.RotationalSpringConstant k "Stiffness of gear, sensor and belt in series";
  parameter SI.RotationalDampingConstant d "Damping";
  Interfaces.RotaryFlange motor "Shaft towards the motor"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Interfaces.RotaryFlange wheel "Shaft towards the wheel"
    annotation (Placement(transformation(extent={{90,17},{110,37}})));
  Interfaces.TorqueOutput tau_s "Torque on the wheel, which the sensor reads"
    annotation (Placement(transformation(extent={{90,-37},{110,-17}})));
  SI.Angle wind_up "Twist: angle of the motor relative to the wheel";
equation
  wind_up = motor.phi - wheel.phi;
  tau_s = k*wind_up + d*der(wind_up);
  motor.tau = tau_s;
  wheel.tau = -tau_s;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Line(points={{-90,0},{-60,0},{-45,30},{-15,-30},{15,30},{45,-30},{60,0},{90,0}}, color={64,64,64}, thickness=0.5),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>&tau;<sub>s</sub> = k (&theta;<sub>m</sub> &minus; q<sub>w</sub>) + d (&theta;&#775;<sub>m</sub> &minus;
q&#775;<sub>w</sub>) = T: the sensor reads the torque on the wheel.</p>
</html>"));
end TorqueSensorSpring;
