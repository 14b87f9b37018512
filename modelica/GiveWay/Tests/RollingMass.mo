within GiveWay.Tests;
model RollingMass "Wheels and rollers add to the base's mass"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot(roller_coulomb_torque=0) "No roller friction";
  Components.OmniBase base(robot=robot, redeclare model Wheel = Components.TanhWheel) "Base"
    annotation (Placement(transformation(extent={{-80,-20},{-40,20}})));
  parameter SI.Force f=10 "Force of the push";
  Sources.Push push(f_x=f) "Push through the centre"
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
  parameter SI.Mass m_t=robot.base_mass + 1.5*robot.wheel_inertia/robot.wheel_radius^2
    + 1.5*robot.roller_inertia/robot.roller_radius^2 "M_t";
  SI.Velocity residual "Speed minus that of the mass M_t";
equation
  connect(push.frame, base.frame)
    annotation (Line(points={{80,0},{-40,0}}, color={0,70,140}));
  residual = base.body.v_x - f/m_t*time;
  assert(abs(residual) < 1e-7, "the moving mass is not M_t");
  annotation (
    experiment(StopTime=0.5, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>M<sub>t</sub> = M + 1.5 I<sub>w</sub>/r<sub>w</sub><sup>2</sup> + 1.5 I<sub>r</sub>/r<sub>r</sub><sup>2</sup>.</p>
</html>"));
end RollingMass;
