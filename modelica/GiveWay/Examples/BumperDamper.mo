within GiveWay.Examples;
model BumperDamper "A mass with a damper ahead hits a rigid obstacle"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "Parameters of dummy and bumper";
  parameter SI.Velocity v=0.8 "Speed of the impact";
  parameter SI.Mass m=9.08 "Sliding mass";
  parameter SI.TranslationalSpringConstant k=200 "Rate of the return spring";
  parameter SI.Force f_pre=4 "Its preload";
  parameter SI.TranslationalDampingConstant d_1=60 "Force per speed";
  parameter Real d_2(unit="N.s2/m2")=40 "Force per squared speed";
  parameter Real rebound(unit="1")=3 "While extending over while compressing";
  Components.DamperSlider slider(robot=robot, m=m, coulomb=0, v_start=v, bumper(k=k, f_pre=f_pre, d_1=d_1, d_2=d_2,
    rebound=rebound))
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
    experiment(StopTime=0.8, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>The force is largest at once, and the return spring brings the plate back slowly.</p>
<p><code>energy.residual</code> is what the bumper's energies leave unexplained.</p>
</html>"));
end BumperDamper;
