within GiveWay.Tests;
model UnevenBase "A base with its mass off the centre, on a floor that falls, keeps its energy"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot(roller_coulomb_torque=0) "No roller friction";
  Components.OmniBase base(robot=robot, v_x_start=0.3, v_y_start=-0.2, omega_start=1.5, c_x=0.03, c_y=-0.02, slope=0.05,
    downhill=2, redeclare model Wheel = Components.TanhWheel) "Base"
    annotation (Placement(transformation(extent={{-20,-20},{20,20}})));
  SI.Energy energy "Kinetic energy of body, wheels and rollers, and of the height of the centre of mass";
  parameter SI.Energy energy_start(fixed=false) "Energy at the start";
  SI.Energy residual "Change";
initial equation
  energy_start = energy;
equation
  energy = 0.5*robot.base_mass*((base.body.v_x - base.body.omega*base.body.r_y)^2
    + (base.body.v_y + base.body.omega*base.body.r_x)^2) + 0.5*robot.base_yaw_inertia*base.body.omega^2
    + 0.5*robot.wheel_inertia*(base.wheel0.w_w^2 + base.wheel1.w_w^2 + base.wheel2.w_w^2)
    + 0.5*robot.roller_inertia*(base.wheel0.w_r^2 + base.wheel1.w_r^2 + base.wheel2.w_r^2)
    - robot.base_mass*base.body.g_n*sin(0.05)*(cos(2)*(base.body.x + base.body.r_x)
    + sin(2)*(base.body.y + base.body.r_y));
  residual = energy - energy_start;
  assert(abs(residual) < 1e-6, "the base gains or loses energy");
  annotation (
    experiment(StopTime=1, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>Neither the turning of the mass about the frame nor the constraints do work; gravity along the floor is a potential.
</p>
</html>"));
end UnevenBase;
