within GiveWay.Interfaces;
partial model PartialServoRobot "Robot whose wheels follow wanted angles, without the source of these angles"
  import Modelica.Units.SI;
  extends PartialRobot;
  parameter Integer counts=data.drivetrain_encoder_counts "Encoder counts per turn";
  constant SI.Time cycle=0.001 "Cycle of the bus";
  SI.Angle phi_ref[3] "Wanted angles, on the bus";
  SI.AngularVelocity w_ref[3] "Wanted speeds, on the bus";
  Components.JointServo servo0(k_p=data.servo_kp, k_d=data.servo_kd, limit=data.drivetrain_torque_limit,
    cutoff=data.servo_derivative_cutoff, counts=counts,
    phi_start=-w_start[1]*cycle, w_start=w_start[1]) "Servo of wheel 0"
    annotation (Placement(transformation(extent={{-50,45},{-20,75}})));
  Components.JointServo servo1(k_p=data.servo_kp, k_d=data.servo_kd, limit=data.drivetrain_torque_limit,
    cutoff=data.servo_derivative_cutoff, counts=counts,
    phi_start=-w_start[2]*cycle, w_start=w_start[2]) "Servo of wheel 1"
    annotation (Placement(transformation(extent={{-50,-15},{-20,15}})));
  Components.JointServo servo2(k_p=data.servo_kp, k_d=data.servo_kd, limit=data.drivetrain_torque_limit,
    cutoff=data.servo_derivative_cutoff, counts=counts,
    phi_start=-w_start[3]*cycle, w_start=w_start[3]) "Servo of wheel 2"
    annotation (Placement(transformation(extent={{-50,-75},{-20,-45}})));
equation
  servo0.phi_m = phi_m[1];
  servo0.phi_ref = phi_ref[1];
  servo0.w_ref = w_ref[1];
  tau_m[1] = servo0.tau_m;
  servo1.phi_m = phi_m[2];
  servo1.phi_ref = phi_ref[2];
  servo1.w_ref = w_ref[2];
  tau_m[2] = servo1.tau_m;
  servo2.phi_m = phi_m[3];
  servo2.phi_ref = phi_ref[3];
  servo2.w_ref = w_ref[3];
  tau_m[3] = servo2.tau_m;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Polygon(points={{80,0},{-40,70},{-40,-70},{80,0}}, lineColor={0,70,140}, fillColor={200,220,240},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Three drives with a 2 kHz servo each (Fig. 3). Extending models define the wanted angles, which the bus delivers one
cycle later.</p>
</html>"));
end PartialServoRobot;
