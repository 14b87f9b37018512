within GiveWay.Examples;
model BumperSweep "A bumper hits a rigid obstacle; the parameters a designer varies come first"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "Parameters of dummy and bumper";
  parameter SI.Velocity v=0.5 "Speed of the impact";
  parameter SI.Mass m=9.08 "Sliding mass";
  parameter SI.TranslationalSpringConstant k=948 "Rate of the spring";
  parameter SI.Force f_pre=2 "Preload";
  parameter SI.Force f_latch=45.8 "Force of the latch";
  parameter SI.Length g_0=0.001 "Gap at which the latch has a quarter of its force";
  Components.Slider slider(robot=robot, m=m, coulomb=0, v_start=v, bumper(k=k, f_pre=f_pre, f_latch=f_latch, g_0=g_0))
    "Moving mass"
    annotation (Placement(transformation(extent={{-80,40},{-40,80}})));
  Components.Floor obstacle(k=robot.contact_stiffness, e=robot.contact_damping, s_0=0.005)
    "Rigid obstacle behind the cover"
    annotation (Placement(transformation(extent={{40,40},{80,80}})));
  Sensors.PeakForce peak(f=obstacle.nose.f) "Largest force"
    annotation (Placement(transformation(extent={{-80,-80},{-40,-40}})));
equation
  connect(slider.nose, obstacle.nose)
    annotation (Line(points={{-40,60},{80,60}}, color={0,70,140}));
  annotation (
    experiment(StopTime=0.4, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>Vary <code>v, m, k, f_pre, f_latch, g_0</code> and read <code>peak.peak</code>. With the latch's force below v
&radic;(k m) the magnet does not raise the peak.</p>
<p>With the default values the magnet lets go after 26 ms (its gap passes g<sub>0</sub>) and takes hold of the
rebounding plate after 308 ms.</p>
</html>"));
end BumperSweep;
