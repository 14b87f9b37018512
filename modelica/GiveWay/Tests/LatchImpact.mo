within GiveWay.Tests;
model LatchImpact "The impact of plate and carriage keeps their momentum"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot(bumper_preload=0, bumper_latch_force=5, slider_friction=0)
    "A dummy without rail friction";
  parameter SI.Velocity v_start=0.5 "Speed at the start";
  Components.Slider slider(robot=robot, v_start=v_start, redeclare model Bumper = Components.LatchedBumper) "Free dummy"
    annotation (Placement(transformation(extent={{-80,-20},{-40,20}})));
  Components.Floor obstacle(k=robot.contact_stiffness, e=robot.contact_damping, s_0=0.01) "Obstacle it bounces off"
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
  SI.Momentum received(start=0, fixed=true) "Impulse received from the obstacle";
  SI.Momentum residual "Momentum minus the received impulse";
equation
  connect(slider.nose, obstacle.nose)
    annotation (Line(points={{-40,0},{80,0}}, color={0,70,140}));
  der(received) = -obstacle.nose.f;
  residual = (robot.slider_mass - robot.bumper_plate_mass)*slider.v + robot.bumper_plate_mass*der(slider.nose.s)
    - robot.slider_mass*v_start - received;
  assert(abs(residual) < 1e-5, "momentum is lost");
  annotation (
    experiment(StopTime=0.8, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>Release and re-latching do not change the common momentum of carriage and plate.</p>
</html>"));
end LatchImpact;
