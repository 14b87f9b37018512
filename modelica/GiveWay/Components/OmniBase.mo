within GiveWay.Components;
model OmniBase "Base on three omnidirectional wheels"
  import Modelica.Units.SI;
  constant SI.Angle third=2.0943951023931953 "A third of a turn";
  parameter Parameters.Trikey robot "The robot's parameters";
  parameter SI.Position x_start=0 "Position at the start, world frame";
  parameter SI.Position y_start=0 "Position at the start, world frame";
  parameter SI.Angle theta_start=0 "Heading at the start";
  parameter SI.Velocity v_x_start=0 "Velocity at the start, world frame";
  parameter SI.Velocity v_y_start=0 "Velocity at the start, world frame";
  parameter SI.AngularVelocity omega_start=0 "Yaw rate at the start";
  parameter SI.Position c_x=0 "Centre of mass, base axes";
  parameter SI.Position c_y=0 "Centre of mass, base axes";
  parameter SI.Angle slope=0 "Inclination of the floor";
  parameter SI.Angle downhill=0 "Direction in which the floor falls, world frame";
  parameter Real roller_scale[3](each unit="1")={1, 1, 1} "Factors on the rollers' friction, each wheel";
  replaceable model Wheel = Omniwheel "Wheels, with their rollers";
  Interfaces.PlanarFrame frame "Centre of the base"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Interfaces.RotaryFlange axle0 "Axle of wheel 0"
    annotation (Placement(transformation(extent={{-110,30},{-90,50}})));
  Interfaces.RotaryFlange axle1 "Axle of wheel 1"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Interfaces.RotaryFlange axle2 "Axle of wheel 2"
    annotation (Placement(transformation(extent={{-110,-50},{-90,-30}})));
  Wheel wheel0(azimuth=0*third, R=robot.wheel_distance, r_w=robot.wheel_radius, r_r=robot.roller_radius,
    I_w=robot.wheel_inertia, I_r=robot.roller_inertia, robot=robot, friction_scale=roller_scale[1],
    v_n_start=cos(theta_start + 0*third)*v_x_start + sin(theta_start + 0*third)*v_y_start) "Wheel 0"
    annotation (Placement(transformation(extent={{-80,40},{-40,80}})));
  Wheel wheel1(azimuth=1*third, R=robot.wheel_distance, r_w=robot.wheel_radius, r_r=robot.roller_radius,
    I_w=robot.wheel_inertia, I_r=robot.roller_inertia, robot=robot, friction_scale=roller_scale[2],
    v_n_start=cos(theta_start + 1*third)*v_x_start + sin(theta_start + 1*third)*v_y_start) "Wheel 1"
    annotation (Placement(transformation(extent={{40,40},{80,80}})));
  Wheel wheel2(azimuth=2*third, R=robot.wheel_distance, r_w=robot.wheel_radius, r_r=robot.roller_radius,
    I_w=robot.wheel_inertia, I_r=robot.roller_inertia, robot=robot, friction_scale=roller_scale[3],
    v_n_start=cos(theta_start + 2*third)*v_x_start + sin(theta_start + 2*third)*v_y_start) "Wheel 2"
    annotation (Placement(transformation(extent={{-80,-80},{-40,-40}})));
  BaseBody body(m=robot.base_mass, I=robot.base_yaw_inertia, x_start=x_start, y_start=y_start, theta_start=theta_start,
    v_x_start=v_x_start, v_y_start=v_y_start, omega_start=omega_start, c_x=c_x, c_y=c_y, slope=slope,
    downhill=downhill) "Body"
    annotation (Placement(transformation(extent={{40,-80},{80,-40}})));
equation
  connect(body.frame, frame)
    annotation (Line(points={{80,-60},{100,0}}, color={0,70,140}));
  connect(wheel0.base, body.frame)
    annotation (Line(points={{-80,65},{80,-60}}, color={0,70,140}));
  connect(wheel0.axle, axle0)
    annotation (Line(points={{-80,55},{-100,40}}, color={0,70,140}));
  connect(wheel1.base, body.frame)
    annotation (Line(points={{40,65},{80,-60}}, color={0,70,140}));
  connect(wheel1.axle, axle1)
    annotation (Line(points={{40,55},{-100,0}}, color={0,70,140}));
  connect(wheel2.base, body.frame)
    annotation (Line(points={{-80,-55},{80,-60}}, color={0,70,140}));
  connect(wheel2.axle, axle2)
    annotation (Line(points={{-80,-65},{-100,-40}}, color={0,70,140}));
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Polygon(points={{80,0},{-40,70},{-40,-70},{80,0}}, lineColor={0,70,140}, fillColor={200,220,240},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The body of (22) with wheels at 0, 120 and 240 deg. Including the inertia of wheels and rollers, the mass matrix is
diag(M + 1.5 I<sub>w</sub>/r<sub>w</sub><sup>2</sup> + 1.5 I<sub>r</sub>/r<sub>r</sub><sup>2</sup>, same, I<sub>b</sub>
+ 3 I<sub>w</sub>R<sup>2</sup>/r<sub>w</sub><sup>2</sup>): <code>Tests.RollingMass</code>.</p>
</html>"));
end OmniBase;
