within GiveWay.Examples;
model BumperSeries "A mass with two springs in series ahead hits a rigid obstacle"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "Parameters of dummy and bumper";
  parameter SI.Velocity v=0.6 "Speed of the impact";
  parameter SI.Mass m=9.08 "Sliding mass";
  parameter SI.TranslationalSpringConstant k=600 "Rate of the first spring";
  parameter SI.Length travel_1=0.03 "Travel until it is solid";
  parameter SI.TranslationalSpringConstant k_2=2500 "Rate of the second spring";
  parameter SI.Force f_pre_2=15 "Force below which it does not move";
  Components.SeriesSlider slider(robot=robot, m=m, coulomb=0, v_start=v, bumper(k=k, travel_1=travel_1, k_2=k_2,
    f_pre_2=f_pre_2))
    "Moving mass"
    annotation (Placement(transformation(extent={{-80,40},{-40,80}})));
  Components.Floor obstacle(k=robot.contact_stiffness, e=robot.contact_damping, s_0=0.005)
    "Rigid obstacle behind the cover"
    annotation (Placement(transformation(extent={{40,40},{80,80}})));
  Sensors.EnergyBalance energy(p_in=slider.bumper.f*slider.bumper.u, stored=slider.bumper.e_stored,
    p_loss=slider.bumper.p_loss) "Energy of the bumper"
    annotation (Placement(transformation(extent={{-80,-80},{-40,-40}})));
equation
  connect(slider.nose, obstacle.nose)
    annotation (Line(points={{-40,60},{80,60}}, color={0,70,140}));
  annotation (
    experiment(StopTime=0.5, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>The soft spring meets first; both give way from 15 N (c = 22 mm) until the first is solid (c = 32 mm).</p>
<p><code>energy.residual</code> is what the bumper's energies leave unexplained.</p>
</html>"));
end BumperSeries;
