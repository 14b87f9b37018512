within GiveWay.Components;
model ControlledRobot "Robot with its servos and the sampled controller"
  import Modelica.Units.SI;
  extends Interfaces.PartialServoRobot;
  parameter SI.Torque resolution=data.drivetrain_torque_sensor_resolution "Resolution of the torque signal";
  parameter Boolean motor_current=false
    "The torque signal is that of the motors' currents, with the gears' friction in it, not of torque sensors";
  parameter Integer tare_ticks=100 "Samples of the initial tare; 0: no tare, the robot follows its plan from the start";
  final parameter SI.Torque tau_drive[3]={abs(sign(w_start[i]))*tau_start[i] + gear_scale[i]
    *(sign(w_start[i])*data.drivetrain_gear_coulomb + data.drivetrain_gear_viscous*w_start[i]) for i in 1:3}
    "Motor torques of the steady motion at the start; none where a gear holds its wheel";
  replaceable model Plan = Sources.Standstill constrainedby Interfaces.PartialPlan "Kind of plan";
  Plan plan(t=controller.path_time) "Planned motion"
    annotation (Placement(transformation(extent={{-93,10},{-63,40}})));
  SampledController controller(robot=data, period=cycle, counts=counts, resolution=resolution,
    motor_current=motor_current, tare_ticks=tare_ticks, phi_start=tau_start/data.drivetrain_stiffness, w_start=w_start,
    tau_start=if motor_current then tau_drive else tau_start,
    plan_x={plan.x, plan.y}, plan_v={plan.v_x, plan.v_y}, plan_a={plan.a_x, plan.a_y}, plan_theta=plan.theta)
    "Estimator, detector and admittance"
    annotation (Placement(transformation(extent={{-93,-40},{-63,-10}})));
equation
  phi_ref = controller.phi_ref;
  w_ref = controller.w_ref;
  controller.tau_s[1] = tau_s[1];
  controller.tau_m[1] = tau_m[1];
  controller.phi_m[1] = phi_m[1];
  controller.tau_s[2] = tau_s[2];
  controller.tau_m[2] = tau_m[2];
  controller.phi_m[2] = phi_m[2];
  controller.tau_s[3] = tau_s[3];
  controller.tau_m[3] = tau_m[3];
  controller.phi_m[3] = phi_m[3];
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Polygon(points={{80,0},{-40,70},{-40,-70},{80,0}}, lineColor={0,70,140}, fillColor={200,220,240},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The closed loop of Fig. 3 and Fig. 4: three drives with a 2 kHz servo each, the controller at 1 kHz, and a bus with a
latency of one millisecond in each direction.</p>
<p>With <code>motor_current</code> the robot has no torque sensors: its torque signal is the torque of the motor, as its
current shows it. The friction of the gear stands between the two: while a gear is stuck, what pushes its wheel does not
reach the signal.</p>
</html>"));
end ControlledRobot;
