within GiveWay.Components;
model Omniwheel "Omnidirectional wheel that rolls on the floor (9)-(30)"
  import Modelica.Units.SI;
  parameter SI.Angle azimuth "Azimuth of the wheel in the base frame, phi_i";
  parameter SI.Distance R "Distance from the base's centre to the wheel";
  parameter SI.Radius r_w "Radius of the wheel";
  parameter SI.Radius r_r "Radius of a roller";
  parameter SI.Inertia I_w "Inertia about the axle";
  parameter SI.Inertia I_r "Inertia of the rollers that touch the floor";
  parameter Parameters.Trikey robot "The robot's parameters, for the rollers";
  parameter Real friction_scale(unit="1")=1 "Factor on the rollers' friction";
  parameter SI.Velocity v_n_start=0 "Speed along the axle at the start";
  Interfaces.PlanarFrame base "Centre of the base"
    annotation (Placement(transformation(extent={{-110,17},{-90,37}})));
  Interfaces.RotaryFlange axle "Axle of the wheel"
    annotation (Placement(transformation(extent={{-110,-37},{-90,-17}})));
  replaceable model Roller = BristleRoller constrainedby Interfaces.PartialRollerFriction "Friction of the rollers";
  Roller roller(robot=robot, coulomb=friction_scale*robot.roller_coulomb_torque, r_r=r_r, v_start=v_n_start,
    v=v_n) "Rollers"
    annotation (Placement(transformation(extent={{-20,-20},{20,20}})));
  SI.Angle direction "Azimuth of the axle, world frame";
  SI.Velocity v_t "Speed along the rolling direction, without the base's rotation";
  SI.Velocity v_n "Outward speed along the axle";
  SI.Angle q_w(start=0, fixed=true) "Angle of the wheel";
  SI.AngularVelocity w_w "Speed of the wheel";
  SI.AngularVelocity w_r "Speed of the roller on the floor";
  SI.Force f_t "Traction of the floor along the rolling direction";
  SI.Force f_n "Inward force of the floor along the axle";
equation
  direction = base.theta + azimuth;
  v_t = -sin(direction)*der(base.x) + cos(direction)*der(base.y);
  v_n = cos(direction)*der(base.x) + sin(direction)*der(base.y);
  r_w*w_w = v_t + R*der(base.theta);
  r_r*w_r = v_n;
  w_w = der(q_w);
  axle.phi = q_w;
  I_w*der(w_w) = axle.tau - r_w*f_t;
  I_r*der(w_r) = r_r*(f_n - roller.f);
  base.f_x = sin(direction)*f_t + cos(direction)*f_n;
  base.f_y = -cos(direction)*f_t + sin(direction)*f_n;
  base.tau = -R*f_t;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Ellipse(extent={{-70,70},{70,-70}}, lineColor={64,64,64}, fillColor={224,224,224}, fillPattern=FillPattern.Solid),
      Ellipse(extent={{-12,12},{12,-12}}, lineColor={64,64,64}, fillColor={64,64,64}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>One row of (15) and (16), with the radial direction n = (cos, sin)(&theta; + &phi;<sub>i</sub>) and the rolling
direction t = (&minus;sin, cos)(&theta; + &phi;<sub>i</sub>):</p>
<p>r<sub>w</sub> q&#775;<sub>w</sub> = t&middot;x&#775; + R &theta;&#775;, &nbsp; r<sub>r</sub> q&#775;<sub>r</sub> =
n&middot;x&#775;.</p>
<p>The floor's forces are the constraint forces &lambda; of (24): I<sub>w</sub>q&#776;<sub>w</sub> = T &minus;
r<sub>w</sub>F<sub>t</sub>, I<sub>r</sub>q&#776;<sub>r</sub> = r<sub>r</sub>(F<sub>n</sub> &minus; f). Nothing is
neglected: the derivatives of the Jacobians (29), (30) come from differentiating the constraints.</p>
</html>"));
end Omniwheel;
