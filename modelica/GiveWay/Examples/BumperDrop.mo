within GiveWay.Examples;
model BumperDrop "A mass falls onto the floor with its magnetic spring bumper ahead"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "Parameters of dummy and bumper";
  parameter SI.Length height=0.02 "Height of the fall";
  Components.Slider slider(robot=robot, coulomb=0) "Falling mass"
    annotation (Placement(transformation(extent={{-80,40},{-40,80}})));
  Components.Gravity gravity(m=robot.slider_mass) "Its weight"
    annotation (Placement(transformation(extent={{40,40},{80,80}})));
  Components.Floor floor(k=robot.contact_stiffness, e=robot.contact_damping, s_0=height) "Floor"
    annotation (Placement(transformation(extent={{-80,-80},{-40,-40}})));
equation
  connect(gravity.flange, slider.rope)
    annotation (Line(points={{80,60},{-80,60}}, color={0,70,140}));
  connect(slider.nose, floor.nose)
    annotation (Line(points={{-40,60},{-40,-60}}, color={0,70,140}));
  annotation (
    experiment(StopTime=0.8, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>The bumper of 3.5 on a bench: snap of the magnet, stroke onto the bottom stop, and rebound. The weight keeps the
spring compressed: the magnet does not reach the plate again (<code>BumperSweep</code> shows that).</p>
</html>"));
end BumperDrop;
