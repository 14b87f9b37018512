within GiveWay.Tests;
model FreeBaseEnergy "A base without friction keeps its kinetic energy"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot(roller_coulomb_torque=0) "No roller friction";
  Components.OmniBase base(robot=robot, v_x_start=0.3, v_y_start=-0.2, omega_start=1.5,
    redeclare model Wheel = Components.TanhWheel) "Base"
    annotation (Placement(transformation(extent={{-20,-20},{20,20}})));
  SI.Energy kinetic "Kinetic energy of body, wheels and rollers";
  parameter SI.Energy kinetic_start(fixed=false) "Kinetic energy at the start";
  SI.Energy residual "Change";
initial equation
  kinetic_start = kinetic;
equation
  kinetic = 0.5*robot.base_mass*(base.body.v_x^2 + base.body.v_y^2) + 0.5*robot.base_yaw_inertia*base.body.omega^2
    + 0.5*robot.wheel_inertia*(base.wheel0.w_w^2 + base.wheel1.w_w^2 + base.wheel2.w_w^2)
      + 0.5*robot.roller_inertia*(base.wheel0.w_r^2 + base.wheel1.w_r^2 + base.wheel2.w_r^2);
  residual = kinetic - kinetic_start;
  assert(abs(residual) < 1e-6, "the base gains or loses energy");
  annotation (
    experiment(StopTime=1, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>The velocity terms of (29) and (30) do no work.</p>
</html>"));
end FreeBaseEnergy;
