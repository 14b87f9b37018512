within GiveWay.Examples;
model StaticPush "A steady push on the unpowered robot (5.1)"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey data "The robot's parameters";
  Components.Robot robot(data=data) "Unpowered robot"
    annotation (Placement(transformation(extent={{-80,-20},{-40,20}})));
  parameter SI.Force f=10 "Force of the push";
  constant SI.Angle side=1.0471975511965976 "Direction of the pushed side";
  Sources.Push push(f_x=-f*cos(side), f_y=-f*sin(side), p_x=0.088046, p_y=0.1525, t_on=0.1)
    "Push at the middle of a side, at right angles"
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
  SI.Force sensed[2] "Force computed from the torques, base axes";
  Real share(unit="1") "Sensed force over true force";
equation
  connect(push.frame, robot.frame)
    annotation (Line(points={{80,0},{-40,-8}}, color={0,70,140}));
  robot.tau_ref = zeros(3);
  sensed = -Functions.forceOfTorques(robot.tau_s, data.wheel_radius);
  share = sqrt(sensed[1]^2 + sensed[2]^2)/f;
  annotation (
    experiment(StopTime=0.8, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>The gears hold the wheels; the base deflects the springs of its torque sensors and the bristles of its rollers. Only
the springs' force is sensed: with k<sub>w</sub> = k/r<sub>w</sub><sup>2</sup> its share is k<sub>w</sub>/(k<sub>w</sub>
+ &sigma;<sub>0</sub>), which is why the paper's forces are too small (0 to &minus;45 %).</p>
</html>"));
end StaticPush;
