within GiveWay.Components;
model DiscContact "Cover contact of a disc on a rail with the base's outline"
  import Modelica.Units.SI;
  parameter Parameters.Trikey robot "Parameters of cover and outline";
  parameter SI.TranslationalSpringConstant k=robot.contact_stiffness "Stiffness of the cover";
  parameter Real e(unit="s/m")=robot.contact_damping "Damping of the cover (Hunt and Crossley)";
  parameter Real mu(unit="1")=0 "Tangential friction";
  parameter SI.Velocity v_mu=0.005 "Slip speed over which the tangential friction changes sign";
  parameter SI.Radius r_n=0.02 "Radius of the nose";
  parameter SI.Angle psi "Direction of the rail, world frame";
  parameter SI.Position x_target "Position of the nose's tip after the run-up, world frame";
  parameter SI.Position y_target "Position of the nose's tip after the run-up, world frame";
  parameter SI.Length run_up "Travel of the nose until its tip is at the target";
  parameter SI.Position outline_x[:]=robot.outline_x "Corners of the outline, base frame, counter-clockwise";
  parameter SI.Position outline_y[:]=robot.outline_y "Corners of the outline, base frame, counter-clockwise";
  Interfaces.PlanarFrame base "Centre of the base"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Interfaces.LinearFlange nose "Nose of the slider"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  SI.Velocity v_x "Velocity of the base in its axes";
  SI.Velocity v_y "Velocity of the base in its axes";
  SI.AngularVelocity omega "Yaw rate of the base";
  SI.Position q_x "Centre of the nose, base axes, from the base's centre";
  SI.Position q_y "Centre of the nose, base axes, from the base's centre";
  Real t_x(unit="1") "Direction of the rail, base axes";
  Real t_y(unit="1") "Direction of the rail, base axes";
  SI.Position distance "Distance of the nose's centre from the outline";
  Real n_x(unit="1") "Outward normal at the closest point, base axes";
  Real n_y(unit="1") "Outward normal at the closest point, base axes";
  SI.Position p_x "Closest point, base axes";
  SI.Position p_y "Closest point, base axes";
  SI.Position depth "Penetration of the nose into the outline";
  SI.Velocity w_x "Velocity of the robot's contact point relative to the nose, base axes";
  SI.Velocity w_y "Velocity of the robot's contact point relative to the nose, base axes";
  SI.Velocity rate "Approach speed of robot and nose";
  SI.Velocity slip "Slip speed of the robot along the nose";
  Boolean touching "The nose touches the robot";
  SI.Force f_normal "Normal force";
  SI.Force f_friction "Tangential friction on the robot, against the slip";
  SI.Force f_x "Force on the robot, world frame";
  SI.Force f_y "Force on the robot, world frame";
  SI.Torque tau "Moment on the robot about its centre";
equation
  v_x = cos(base.theta)*der(base.x) + sin(base.theta)*der(base.y);
  v_y = -sin(base.theta)*der(base.x) + cos(base.theta)*der(base.y);
  omega = der(base.theta);
  t_x = cos(psi - base.theta);
  t_y = sin(psi - base.theta);
  q_x = cos(base.theta)*(x_target - base.x) + sin(base.theta)*(y_target - base.y) + (nose.s - run_up - r_n)*t_x;
  q_y = -sin(base.theta)*(x_target - base.x) + cos(base.theta)*(y_target - base.y) + (nose.s - run_up - r_n)*t_y;
  (distance, n_x, n_y) = Functions.closestPoint(q_x, q_y, outline_x, outline_y);
  p_x = q_x - distance*n_x;
  p_y = q_y - distance*n_y;
  depth = r_n - distance;
  w_x = v_x - omega*p_y - der(nose.s)*t_x;
  w_y = v_y + omega*p_x - der(nose.s)*t_y;
  rate = w_x*n_x + w_y*n_y;
  slip = -w_x*n_y + w_y*n_x;
  touching = depth > 0;
  f_normal = if touching then noEvent(max(0, k*depth*(1 + e*rate))) else 0;
  f_friction = mu*f_normal*tanh(slip/v_mu);
  f_x = -cos(base.theta)*(f_normal*n_x - f_friction*n_y) + sin(base.theta)*(f_normal*n_y + f_friction*n_x);
  f_y = -sin(base.theta)*(f_normal*n_x - f_friction*n_y) - cos(base.theta)*(f_normal*n_y + f_friction*n_x);
  tau = -p_x*(f_normal*n_y + f_friction*n_x) + p_y*(f_normal*n_x - f_friction*n_y);
  base.f_x = -f_x;
  base.f_y = -f_y;
  base.tau = -tau;
  nose.f = cos(psi)*f_x + sin(psi)*f_y;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Ellipse(extent={{-90,40},{-10,-40}}, lineColor={64,64,64}, fillColor={224,224,224},
        fillPattern=FillPattern.Solid),
      Rectangle(extent={{-10,60},{70,-60}}, lineColor={0,70,140}, fillColor={200,220,240},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The dummy's nose is a disc that travels along a straight rail; the robot's outline is a convex polygon. Between them,
with the depth &delta; of the disc in the outline,</p>
<p>N = max(0, k &delta; (1 + e &delta;&#775;)) while &delta; &gt; 0 (Hunt and Crossley 1975, exponent 1), &nbsp; F =
&minus;N n &minus; &mu; N tanh(v<sub>t</sub>/v<sub>&mu;</sub>) t.</p>
<p>F is the force of the dummy <em>on</em> the robot, here and in the controller, as in (38)-(44) of the paper. In (31),
(36) and (37) it is the force <em>of</em> the robot.</p>
</html>"));
end DiscContact;
