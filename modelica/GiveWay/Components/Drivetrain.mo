within GiveWay.Components;
model Drivetrain "Drivetrain of one wheel: motor, gear friction, torque sensor (Fig. 6)"
  import Modelica.Units.SI;
  parameter Parameters.Trikey robot "The robot's parameters";
  parameter Real friction_scale(unit="1")=1 "Factor on the gear friction";
  parameter SI.Angle phi_start=0 "Angle of the motor at the start";
  parameter SI.AngularVelocity w_start=0 "Speed of the motor at the start";
  Interfaces.TorqueInput tau_m "Wanted torque of the motor"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Interfaces.RotaryFlange wheel "Axle of the wheel"
    annotation (Placement(transformation(extent={{90,30},{110,50}})));
  Interfaces.TorqueOutput tau_s "Torque that the sensor reads"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Interfaces.AngleOutput phi_m "Angle that the encoder sees"
    annotation (Placement(transformation(extent={{90,-50},{110,-30}})));
  Motor motor(J=robot.drivetrain_motor_inertia, coulomb=friction_scale*robot.drivetrain_gear_coulomb,
    stiction=friction_scale*robot.drivetrain_gear_stiction, viscous=friction_scale*robot.drivetrain_gear_viscous,
    limit=robot.drivetrain_torque_limit, phi_start=phi_start, w_start=w_start) "Rotor and gear"
    annotation (Placement(transformation(extent={{-80,-20},{-40,20}})));
  TorqueSensorSpring sensor(k=robot.drivetrain_stiffness, d=robot.drivetrain_damping) "Elastic torque sensor"
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
equation
  connect(tau_m, motor.tau_m)
    annotation (Line(points={{-100,0},{-80,0}}, color={0,70,140}));
  connect(motor.flange, sensor.motor)
    annotation (Line(points={{-40,0},{40,0}}, color={0,70,140}));
  connect(sensor.wheel, wheel)
    annotation (Line(points={{80,5},{100,40}}, color={0,70,140}));
  connect(sensor.tau_s, tau_s)
    annotation (Line(points={{80,-5},{100,0}}, color={0,70,140}));
  phi_m = motor.phi;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-60,40},{40,-40}}, lineColor={64,64,64}, fillColor={192,192,192},
        fillPattern=FillPattern.HorizontalCylinder),
      Rectangle(extent={{40,10},{90,-10}}, lineColor={64,64,64}, fillColor={160,160,160},
        fillPattern=FillPattern.HorizontalCylinder),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The paper's Fig. 6 from the motor to the axle, where the wheel is connected. All quantities are reflected to the
wheel axle.</p>
<p>J &theta;&#776;<sub>m</sub> = &tau;<sub>m</sub> &minus; B1(&theta;&#775;<sub>m</sub>) &minus; &tau;<sub>s</sub></p>
</html>"));
end Drivetrain;
