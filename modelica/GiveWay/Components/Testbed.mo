within GiveWay.Components;
model Testbed "Robot and collision dummy"
  import Modelica.Units.SI;
  parameter Parameters.Trikey robot "Numbers of robot and dummy";
  parameter SI.Position x_start=0 "Position of the base at the start, world frame";
  parameter SI.Position y_start=0 "Position of the base at the start, world frame";
  parameter SI.Angle theta_start=0 "Heading of the base at the start";
  parameter SI.Velocity v_x_start=0 "Velocity of the base at the start, world frame";
  parameter SI.Velocity v_y_start=0 "Velocity of the base at the start, world frame";
  parameter SI.AngularVelocity omega_start=0 "Yaw rate of the base at the start";
  parameter SI.Velocity slider_start=0 "Speed of the dummy at the start";
  parameter SI.Mass slider_mass=robot.slider_mass "Whole sliding mass of the dummy";
  parameter Boolean rope=true "A hanging weight pulls the dummy";
  parameter SI.Angle psi=-2.094395102393195 "Direction of the dummy's rail, world frame";
  parameter SI.Position x_target=0.088046 "Where the dummy's tip is after run_up";
  parameter SI.Position y_target=0.1525 "Where the dummy's tip is after run_up";
  parameter SI.Length run_up=robot.slider_run_up "Travel of the dummy until it is there";
  constant SI.Angle third=2.0943951023931953 "A third of a turn";

  final parameter SI.Velocity v_n[3]={cos(theta_start + i*third)*v_x_start + sin(theta_start + i*third)*v_y_start for i in 0:2} "Speeds along the axles at the start";
  final parameter SI.AngularVelocity w_start[3]={(-sin(theta_start + i*third)*v_x_start + cos(theta_start + i*third)*v_y_start + robot.wheel_distance*omega_start)/robot.wheel_radius for i in 0:2}
    "Wheel speeds at the start";
  final parameter Real stick[3](each unit="1")={exp(-(v_n[i]/robot.roller_stribeck_speed)^2) for i in 1:3} "Share of stiction in the rollers at the start";
  final parameter SI.Force f_start[3]={sign(v_n[i])*robot.roller_coulomb_torque/robot.roller_radius*(stick[i] + (1 - stick[i])*tanh(robot.roller_tanh_slope*abs(v_n[i])/robot.roller_radius)) for i in 1:3}
    "Roller friction of the steady motion at the start";
  final parameter SI.Force drag_x=f_start[1] + cos(third)*f_start[2] + cos(2*third)*f_start[3] "Of the rollers, base axes";
  final parameter SI.Force drag_y=sin(third)*f_start[2] + sin(2*third)*f_start[3] "Of the rollers, base axes";
  final parameter SI.Torque tau_start[3]={2/3*robot.wheel_radius*(cos(i*third)*drag_y - sin(i*third)*drag_x) for i in 0:2} "Torques that carry it";
  Interfaces.TorqueInput tau_m[3] "Wanted motor torques";
  Interfaces.TorqueOutput tau_s[3] "Sensed torques";
  Interfaces.AngleOutput phi_m[3] "Motor angles";
  Interfaces.PlanarFrame frame "Centre of the base, for pushes";
  replaceable OmniBase base(robot=robot, x_start=x_start, y_start=y_start, theta_start=theta_start, v_x_start=v_x_start, v_y_start=v_y_start, omega_start=omega_start)
    constrainedby OmniBase(robot=robot, x_start=x_start, y_start=y_start, theta_start=theta_start, v_x_start=v_x_start, v_y_start=v_y_start, omega_start=omega_start)
    "Base on three wheels";
  Drivetrain drive0(robot=robot, phi_start=tau_start[1]/robot.drivetrain_stiffness, w_start=w_start[1]) "Drivetrain of wheel 0";
  Drivetrain drive1(robot=robot, phi_start=tau_start[2]/robot.drivetrain_stiffness, w_start=w_start[2]) "Drivetrain of wheel 1";
  Drivetrain drive2(robot=robot, phi_start=tau_start[3]/robot.drivetrain_stiffness, w_start=w_start[3]) "Drivetrain of wheel 2";

  replaceable Slider slider(robot=robot, m=slider_mass, v_start=slider_start) constrainedby Slider(robot=robot, m=slider_mass, v_start=slider_start) "Dummy";
  HangingWeight weight(m=robot.rope_hanging_mass, k=robot.rope_stiffness, d=robot.rope_damping, drop=robot.rope_drop_height, v_start=slider_start) if rope "What pulls it";
  DiscContact contact(k=robot.contact_stiffness, e=robot.contact_damping, psi=psi, x_target=x_target, y_target=y_target, run_up=run_up, outline_x=robot.outline_x,
    outline_y=robot.outline_y) "Between dummy and robot";
equation
  connect(base.frame, frame);
  connect(base.frame, contact.base);
  connect(slider.nose, contact.nose);
  connect(weight.rope, slider.rope);
  connect(drive0.wheel, base.axle0);
  drive0.tau_m = tau_m[1];
  tau_s[1] = drive0.tau_s;
  phi_m[1] = drive0.phi_m;
  connect(drive1.wheel, base.axle1);
  drive1.tau_m = tau_m[2];
  tau_s[2] = drive1.tau_s;
  phi_m[2] = drive1.phi_m;
  connect(drive2.wheel, base.axle2);
  drive2.tau_m = tau_m[3];
  tau_s[3] = drive2.tau_s;
  phi_m[3] = drive2.phi_m;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Polygon(points={{80,0},{-40,70},{-40,-70},{80,0}}, lineColor={0,70,140}, fillColor={200,220,240}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Robot, dummy and the contact between them: the scene of 3.4 and 5.2. The start is at rest, or in steady motion with rollers that already slide and drivetrains that carry what the rollers
pull. Motor torques come from outside: they are zero (an unpowered robot, held by its gears), or those of three servos (<code>ClosedTestbed</code>).</p>
</html>"));
end Testbed;
