within GiveWay.Examples;
model BumperTable "A mass with a bumper of measured forces ahead hits a rigid obstacle"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "Parameters of dummy and bumper";
  parameter SI.Velocity v=0.9 "Speed of the impact";
  parameter SI.Mass m=9.08 "Sliding mass";
  parameter SI.Length travel=0.12 "Compression at which it bottoms";
  parameter SI.Position travels[:]={0, 0.02, 0.05, 0.09, 0.13} "Travels of the rows";
  parameter SI.Velocity speeds[:]={-0.5, 0, 0.5} "Speeds of the columns";
  parameter SI.Force forces[:, :]={{0, 4, 7}, {5, 15, 22}, {12, 30, 44}, {30, 60, 85}, {90, 150, 200}} "Forces";
  Components.TableSlider slider(robot=robot, m=m, coulomb=0, v_start=v, bumper(travel=travel, travels=travels,
    speeds=speeds, forces=forces))
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
<p>Faster than the table's last speeds at first, and between its points later.</p>
<p><code>energy.residual</code> is what the bumper's energies leave unexplained.</p>
</html>"));
end BumperTable;
