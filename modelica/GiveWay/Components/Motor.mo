within GiveWay.Components;
model Motor "Motor behind a gear with stiction, reflected to the wheel axle"
  import Modelica.Units.SI;
  parameter SI.Inertia J "Inertia of the rotor, times the square of the gear ratio";
  parameter SI.Torque coulomb "Gear friction B1 while turning";
  parameter SI.Torque stiction "Gear friction B1 at rest, at least as large as while turning";
  parameter SI.RotationalDampingConstant viscous "Viscous gear friction";
  parameter SI.Torque limit "Largest torque of the motor";
  parameter SI.Angle phi_start=0 "Angle at the start";
  parameter SI.AngularVelocity w_start=0 "Speed at the start";
  Interfaces.TorqueInput tau_m "Wanted torque of the motor"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Interfaces.RotaryFlange flange "Shaft towards the torque sensor"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  SI.Angle phi(start=phi_start, fixed=true) "Angle that the encoder reads";
  SI.AngularVelocity w(start=w_start, fixed=true) "Speed";
  SI.Torque tau_net "Torque that the gear friction has to hold while the motor is stuck";
  Integer direction(start=if w_start > 0 then 1 else if w_start < 0 then -1 else 0, fixed=true)
    "Direction of sliding: -1 or +1; 0: stuck";
equation
  tau_net = max(-limit, min(limit, tau_m)) + flange.tau;
  flange.phi = phi;
  der(phi) = w;
  J*der(w) = if direction == 0 then 0 else tau_net - coulomb*direction - viscous*w;
  when pre(direction) == 0 and abs(tau_net) > stiction then
    direction = if tau_net > 0 then 1 else -1;
  elsewhen pre(direction) <> 0 and w*pre(direction) < 0 then
    direction = if tau_net > stiction then 1 else if tau_net < -stiction then -1 else 0;
    reinit(w, 0);
  end when;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-60,40},{40,-40}}, lineColor={64,64,64}, fillColor={192,192,192},
        fillPattern=FillPattern.HorizontalCylinder),
      Rectangle(extent={{40,10},{90,-10}}, lineColor={64,64,64}, fillColor={160,160,160},
        fillPattern=FillPattern.HorizontalCylinder),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The upstream half of Fig. 6. The gear friction B1 lies between motor and torque sensor: the sensor does not see this
friction, which holds the robot of 5.1 without creeping. Sliding and stuck are two modes with their own equations:</p>
<p>sliding: J &omega;&#775; = &tau;<sub>m</sub> &minus; &tau;<sub>s</sub> &minus; B1<sub>c</sub> sgn(&omega;) &minus; b
&omega;, &nbsp; stuck: &omega;&#775; = 0.</p>
<p>The motor breaks away when |&tau;<sub>m</sub> &minus; &tau;<sub>s</sub>| exceeds the stiction, and sticks when its
speed comes to zero while the stiction can hold it.</p>
<p>A gear that starts stuck must not start overloaded: breaking away is an event, and a torque that is too large from
the start on triggers no event.</p>
</html>"));
end Motor;
