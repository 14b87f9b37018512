within GiveWay.Components;
model Drivetrain "Drivetrain of one wheel: motor, gear friction, torque sensor (Fig. 6)"
  import Modelica.Units.SI;
  parameter Parameters.Trikey robot "The robot's numbers";
  parameter SI.Angle phi_start=0 "Angle of the motor at the start";
  parameter SI.AngularVelocity w_start=0 "Speed of the motor at the start";
  Interfaces.TorqueInput tau_m "Wanted torque of the motor";
  Interfaces.RotaryFlange wheel "Axle of the wheel";
  Interfaces.TorqueOutput tau_s "Torque that the sensor reads";
  Interfaces.AngleOutput phi_m "Angle that the encoder sees";
  Motor motor(J=robot.drivetrain_motor_inertia, coulomb=robot.drivetrain_gear_coulomb, stiction=robot.drivetrain_gear_stiction, viscous=robot.drivetrain_gear_viscous,
    limit=robot.drivetrain_torque_limit, phi_start=phi_start, w_start=w_start) "Rotor and gear";
  TorqueSensorSpring sensor(k=robot.drivetrain_stiffness, d=robot.drivetrain_damping) "Elastic torque sensor";
equation
  connect(tau_m, motor.tau_m);
  connect(motor.flange, sensor.motor);
  connect(sensor.wheel, wheel);
  connect(sensor.tau_s, tau_s);
  phi_m = motor.phi;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-60,40},{40,-40}}, lineColor={64,64,64}, fillColor={192,192,192}, fillPattern=FillPattern.HorizontalCylinder),
      Rectangle(extent={{40,10},{90,-10}}, lineColor={64,64,64}, fillColor={160,160,160}, fillPattern=FillPattern.HorizontalCylinder),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The paper's Fig. 6 from the motor to the axle; the wheel is what is connected there. All quantities are those at the wheel axle.</p>
<p>J &theta;&#776;<sub>m</sub> = &tau;<sub>m</sub> &minus; B1(&theta;&#775;<sub>m</sub>) &minus; &tau;<sub>s</sub></p>
</html>"));
end Drivetrain;
