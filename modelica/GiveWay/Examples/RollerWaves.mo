within GiveWay.Examples;
model RollerWaves "Wheel 0 moves in waves, the other two stand (4.2)"
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey data "The robot's numbers";
  parameter Integer counts=data.drivetrain_encoder_counts "Encoder counts per turn";
  Components.Robot robot(data=data) "Robot"
    annotation (Placement(transformation(extent={{-80,40},{-40,80}})));
  Sources.WheelWave wave(f=0.5) "Of wheel 0"
    annotation (Placement(transformation(extent={{-20,40},{20,80}})));
  Components.JointServo servo0(k_p=data.servo_kp, k_d=data.servo_kd, limit=data.drivetrain_torque_limit, cutoff=data.servo_derivative_cutoff, counts=counts) "Servo of wheel 0"
    annotation (Placement(transformation(extent={{40,40},{80,80}})));
  Components.JointServo servo1(k_p=data.servo_kp, k_d=data.servo_kd, limit=data.drivetrain_torque_limit, cutoff=data.servo_derivative_cutoff, counts=counts) "Servo of wheel 1"
    annotation (Placement(transformation(extent={{-80,-80},{-40,-40}})));
  Components.JointServo servo2(k_p=data.servo_kp, k_d=data.servo_kd, limit=data.drivetrain_torque_limit, cutoff=data.servo_derivative_cutoff, counts=counts) "Servo of wheel 2"
    annotation (Placement(transformation(extent={{-20,-80},{20,-40}})));
equation
  servo0.phi_ref = wave.phi;
  servo0.w_ref = wave.w;
  servo1.phi_ref = 0;
  servo1.w_ref = 0;
  servo2.phi_ref = 0;
  servo2.w_ref = 0;
  servo0.phi_m = robot.phi_m[1];
  robot.tau_ref[1] = servo0.tau_m;
  servo1.phi_m = robot.phi_m[2];
  robot.tau_ref[2] = servo1.tau_m;
  servo2.phi_m = robot.phi_m[3];
  robot.tau_ref[3] = servo2.tau_m;
  annotation (
    experiment(StopTime=1.2, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>Fig. 7a: the base swings in an arc about a point outside it, and roller friction shows as square waves on all three torque sensors, in the ratio 2 : &minus;1 : &minus;1.
One wave of 2 s instead of the paper's slower ones.</p>
</html>"));
end RollerWaves;
