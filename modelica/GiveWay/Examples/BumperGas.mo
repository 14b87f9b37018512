within GiveWay.Examples;
model BumperGas "A mass with a pneumatic cushion ahead hits a rigid obstacle"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "Parameters of dummy and bumper";
  parameter SI.Velocity v=0.8 "Speed of the impact";
  parameter SI.Mass m=9.08 "Sliding mass";
  parameter SI.Force f_0=20 "Force at full extension";
  parameter SI.Length l_gas=0.2 "Volume over the piston's area";
  parameter Real n(unit="1")=1.3 "Polytropic exponent";
  parameter SI.Force f_ambient=100 "Force of the air outside";
  Components.GasSlider slider(robot=robot, m=m, coulomb=0, v_start=v, bumper(f_0=f_0, l_gas=l_gas, n=n,
    f_ambient=f_ambient))
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
<p>The cushion returns nearly all that it took: only the guide loses energy.</p>
<p><code>energy.residual</code> is what the bumper's energies leave unexplained.</p>
</html>"));
end BumperGas;
