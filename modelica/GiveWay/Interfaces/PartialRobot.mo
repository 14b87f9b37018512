within GiveWay.Interfaces;
partial model PartialRobot "Base with three drivetrains, without the control of the motors"
  import Modelica.Units.SI;
  parameter Parameters.Trikey data "The robot's parameters";
  parameter SI.Position x_start=0 "Position of the base at the start, world frame";
  parameter SI.Position y_start=0 "Position of the base at the start, world frame";
  parameter SI.Angle theta_start=0 "Heading of the base at the start";
  parameter SI.Velocity v_x_start=0 "Velocity of the base at the start, world frame";
  parameter SI.Velocity v_y_start=0 "Velocity of the base at the start, world frame";
  parameter SI.AngularVelocity omega_start=0 "Yaw rate of the base at the start";
  parameter SI.Position c_x=0 "Centre of mass, base axes";
  parameter SI.Position c_y=0 "Centre of mass, base axes";
  parameter SI.Angle slope=0 "Inclination of the floor";
  parameter SI.Angle downhill=0 "Direction in which the floor falls, world frame";
  parameter Real roller_scale[3](each unit="1")={1, 1, 1} "Factors on the rollers' friction, each wheel";
  parameter Real gear_scale[3](each unit="1")={1, 1, 1} "Factors on the gears' friction, each drivetrain";
  constant SI.Acceleration g_n=9.81 "Gravity";
  constant SI.Angle third=2.0943951023931953 "A third of a turn";
  final parameter SI.Velocity v_n[3]={cos(theta_start + i*third)*v_x_start
    + sin(theta_start + i*third)*v_y_start for i in 0:2} "Speeds along the axles at the start";
  final parameter SI.AngularVelocity w_start[3]={(-sin(theta_start + i*third)*v_x_start
    + cos(theta_start + i*third)*v_y_start + data.wheel_distance*omega_start)/data.wheel_radius for i in 0:2}
    "Wheel speeds at the start";
  final parameter Real stick[3](each unit="1")={exp(-(v_n[i]/data.roller_stribeck_speed)^2) for i in 1:3}
    "Share of stiction in the rollers at the start";
  final parameter SI.Force f_start[3]={sign(v_n[i])*roller_scale[i]*data.roller_coulomb_torque/data.roller_radius
    *(stick[i] + (1 - stick[i])*tanh(data.roller_tanh_slope*abs(v_n[i])/data.roller_radius)) for i in 1:3}
    "Roller friction of the steady motion at the start";
  final parameter SI.Force drag_x=f_start[1] + cos(third)*f_start[2] + cos(2*third)*f_start[3]
    "Force of the rollers, base axes";
  final parameter SI.Force drag_y=sin(third)*f_start[2] + sin(2*third)*f_start[3] "Force of the rollers, base axes";
  final parameter SI.Force pull_x=data.base_mass*(g_n*sin(slope)*cos(downhill - theta_start) + omega_start^2*c_x)
    "Force down the floor and outwards, base axes";
  final parameter SI.Force pull_y=data.base_mass*(g_n*sin(slope)*sin(downhill - theta_start) + omega_start^2*c_y)
    "Force down the floor and outwards, base axes";
  final parameter SI.Torque tau_start[3]={data.wheel_radius*(2/3*(cos(i*third)*(drag_y - pull_y)
    - sin(i*third)*(drag_x - pull_x)) - (c_x*pull_y - c_y*pull_x)/(3*data.wheel_distance)) for i in 0:2}
    "Torques that balance these forces";
  SI.Torque tau_m[3] "Wanted motor torques";
  Interfaces.TorqueOutput tau_s[3] "Sensed torques"
    annotation (Placement(transformation(extent={{90,30},{110,50}})));
  Interfaces.AngleOutput phi_m[3] "Motor angles"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Interfaces.PlanarFrame frame "Centre of the base"
    annotation (Placement(transformation(extent={{90,-50},{110,-30}})));
  Components.OmniBase base(robot=data, x_start=x_start, y_start=y_start, theta_start=theta_start, v_x_start=v_x_start,
    v_y_start=v_y_start, omega_start=omega_start, c_x=c_x, c_y=c_y, slope=slope, downhill=downhill,
    roller_scale=roller_scale)
    "Base on three wheels"
    annotation (Placement(transformation(extent={{50,-20},{90,20}})));
  Components.Drivetrain drive0(robot=data, phi_start=tau_start[1]/data.drivetrain_stiffness, w_start=w_start[1],
    friction_scale=gear_scale[1])
    "Drivetrain of wheel 0"
    annotation (Placement(transformation(extent={{-5,45},{25,75}})));
  Components.Drivetrain drive1(robot=data, phi_start=tau_start[2]/data.drivetrain_stiffness, w_start=w_start[2],
    friction_scale=gear_scale[2])
    "Drivetrain of wheel 1"
    annotation (Placement(transformation(extent={{-5,-15},{25,15}})));
  Components.Drivetrain drive2(robot=data, phi_start=tau_start[3]/data.drivetrain_stiffness, w_start=w_start[3],
    friction_scale=gear_scale[3])
    "Drivetrain of wheel 2"
    annotation (Placement(transformation(extent={{-5,-75},{25,-45}})));
equation
  connect(base.frame, frame)
    annotation (Line(points={{90,0},{100,-40}}, color={0,70,140}));
  connect(drive0.wheel, base.axle0)
    annotation (Line(points={{25,66},{50,8}}, color={0,70,140}));
  drive0.tau_m = tau_m[1];
  tau_s[1] = drive0.tau_s;
  phi_m[1] = drive0.phi_m;
  connect(drive1.wheel, base.axle1)
    annotation (Line(points={{25,6},{50,0}}, color={0,70,140}));
  drive1.tau_m = tau_m[2];
  tau_s[2] = drive1.tau_s;
  phi_m[2] = drive1.phi_m;
  connect(drive2.wheel, base.axle2)
    annotation (Line(points={{25,-54},{50,-8}}, color={0,70,140}));
  drive2.tau_m = tau_m[3];
  tau_s[3] = drive2.tau_s;
  phi_m[3] = drive2.phi_m;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Polygon(points={{80,0},{-40,70},{-40,-70},{80,0}}, lineColor={0,70,140}, fillColor={200,220,240},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The robot without its electronics. It starts at rest, or in steady motion: then the rollers already slide and the
drivetrains carry their friction, and what the floor's fall and a centre of mass beside the middle ask. Extending models
define the motor torques.</p>
</html>"));
end PartialRobot;
