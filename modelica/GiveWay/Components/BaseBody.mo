within GiveWay.Components;
model BaseBody "Rigid body that moves in the plane"
  import Modelica.Units.SI;
  parameter SI.Mass m "Mass, wheels included";
  parameter SI.Inertia I "Yaw inertia about the centre of mass, wheels included";
  parameter SI.Position c_x=0 "Centre of mass, base axes";
  parameter SI.Position c_y=0 "Centre of mass, base axes";
  parameter SI.Angle slope=0 "Inclination of the floor";
  parameter SI.Angle downhill=0 "Direction in which the floor falls, world frame";
  constant SI.Acceleration g_n=9.81 "Gravity";
  parameter SI.Position x_start=0 "Position at the start, world frame";
  parameter SI.Position y_start=0 "Position at the start, world frame";
  parameter SI.Angle theta_start=0 "Heading at the start";
  parameter SI.Velocity v_x_start=0 "Velocity at the start, world frame";
  parameter SI.Velocity v_y_start=0 "Velocity at the start, world frame";
  parameter SI.AngularVelocity omega_start=0 "Yaw rate at the start";
  Interfaces.PlanarFrame frame "Centre of the body"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  SI.Position x(start=x_start, fixed=true) "Position, world frame";
  SI.Position y(start=y_start, fixed=true) "Position, world frame";
  SI.Angle theta(start=theta_start, fixed=true) "Heading";
  SI.Velocity v_x(start=v_x_start, fixed=true) "Velocity, world frame";
  SI.Velocity v_y(start=v_y_start, fixed=true) "Velocity, world frame";
  SI.AngularVelocity omega(start=omega_start, fixed=true) "Yaw rate";
  SI.Position r_x "From the frame to the centre of mass, world axes";
  SI.Position r_y "From the frame to the centre of mass, world axes";
equation
  frame.x = x;
  frame.y = y;
  frame.theta = theta;
  der(x) = v_x;
  der(y) = v_y;
  der(theta) = omega;
  r_x = cos(theta)*c_x - sin(theta)*c_y;
  r_y = sin(theta)*c_x + cos(theta)*c_y;
  m*(der(v_x) - der(omega)*r_y - omega^2*r_x) = frame.f_x + m*g_n*sin(slope)*cos(downhill);
  m*(der(v_y) + der(omega)*r_x - omega^2*r_y) = frame.f_y + m*g_n*sin(slope)*sin(downhill);
  I*der(omega) = frame.tau - (r_x*frame.f_y - r_y*frame.f_x);
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Polygon(points={{80,0},{-40,70},{-40,-70},{80,0}}, lineColor={0,70,140}, fillColor={200,220,240},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The first rows of (22) and (24): M x&#776; = forces of wheels and environment, at the centre of mass, which may be
beside the frame, and on a floor that may fall. Newton holds for the centre of mass and Euler about it; forces act at
the frame.</p>
</html>"));
end BaseBody;
