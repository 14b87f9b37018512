within GiveWay.Examples;
model BumperDrop "A mass falls onto the floor with its magnetic spring bumper ahead"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "Numbers of dummy and bumper";
  parameter SI.Length height=0.02 "Of the fall";
  Components.Slider slider(robot=robot, coulomb=0) "Falling mass";
  Components.Gravity gravity(m=robot.slider_mass) "Its weight";
  Components.Floor floor(k=robot.contact_stiffness, e=robot.contact_damping, s_0=height) "Floor";
equation
  connect(gravity.flange, slider.rope);
  connect(slider.nose, floor.nose);
  annotation (
    experiment(StopTime=0.8, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>The bumper of 3.5 on a bench: snap of the magnet, stroke onto the bottom stop, and rebound. The weight keeps the spring compressed: the magnet does not reach the plate again
(<code>BumperSweep</code> shows that).</p>
</html>"));
end BumperDrop;
