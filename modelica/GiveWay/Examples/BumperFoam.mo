within GiveWay.Examples;
model BumperFoam "A mass with foam ahead hits a rigid obstacle"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "Parameters of dummy and bumper";
  parameter SI.Velocity v=0.8 "Speed of the impact";
  parameter SI.Mass m=9.08 "Sliding mass";
  parameter SI.Length h=0.15 "Thickness of the foam";
  parameter SI.Force f_25=25 "Force at 25 % of it";
  parameter SI.Force f_50=45 "Force at 50 %";
  parameter SI.Force f_75=110 "Force at 75 %";
  parameter Real hysteresis(unit="1")=0.3 "Share of the work that slow unloading does not return";
  parameter Real rate_gain(unit="s/m")=0.3 "Greater force per speed";
  Components.FoamSlider slider(robot=robot, m=m, coulomb=0, v_start=v, bumper(h=h, f_25=f_25, f_50=f_50, f_75=f_75,
    hysteresis=hysteresis, rate_gain=rate_gain))
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
<p>The foam returns less than it took: compare the speeds before and after, and draw
<code>slider.bumper.f</code> over <code>slider.bumper.c</code>.</p>
<p><code>energy.residual</code> is what the bumper's energies leave unexplained.</p>
</html>"));
end BumperFoam;
