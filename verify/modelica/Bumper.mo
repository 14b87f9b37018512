model Bumper "The force of GiveWay.Components.MagneticBumper on a unit mass, in the emitter's subset"
  parameter Real k = 1;
  parameter Real f_pre = 1;
  parameter Real d = 1;
  parameter Real f_guide = 1;
  parameter Real u_guide = 1;
  parameter Real travel = 1;
  parameter Real k_stop = 1;
  parameter Real e_stop = 1;
  parameter Real f_latch = 1;
  parameter Real g_0 = 1;
  Real c(start = 0, fixed = true);
  Real u(start = 0, fixed = true);
  Real f_spring;
  Real f_end;
  Real f_bottom;
  Real f_magnet;
equation
  f_spring = f_pre + k*c + d*u + f_guide*tanh(u/u_guide);
  f_end = noEvent(if c < 0 then max(0, -k_stop*c*(1 - e_stop*u)) else 0);
  f_bottom = noEvent(if c > travel then max(0, k_stop*(c - travel)*(1 + e_stop*u)) else 0);
  f_magnet = f_latch/(1 + noEvent(max(c, 0))/g_0)^2;
  der(c) = u;
  der(u) = f_spring + f_magnet - f_end + f_bottom;
end Bumper;
